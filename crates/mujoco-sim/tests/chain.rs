//! Chains read from MJCF: those of the URDFs, MuJoCo's own kinematics, and refusals by name.
#![allow(clippy::unwrap_used)]

use std::fs;

use mujoco_sim::planner::manipulator::nalgebra::DVector;
use mujoco_sim::planner::manipulator::{Chain, Robot};
use mujoco_sim::planner::se3_geom::{LieGroup, Manifold, Se3, Se3Group};
use mujoco_sim::{SimulatedArm, TOOL_SITE, model_file, read_chain};

fn read(mjcf: &str) -> Result<Chain, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.xml");
    fs::write(&file, mjcf).unwrap();
    read_chain(&file, "tool").map_err(|error| error.to_string())
}

/// Configurations that neither repeat nor favour an axis.
fn configurations(chain: &Chain) -> impl Iterator<Item = DVector<f64>> + '_ {
    (0..50).map(|k| DVector::from_fn(chain.dof(), |j, _| 2.0 * ((31 * k + 7 * j + 1) as f64).sin()))
}

#[test]
fn chains_of_the_shipped_arms_are_those_of_their_urdfs() {
    for name in Robot::shipped_names() {
        let (robot, chain) = (Robot::shipped(name).unwrap(), read_chain(model_file(name).unwrap(), TOOL_SITE).unwrap());
        assert_eq!(chain.joint_names(), robot.chain.joint_names());
        for q in configurations(&chain) {
            // The Panda's model has quaternions of seven digits.
            assert!(Se3::default().distance(&chain.forward(&q), &robot.chain.forward(&q)) < 1e-6, "{name}");
            assert!((chain.body_jacobian(&q) - robot.chain.body_jacobian(&q)).amax() < 1e-6, "{name}");
        }
    }
}

/// A slide, hinges off their bodies' origins, two of them in one body, references other than zero, skew axes and a turned tool.
const AWKWARD: &str = r#"<mujoco><compiler angle="radian" autolimits="true"/><worldbody>
  <body pos="0.1 0.2 0.3" euler="0.4 0.1 -0.7"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    <joint name="rail" type="slide" axis="1 2 2" ref="0.25"/>
    <body pos="0 0.3 0" euler="1 0 0.5"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <joint name="pan" axis="0 3 4" pos="0.1 -0.2 0.05" ref="-0.6"/>
      <joint name="tilt" axis="1 0 0" pos="0 0.07 0"/>
      <body pos="0.5 0 0.1"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <joint name="roll" axis="1 1 0" ref="1.1"/>
        <site name="tool" pos="0.02 0.3 -0.1" euler="0.3 0.2 0.1"/>
        <body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="finger"/></body>
      </body>
    </body>
  </body></worldbody>
  <actuator><position joint="rail"/><position joint="pan"/><position joint="tilt"/><position joint="roll"/></actuator>
</mujoco>"#;

#[test]
fn any_chain_moves_as_in_mujoco() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("awkward.xml");
    fs::write(&file, AWKWARD).unwrap();
    let mut arm = SimulatedArm::load(&file, "tool").unwrap();
    let chain = read_chain(&file, "tool").unwrap();
    assert_eq!(chain.joint_names(), ["rail", "pan", "tilt", "roll"]);
    for q in configurations(&chain) {
        let simulated = arm.tool_pose(q.as_slice()).unwrap();
        // Lengths of at most a few metres, some twenty products, and a matrix turned into a quaternion: a few roundings.
        assert!(Se3::default().distance(&chain.forward(&q), &simulated) < 1e-13);

        // Central differences of MuJoCo's own poses along a direction: halving the step must quarter the error.
        let direction = DVector::from_fn(4, |j, _| (3.0 * j as f64 + q[0]).cos());
        let defect = |h: f64| {
            let before = arm.tool_pose((&q - &direction * h).as_slice()).unwrap();
            let after = arm.tool_pose((&q + &direction * h).as_slice()).unwrap();
            let twist = Se3Group::log(&(before.inverse() * after)).unwrap().to_vector();
            (twist / (2.0 * h) - chain.body_jacobian(&q) * &direction).norm()
        };
        let [coarse, fine] = [0.02, 0.01].map(defect);
        assert!(fine < 1e-3 && (fine < 1e-9 || (coarse / fine - 4.0).abs() < 0.1), "{coarse} {fine}");
    }
}

#[test]
fn what_is_no_chain_is_refused_by_name() {
    let coupling = |active: &str| {
        let constraint =
            format!(r#"<equality><joint joint1="tilt" joint2="finger" active="{active}"/></equality></mujoco>"#);
        AWKWARD.replace("</mujoco>", &constraint)
    };
    assert_eq!(read(&coupling("false")).unwrap().dof(), 4);
    let ball = AWKWARD.replace(r#"name="roll" axis="1 1 0" ref="1.1""#, r#"name="roll" type="ball""#);
    for (mjcf, named) in [
        (coupling("true"), "\"tilt\" is coupled"),
        (ball.replace(r#"<position joint="roll"/>"#, ""), "\"roll\" is a ball joint"),
        (AWKWARD.replace(r#"name="tilt" "#, "").replace(r#"<position joint="tilt"/>"#, ""), "joint 2 has no name"),
        (AWKWARD.replace(r#"name="tool""#, r#"name="hand""#), "no site \"tool\""),
        (r#"<mujoco><worldbody><site name="tool"/></worldbody></mujoco>"#.into(), "nothing moves the tool"),
        (
            r#"<mujoco><worldbody><body><freejoint name="base"/><geom size="1"/><site name="tool"/></body></worldbody></mujoco>"#
                .into(),
            "\"base\" is a free joint",
        ),
    ] {
        let message = read(&mjcf).unwrap_err();
        assert!(message.contains(named) && !message.contains('\n'), "{named:?} is not in {message:?}");
    }
}
