//! Tells the linker where ROS 2, MuJoCo and libpython are, so that the arm starts without `LD_LIBRARY_PATH`.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=AMENT_PREFIX_PATH");
    println!("cargo::rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    // DT_RPATH, not DT_RUNPATH: only the former is searched for what ROS itself opens at run time.
    println!("cargo::rustc-link-arg=-Wl,--disable-new-dtags");
    // What is missing is said by the build scripts of r2r and dynamixel-hil; the latter found libpython.
    let ros = env::var("AMENT_PREFIX_PATH").unwrap_or_default();
    let libraries = env::split_paths(&ros).map(|prefix| prefix.join("lib"));
    let others =
        ["MUJOCO_DYNAMIC_LINK_DIR", "DEP_DYNAMIXEL_HIL_LIBPYTHON"].map(|name| env::var(name).unwrap_or_default());
    let others = others.iter().flat_map(env::split_paths).collect::<Vec<_>>();
    for directory in libraries.chain(others).filter_map(|path| path.canonicalize().ok()) {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{}", directory.display());
    }
}
