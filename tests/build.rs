//! Tells the linker where MuJoCo is, so that the tests start without `LD_LIBRARY_PATH`.

use std::path::Path;
use std::{env, process};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    let directory = env::var("MUJOCO_DYNAMIC_LINK_DIR").unwrap_or_default();
    if !Path::new(&directory).join("libmujoco.so").exists() {
        println!(
            "cargo::error=no libmujoco.so in MUJOCO_DYNAMIC_LINK_DIR={directory:?}: run `cargo xtask setup` first"
        );
        process::exit(1);
    }
    println!("cargo::rustc-link-arg=-Wl,-rpath,{directory}");
}
