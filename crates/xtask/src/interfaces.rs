//! `.deps/interfaces`: message packages that no wheel holds, built from the definitions in `crates/xtask/interfaces`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::python::{self, output, pinned, site_packages};
use crate::ros::{entries, link};
use crate::setup::{Step, remove_folder, replace_folder};

/// What the node needs beside the wheels, or beside the least installation of a ROS 2.
pub(crate) const PACKAGES: [&str; 2] = ["control_msgs", "tf2_msgs"];
const GENERATORS: &str = include_str!("../interfaces/requirements.txt");
/// Comes without a wheel, and is pure Python.
const SOURCE_ONLY: &str = "empy==";
/// Where the wheels were built; their CMake files still say so.
const PYTHON_OF_WHEELS: &str = "/opt/python/cp311-cp311";

/// The packages as a prefix of their own.
pub(crate) fn build_step(layout: &Layout, upstream: &str) -> Outcome<Step> {
    let mut definitions = Vec::new();
    for package in PACKAGES {
        read_all(&source(layout).join(package), &mut definitions)?;
    }
    Ok(Step {
        name: "message packages",
        recipe: format!("{GENERATORS}\n{}\n{upstream}", definitions.join("\n")),
        result: layout.interfaces(),
        make: Box::new(build),
    })
}

/// Lets the Python environment find them.
pub(crate) fn python_step(layout: &Layout, upstream: &str) -> Step {
    let modules = Path::new("lib/python3.11/site-packages");
    let result = layout.venv().join(modules).join("reorder_interfaces.pth");
    let file = result.clone();
    Step {
        name: "message packages for Python",
        recipe: upstream.to_owned(),
        result,
        make: Box::new(move |layout| {
            // The wheels' start-up code takes the libraries of every folder of such a name.
            let libraries = file.with_file_name("ros_reorder_interfaces.libs");
            let _ = fs::remove_file(&libraries);
            link(&layout.interfaces().join("lib"), &libraries)?;
            let line = format!("{}\n", layout.interfaces().join(modules).display());
            fs::write(&file, line).map_err(Failure::io("write", &file))
        }),
    }
}

fn source(layout: &Layout) -> PathBuf {
    layout.root().join("crates/xtask/interfaces")
}

fn read_all(path: &Path, texts: &mut Vec<String>) -> Outcome {
    if path.is_dir() {
        return entries(path)?.iter().try_for_each(|entry| read_all(entry, texts));
    }
    texts.push(fs::read_to_string(path).map_err(Failure::io("read", path))?);
    Ok(())
}

/// The generators live in an environment of their own: it is needed once, and is three times as large as all the rest.
fn build(layout: &Layout) -> Outcome {
    if !Command::new("c++").arg("--version").output().is_ok_and(|run| run.status.success()) {
        return Err(Failure::NoCxxCompiler);
    }
    let generators = layout.deps().join("generators");
    install_generators(layout, &generators)?;
    replace_folder(&layout.interfaces(), |prefix| {
        PACKAGES.iter().try_for_each(|package| build_package(layout, &generators, prefix, package))
    })?;
    remove_folder(&generators)
}

fn install_generators(layout: &Layout, generators: &Path) -> Outcome {
    let wheels = pinned(python::REQUIREMENTS).filter(|line| line.starts_with("ros-") || line.starts_with("numpy"));
    let (source_only, more): (Vec<_>, Vec<_>) = pinned(GENERATORS).partition(|line| line.starts_with(SOURCE_ONLY));
    python::make(layout, generators, &wheels.chain(more).collect::<Vec<_>>())?;
    let install = ["install", "--no-deps", "--no-build-isolation"];
    python::pip(layout, generators, install.iter().chain(&source_only).map(AsRef::as_ref))?;

    let question = "import sysconfig; print(sysconfig.get_paths()['include'])";
    let headers = output("python", Command::new(generators.join("bin/python")).args(["-c", question]))?;
    let headers = String::from_utf8_lossy(&headers.stdout).trim().to_owned();
    let modules = site_packages(generators)?.display().to_string();
    for package in entries(&generators.join("share"))? {
        let files = if package.join("cmake").is_dir() { entries(&package.join("cmake"))? } else { Vec::new() };
        for file in files.iter().filter(|file| file.extension().is_some_and(|extension| extension == "cmake")) {
            let text = fs::read_to_string(file).map_err(Failure::io("read", file))?;
            if text.contains(PYTHON_OF_WHEELS) {
                let text = text.replace(&format!("{PYTHON_OF_WHEELS}/include/python3.11"), &headers);
                let text = text.replace(&format!("{PYTHON_OF_WHEELS}/lib/python3.11/site-packages"), &modules);
                fs::write(file, text).map_err(Failure::io("write", file))?;
            }
        }
    }
    Ok(())
}

fn build_package(layout: &Layout, generators: &Path, prefix: &Path, package: &str) -> Outcome {
    let build = generators.join("build").join(package);
    let cmake = || {
        let mut cmake = Command::new(generators.join("bin/cmake"));
        let path = env::var("PATH").unwrap_or_default();
        cmake.env("PATH", format!("{}:{path}", generators.join("bin").display()));
        for prefixes in ["AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"] {
            cmake.env(prefixes, generators);
        }
        cmake.env("ROS_DISTRO", "jazzy").env("LD_LIBRARY_PATH", generators.join("lib"));
        cmake
    };
    let mut configure = cmake();
    configure.args(["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF"]);
    configure.arg("-S").arg(source(layout).join(package)).arg("-B").arg(&build);
    for (variable, value) in [
        ("CMAKE_INSTALL_PREFIX", prefix.display().to_string()),
        ("Python3_EXECUTABLE", generators.join("bin/python").display().to_string()),
        // Each library finds its package's others, and the wheels', wherever Python loads it from.
        ("CMAKE_INSTALL_RPATH", format!("$ORIGIN;$ORIGIN/../../..;{}", layout.venv().join("lib").display())),
    ] {
        configure.arg(format!("-D{variable}={value}"));
    }
    output("cmake", &mut configure)?;
    output("building the message packages", cmake().arg("--build").arg(&build).args(["--target", "install"])).map(drop)
}
