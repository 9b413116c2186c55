//! The ROS package as an ament prefix, which a sourced ROS 2 finds.

use std::fs;
use std::path::{Path, PathBuf};

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::ros::entries;
use crate::setup;

/// The name under which `ros2 run` and launch files know it, and the cargo packages of its executables.
pub(crate) const PACKAGE: &str = "reorder_node";
pub(crate) const BUILT: [&str; 3] = ["reorder-node", "mujoco-arm", "dynamixel-arm"];
const EXECUTABLES: [&str; 3] = ["reorder_node", "mujoco_arm", "dynamixel_arm"];
/// What is copied to `share/reorder_node`.
const SHARED: [&str; 2] = ["launch", "config"];

/// Builds the executables, and puts the package into `prefix`, beside whatever else is there.
pub(crate) fn run(layout: &Layout, prefix: &Path) -> Outcome {
    setup::run(layout)?;
    let executables = build(layout)?;
    let prefix = std::path::absolute(prefix).map_err(Failure::io("find", prefix))?;
    write(layout.root(), &executables, &prefix)?;
    println!("ros2 finds {PACKAGE} after: source {}", prefix.join("local_setup.bash").display());
    Ok(())
}

/// The executables of the package, built.
pub(crate) fn build(layout: &Layout) -> Outcome<Vec<PathBuf>> {
    let packages: Vec<&str> = BUILT.iter().flat_map(|package| ["--package", package]).collect();
    let built = build_executables(layout, &[&["build"], &packages[..]].concat())?;
    EXECUTABLES
        .iter()
        .map(|name| {
            let found = built.iter().find(|path| path.file_name().is_some_and(|file| file == *name));
            found.cloned().ok_or_else(|| Failure::step("cargo build", format!("no executable {name} was built")))
        })
        .collect()
}

/// The same, as an earlier build left them beside this program.
pub(crate) fn built_before() -> Outcome<Vec<PathBuf>> {
    let here = std::env::current_exe().map_err(Failure::io("find", "this program"))?;
    let of = |name: &&str| {
        let path = here.with_file_name(name);
        if path.is_file() { Ok(path) } else { Err(Failure::step("the launch", format!("{name} is not built"))) }
    };
    EXECUTABLES.iter().map(of).collect()
}

fn write(root: &Path, executables: &[PathBuf], prefix: &Path) -> Outcome {
    let share = prefix.join("share").join(PACKAGE);
    let lib = prefix.join("lib").join(PACKAGE);
    fs::create_dir_all(&lib).map_err(Failure::io("create", &lib))?;
    for executable in executables {
        let copy = lib.join(executable.file_name().unwrap_or_default());
        // A running one cannot be written over, but its name can be given to another.
        let _ = fs::remove_file(&copy);
        fs::copy(executable, &copy).map_err(Failure::io("copy", executable))?;
    }
    for folder in SHARED {
        copy_folder(&root.join(folder), &share.join(folder))?;
    }
    let marker = prefix.join("share/ament_index/resource_index/packages").join(PACKAGE);
    write_file(&marker, "")?;
    write_file(&share.join("package.xml"), &manifest())?;
    write_file(&prefix.join("local_setup.bash"), SETUP)
}

/// `ros2` looks for packages in every prefix that this variable names.
const SETUP: &str = "\
# Source a ROS 2 first, then this.
export AMENT_PREFIX_PATH=\"$(cd \"$(dirname \"${BASH_SOURCE[0]}\")\" && pwd)${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}\"
";

fn manifest() -> String {
    format!(
        "<?xml version=\"1.0\"?>
<package format=\"3\">
  <name>{PACKAGE}</name>
  <version>{}</version>
  <description>Unordered poses in, an audited joint trajectory out; and an arm in MuJoCo to try it with.</description>
  <maintainer email=\"nobody@example.com\">the authors of reorder</maintainer>
  <license>Apache-2.0 OR MIT</license>
  <exec_depend>control_msgs</exec_depend>
  <exec_depend>diagnostic_msgs</exec_depend>
  <exec_depend>lifecycle_msgs</exec_depend>
  <exec_depend>nav_msgs</exec_depend>
  <exec_depend>sensor_msgs</exec_depend>
  <exec_depend>std_srvs</exec_depend>
  <exec_depend>tf2_msgs</exec_depend>
  <exec_depend>trajectory_msgs</exec_depend>
  <exec_depend>visualization_msgs</exec_depend>
  <export>
    <build_type>ament_cargo</build_type>
  </export>
</package>
",
        env!("CARGO_PKG_VERSION")
    )
}

fn copy_folder(from: &Path, to: &Path) -> Outcome {
    fs::create_dir_all(to).map_err(Failure::io("create", to))?;
    for entry in entries(from)? {
        let copy = to.join(entry.file_name().unwrap_or_default());
        if entry.is_dir() {
            copy_folder(&entry, &copy)?;
        } else {
            fs::copy(&entry, &copy).map_err(Failure::io("copy", &entry))?;
        }
    }
    Ok(())
}

fn write_file(file: &Path, text: &str) -> Outcome {
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(Failure::io("create", folder))?;
    fs::write(file, text).map_err(Failure::io("write", file))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice, as an update is.
    #[test]
    fn a_prefix_has_what_ros_looks_for() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let folder = tempfile::tempdir().unwrap();
        let built = folder.path().join("reorder_node");
        fs::write(&built, "an executable").unwrap();
        let prefix = folder.path().join("prefix");
        for _ in 0..2 {
            write(&root, std::slice::from_ref(&built), &prefix).unwrap();
        }
        for file in [
            "lib/reorder_node/reorder_node",
            "share/ament_index/resource_index/packages/reorder_node",
            "share/reorder_node/package.xml",
            "share/reorder_node/launch/reorder.launch.yaml",
            "share/reorder_node/config/reorder.yaml",
            "share/reorder_node/config/robots/ur5e.urdf",
        ] {
            assert!(prefix.join(file).is_file(), "{file}");
        }
        let sourced = std::process::Command::new("bash")
            .args(["-c", "source \"$0/local_setup.bash\" && echo $AMENT_PREFIX_PATH"])
            .arg(&prefix)
            .env("AMENT_PREFIX_PATH", "/opt/ros/jazzy")
            .output()
            .unwrap();
        let prefixes = String::from_utf8(sourced.stdout).unwrap();
        assert_eq!(prefixes.trim(), format!("{}:/opt/ros/jazzy", prefix.display()));
    }
}
