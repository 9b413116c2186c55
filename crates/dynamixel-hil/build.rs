//! Tells the linker where MuJoCo and libpython are, so that nothing here needs `LD_LIBRARY_PATH`.

use std::path::Path;
use std::{env, process};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    let mujoco = env::var("MUJOCO_DYNAMIC_LINK_DIR").unwrap_or_default();
    if !Path::new(&mujoco).join("libmujoco.so").exists() {
        println!("cargo::error=no libmujoco.so in MUJOCO_DYNAMIC_LINK_DIR={mujoco:?}: run `cargo xtask setup` first");
        process::exit(1);
    }
    println!("cargo::rustc-link-arg=-Wl,-rpath,{mujoco}");
    // The interpreter that pyo3 was built for, and not another libpython of the same name that the loader comes across.
    pyo3_build_config::add_libpython_rpath_link_args();
    if let Some(libpython) = pyo3_build_config::get().lib_dir() {
        println!("cargo::metadata=libpython={libpython}");
    }
}
