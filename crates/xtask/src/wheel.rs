//! The wheel of the Python package `reorder`: built, and tried where there is no Rust.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::python::{environment_step, output, pinned, pip, site_packages, wheel};
use crate::setup::{self, Step, remove_folder};

const REQUIREMENTS: &str = include_str!("wheel/requirements.txt");
const PACKAGE: &str = "crates/reorder-py";

/// `.deps/python`: what builds the wheel and what its tests need.
pub(crate) fn step(layout: &Layout) -> Step {
    environment_step(layout, "what builds and tests the Python package", tools(layout), pinned(REQUIREMENTS).collect())
}

pub(crate) fn tools(layout: &Layout) -> PathBuf {
    layout.deps().join("python")
}

/// Builds the wheel and says where it is.
pub(crate) fn run(layout: &Layout, folder: &Path) -> Outcome {
    setup::take(layout, vec![step(layout)])?;
    println!("{}", build(layout, "release", folder)?.display());
    Ok(())
}

/// Builds the wheel with a profile of cargo's into an emptied folder.
pub(crate) fn build(layout: &Layout, profile: &str, folder: &Path) -> Outcome<PathBuf> {
    remove_folder(folder)?;
    let mut maturin = layout.command(tools(layout).join("bin/maturin"));
    maturin.args(["build", "--locked", "--profile", profile, "--manifest-path"]);
    maturin.arg(Path::new(PACKAGE).join("Cargo.toml")).arg("--out").arg(folder);
    // The crate asks for no interpreter in particular; this one is there.
    maturin.env("PYO3_PYTHON", tools(layout).join("bin/python")).env_remove("CONDA_PREFIX").env_remove("VIRTUAL_ENV");
    run_to_end("maturin build", &mut maturin)?;
    let mut files = fs::read_dir(folder).map_err(Failure::io("read", folder))?.flatten().map(|entry| entry.path());
    let is_wheel = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "whl");
    files.find(is_wheel).ok_or_else(|| Failure::step("maturin build", "it left no wheel".to_owned()))
}

/// Installs the wheel into an empty environment, where no Rust is to be found, and runs the tests of the package there.
pub(crate) fn test(layout: &Layout, reorder: &Path) -> Outcome {
    let folder = layout.root().join("target/wheel");
    let built = build(layout, "dev", &folder.join("dev"))?;
    let clean = clean_environment(layout, &folder.join("clean"), &built)?;
    let mut alone = without_rust(layout, &clean);
    alone.args(["-c", "import reorder; print(reorder.order([[0.0, 0], [2, 0.1], [1, 0]], 'r2').verdict)"]);
    output("the wheel in an empty environment", alone.current_dir(&folder))?;
    borrow_tools(layout, &clean)?;
    let mut pytest = without_rust(layout, &clean);
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=5"]);
    pytest.arg(layout.root().join(PACKAGE).join("tests")).current_dir(&folder).env("REORDER_COMMAND", reorder);
    run_to_end("pytest", &mut pytest)
}

/// So many bags on a Ray cluster of two nodes, with workers killed.
pub(crate) fn soak(layout: &Layout, bags: u32) -> Outcome {
    setup::take(layout, vec![step(layout)])?;
    let folder = layout.root().join("target/wheel");
    let built = build(layout, "release", &folder.join("release"))?;
    let reorder = build_executables(layout, &["build", "--release", "--package", "reorder-cli"])?;
    let reorder = reorder.first().ok_or_else(|| Failure::step("cargo build", "no reorder was built".to_owned()))?;
    let clean = clean_environment(layout, &folder.join("soak"), &built)?;
    borrow_tools(layout, &clean)?;
    let mut soak = without_rust(layout, &clean);
    soak.arg(layout.root().join(PACKAGE).join("tests/soak_fleet.py")).arg(bags.to_string());
    run_to_end("soak fleet", soak.current_dir(&folder).env("REORDER_COMMAND", reorder))
}

/// The tests' own needs come after what was installed, and so do not hide that something is missing from it.
fn borrow_tools(layout: &Layout, clean: &Path) -> Outcome {
    let borrowed = site_packages(clean)?.join("tests.pth");
    let text = format!("{}\n", site_packages(&tools(layout))?.display());
    fs::write(&borrowed, text).map_err(Failure::io("write", &borrowed))
}

/// Python of an environment, with a search path without the folders that hold cargo or rustc.
fn without_rust(layout: &Layout, environment: &Path) -> Command {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let has_rust = |folder: &PathBuf| ["cargo", "rustc"].iter().any(|program| folder.join(program).exists());
    let path = std::env::join_paths(std::env::split_paths(&path).filter(|folder| !has_rust(folder)));
    let mut python = layout.command(environment.join("bin/python"));
    python.env("PATH", path.unwrap_or_default()).env_remove("PYTHONPATH");
    python
}

fn run_to_end(what: &str, command: &mut Command) -> Outcome {
    let status = command.status().map_err(Failure::io("run", command.get_program().to_owned()))?;
    if status.success() { Ok(()) } else { Err(Failure::Command { what: what.to_owned(), status }) }
}

/// An environment with the wheel and what it says that it needs, and nothing else.
pub(crate) fn clean_environment(layout: &Layout, folder: &Path, built: &Path) -> Outcome<PathBuf> {
    remove_folder(folder)?;
    let mut venv = layout.command(tools(layout).join("bin/python"));
    output("python -m venv", venv.args(["-m", "venv"]).arg(folder))?;
    let numpy = pinned(REQUIREMENTS).find(|line| line.starts_with("numpy==")).unwrap_or("numpy");
    let numpy = wheel(layout, numpy)?;
    let from = numpy.parent().unwrap_or(Path::new("."));
    let arguments = ["install".as_ref(), "--no-index".as_ref(), "--find-links".as_ref(), from.as_os_str()];
    pip(layout, folder, arguments.into_iter().chain([built.as_os_str()]))?;
    Ok(folder.to_owned())
}
