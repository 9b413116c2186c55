//! Guards the architecture: which crate may depend on which, one nalgebra, and Rust alone for the default members.

use cargo_metadata::{Metadata, MetadataCommand};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const ALL: &[&str] =
    &["se3-geom", "reorder", "manipulator", "pose-bag", "planner", "report", "mujoco-sim", "dynamixel-emulator"];

/// The arrows of the architecture, tests and build scripts included. A new crate needs a row.
const MAY_DEPEND_ON: &[(&str, &[&str])] = &[
    ("se3-geom", &[]),
    ("reorder", &["se3-geom"]),
    ("manipulator", &["se3-geom"]),
    ("pose-bag", &["se3-geom"]),
    ("planner", &["se3-geom", "reorder", "manipulator", "pose-bag"]),
    ("bag-replay", &["planner"]),
    ("report", &["planner"]),
    ("mujoco-sim", &["planner"]),
    ("arm-node", &["planner"]),
    ("mujoco-arm", &["planner", "mujoco-sim", "arm-node"]),
    ("dynamixel-emulator", &[]),
    ("dynamixel-hil", &["planner", "mujoco-sim", "dynamixel-emulator"]),
    ("dynamixel-arm", &["planner", "dynamixel-hil", "arm-node"]),
    ("reorder-node", &["planner"]),
    ("reorder-cli", &["planner", "pose-bag", "bag-replay", "report"]),
    ("reorder-py", &["bag-replay"]),
    ("xtask", &[]),
    ("end-to-end", ALL),
];

/// What plain `cargo build` must do without: these need ROS 2, MuJoCo or Python.
const NOT_RUST_ALONE: &[&str] = &["r2r", "mujoco-rs", "pyo3"];

fn workspace() -> Metadata {
    MetadataCommand::new().manifest_path("../../Cargo.toml").no_deps().exec().expect("cargo metadata")
}

#[test]
fn crates_depend_only_on_what_the_architecture_allows() {
    let workspace = workspace();
    let members: BTreeSet<_> = workspace.packages.iter().map(|package| package.name.as_str()).collect();
    assert!(members.contains("planner"), "found only {members:?}");
    let allowed: BTreeMap<_, _> = MAY_DEPEND_ON.iter().copied().collect();
    let mut new_arrows = Vec::new();
    for package in &workspace.packages {
        let name = package.name.as_str();
        let allowed = allowed.get(name).unwrap_or_else(|| panic!("{name} has no row in MAY_DEPEND_ON"));
        for dependency in package.dependencies.iter().map(|dependency| dependency.name.as_str()) {
            if members.contains(dependency) && !allowed.contains(&dependency) {
                new_arrows.push(format!("{name} -> {dependency}"));
            }
        }
    }
    assert_eq!(new_arrows, Vec::<String>::new());
}

#[test]
fn there_is_one_nalgebra() {
    let locked = LockedPackages::read();
    let versions: Vec<_> = locked.0.iter().filter(|package| package.name == "nalgebra").map(|p| &p.version).collect();
    assert_eq!(versions.len(), 1, "nalgebra occurs as {versions:?}");
}

#[test]
fn default_members_need_rust_alone() {
    let locked = LockedPackages::read();
    let workspace = workspace();
    let default_members: Vec<_> = workspace.workspace_default_packages();
    assert!(default_members.len() < workspace.packages.len() && !default_members.is_empty());
    let needs = |name: &str| -> Vec<_> {
        let needed = locked.needed_by(name);
        NOT_RUST_ALONE.iter().filter(|foreign| needed.contains(**foreign)).copied().collect()
    };
    for member in default_members {
        assert_eq!(needs(&member.name), Vec::<&str>::new(), "{} is a default member", member.name);
    }
    assert_eq!(needs("reorder-node"), ["r2r"], "the search itself finds nothing");
}

/// The wheel is built alone, with the features that its own dependencies ask for: where these are others than in a build of the whole
/// workspace, all that depends on them is compiled once more, which takes many minutes.
#[test]
fn the_wheel_shares_its_build_with_the_tests() {
    let of_workspace = packages_with_features(&["--workspace", "--edges", "normal,build,dev"]);
    let of_wheel =
        packages_with_features(&["--package", "reorder-py", "--features", "wheel", "--edges", "normal,build"]);
    assert!(of_wheel.iter().any(|line| line.starts_with("nalgebra ")), "{of_wheel:?}");
    // These know whether an interpreter is linked.
    let is_python = |line: &&String| ["pyo3", "reorder-py "].iter().any(|name| line.starts_with(name));
    let others: Vec<_> = of_wheel.difference(&of_workspace).filter(|line| !is_python(line)).collect();
    assert!(others.is_empty(), "ask for the workspace's features of these under [features] of reorder-py: {others:#?}");
}

fn packages_with_features(arguments: &[&str]) -> BTreeSet<String> {
    let mut cargo = std::process::Command::new(env!("CARGO"));
    cargo.args(["tree", "--offline", "--locked", "--prefix", "none", "--format", "{p} {f}", "--manifest-path"]);
    let tree = cargo.arg("../../Cargo.toml").args(arguments).output().expect("cargo tree");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).expect("text");
    text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// Cargo.lock is the resolved graph, and reading it needs no network.
struct LockedPackages(Vec<LockedPackage>);

struct LockedPackage {
    name: String,
    version: String,
    dependencies: Vec<String>,
}

impl LockedPackages {
    fn read() -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../Cargo.lock");
        let lock: toml::Table = std::fs::read_to_string(path).expect("Cargo.lock").parse().expect("TOML");
        let text = |value: &toml::Value| value.as_str().expect("a string").to_owned();
        let packages = lock["package"].as_array().expect("packages").iter().map(|package| LockedPackage {
            name: text(&package["name"]),
            version: text(&package["version"]),
            dependencies: package.get("dependencies").map_or_else(Vec::new, |list| {
                let names = list.as_array().expect("a list").iter().map(text);
                names.map(|name| name.split(' ').next().expect("a name").to_owned()).collect()
            }),
        });
        Self(packages.collect())
    }

    /// All packages that one brings with it; those of one name are taken together, whatever their version.
    fn needed_by(&self, name: &str) -> BTreeSet<&str> {
        let mut needed = BTreeSet::new();
        let mut open = vec![name];
        while let Some(name) = open.pop() {
            let packages = self.0.iter().filter(|package| package.name == name);
            for dependency in packages.flat_map(|package| &package.dependencies) {
                if needed.insert(dependency.as_str()) {
                    open.push(dependency);
                }
            }
        }
        needed
    }
}
