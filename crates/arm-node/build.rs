//! Tells the linker where ROS 2 is, so that tests start without `LD_LIBRARY_PATH`.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=AMENT_PREFIX_PATH");
    // DT_RPATH, not DT_RUNPATH: only the former is searched for what ROS itself opens at run time.
    println!("cargo::rustc-link-arg=-Wl,--disable-new-dtags");
    // That there is none is said by the build script of r2r.
    let ros = env::var("AMENT_PREFIX_PATH").unwrap_or_default();
    let libraries = env::split_paths(&ros).map(|prefix| prefix.join("lib"));
    for directory in libraries.filter_map(|path| path.canonicalize().ok()) {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{}", directory.display());
    }
}
