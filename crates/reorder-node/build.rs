//! Tells the linker where the ROS 2 libraries are, so that the node starts without `LD_LIBRARY_PATH`.

use std::path::Path;
use std::{env, process};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=AMENT_PREFIX_PATH");
    let prefixes = env::var("AMENT_PREFIX_PATH").unwrap_or_default();
    let libraries: Vec<_> = env::split_paths(&prefixes).map(|prefix| prefix.join("lib")).collect();
    if !libraries.iter().any(|directory| directory.join("librcl.so").exists()) {
        stop(&format!("no ROS 2 in AMENT_PREFIX_PATH={prefixes:?}: source one, or run `cargo xtask setup` first"));
    }
    // DT_RPATH, not DT_RUNPATH: only the former is searched for what ROS itself opens at run time.
    println!("cargo::rustc-link-arg=-Wl,--disable-new-dtags");
    for directory in libraries.iter().filter(|directory| directory.is_dir()) {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{}", absolute(directory));
    }
}

fn absolute(directory: &Path) -> String {
    match directory.canonicalize() {
        Ok(path) => path.display().to_string(),
        Err(error) => stop(&format!("cannot read {}: {error}", directory.display())),
    }
}

fn stop(sentence: &str) -> ! {
    println!("cargo::error={sentence}");
    process::exit(1);
}
