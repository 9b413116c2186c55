//! Torques: ours against MuJoCo's inverse dynamics.
#![allow(clippy::unwrap_used)]

#[path = "support/oracle.rs"]
mod oracle;

use std::fs;

use mujoco_rs::prelude::*;
use mujoco_sim::planner::manipulator::Robot;
use mujoco_sim::planner::manipulator::nalgebra::{DVector, UnitQuaternion, Vector3};
use mujoco_sim::planner::se3_geom::Pose;
use mujoco_sim::planner::{Config, Request, plan};
use mujoco_sim::{ExecuteOptions, SimulatedArm, TOOL_SITE, model_file, read_dynamics};
use oracle::{Oracle, ours};

/// States that neither repeat nor favour a joint: two rad, 3 rad/s, 10 rad/s².
fn states(dof: usize) -> impl Iterator<Item = [DVector<f64>; 3]> {
    let vector = move |k: usize, order: usize, size: f64| {
        DVector::from_fn(dof, |j, _| size * ((31 * k + 7 * j + 101 * order + 1) as f64).sin())
    };
    (0..200).map(move |k| [vector(k, 0, 2.0), vector(k, 1, 3.0), vector(k, 2, 10.0)])
}

/// The greatest deviation as a part of the greatest torque of any joint.
fn deviation(mut one: impl FnMut([&DVector<f64>; 3]) -> DVector<f64>, oracle: &mut Oracle) -> f64 {
    let dof = oracle.dof();
    let (mut worst, mut peak) = (0.0_f64, 0.0_f64);
    for [q, rates, accelerations] in &states(dof).collect::<Vec<_>>() {
        let state = [q, rates, accelerations];
        let theirs = oracle.torque(state);
        worst = worst.max((one(state) - &theirs).amax());
        peak = peak.max(theirs.amax());
    }
    assert!(peak > 1.0 && worst.is_finite());
    worst / peak
}

/// MuJoCo has a URDF reader of its own, which shares no line with ours. It knows no rotor inertia, as URDF has none.
#[test]
fn torques_are_those_of_mujoco_reading_the_same_urdf() {
    for name in Robot::shipped_names() {
        let robot = Robot::shipped(name).unwrap();
        let urdf =
            fs::read_to_string(format!("{}/../../config/robots/{name}.urdf", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let mut oracle = Oracle::new(MjModel::from_xml_string(&urdf).unwrap(), robot.chain.joint_names());
        let dynamics = robot.dynamics.as_ref().unwrap();
        let rotors: Vec<f64> = dynamics.drives().map(|drive| drive.rotor_inertia_kg_m2).collect();
        let of_links = |state: [&DVector<f64>; 3]| {
            ours(dynamics, state) - DVector::from_column_slice(&rotors).component_mul(state[2])
        };
        let apart = deviation(of_links, &mut oracle);
        println!("{name}: {apart:.1e}");
        assert!(apart < 1e-6, "{name}: torques differ by {apart} of their peak");
    }
}

#[test]
fn torques_of_any_model_are_mujocos_own() {
    let folder = tempfile::tempdir().unwrap();
    let awkward = folder.path().join("awkward.xml");
    fs::write(&awkward, AWKWARD).unwrap();
    let shipped = Robot::shipped_names().map(|name| (model_file(name).unwrap(), TOOL_SITE));
    for (file, site) in shipped.chain([(awkward, "tool")]) {
        let chain = mujoco_sim::read_chain(&file, site).unwrap();
        let dynamics = read_dynamics(&file, site).unwrap();
        let mut oracle = Oracle::new(MjModel::from_xml(&file).unwrap(), chain.joint_names());
        // Rounding of some hundred products, and MuJoCo's quaternions of principal axes.
        let apart = deviation(|state| ours(&dynamics, state), &mut oracle);
        assert!(apart < 1e-10, "{}: {apart}", file.display());
    }
}

/// A slide, two hinges in one body, skew axes, bodies off the axes, a body that hangs on a joint aside, gravity aslant.
const AWKWARD: &str = r#"<mujoco><compiler angle="radian"/><option gravity="1 -2 -9"/><worldbody>
  <body pos="0.1 0.2 0.3" euler="0.4 0.1 -0.7"><inertial pos="0.1 0 0.2" mass="2" diaginertia="0.1 0.2 0.15" euler="1 2 3"/>
    <joint name="rail" type="slide" axis="1 2 2" ref="0.25" armature="0.4" damping="3"/>
    <body pos="0 0.3 0" euler="1 0 0.5"><inertial pos="0 0.3 0.1" mass="1.5" diaginertia="0.03 0.02 0.04"/>
      <joint name="pan" axis="0 3 4" pos="0.1 -0.2 0.05" ref="-0.6"/>
      <joint name="tilt" axis="1 0 0" pos="0 0.07 0" damping="0.5"/>
      <body pos="0.5 0 0.1"><inertial pos="-0.1 0.1 0.2" mass="1" diaginertia="0.01 0.02 0.02"/>
        <joint name="roll" axis="1 1 0" ref="1.1" armature="0.02"/>
        <site name="tool" pos="0.02 0.3 -0.1"/>
        <body pos="0.1 0 0"><inertial pos="0 0.2 0" mass="0.3" diaginertia="0.01 0.01 0.01"/></body>
      </body>
    </body>
  </body></worldbody></mujoco>"#;

/// What the planned trajectory is said to need is what the executed motion did need: MuJoCo's inverse dynamics at the positions,
/// velocities and differences of velocities that the simulated arm went through.
#[test]
fn torques_on_executed_trajectories_are_predicted_within_one_percent() {
    for name in Robot::shipped_names() {
        let robot = Robot::shipped(name).unwrap();
        let file = model_file(name).unwrap();
        let mut oracle = Oracle::new(MjModel::from_xml(&file).unwrap(), robot.chain.joint_names());
        let mut arm = SimulatedArm::load(&file, TOOL_SITE).unwrap();
        let trajectory = planned(&robot);
        let every_step = ExecuteOptions { sample_rate_hz: 1e4, ..ExecuteOptions::default() };
        let execution = arm.execute(&trajectory, &every_step).unwrap();
        let dof = robot.chain.dof();
        let (mut worst, mut peak) = (DVector::zeros(dof), DVector::zeros(dof));
        for step in execution.samples.windows(2) {
            let [now, after] = [&step[0], &step[1]];
            if after.time_s > execution.duration_s {
                break;
            }
            // MuJoCo moves a joint over a step with the velocity at its end, so that velocities are those of half a step earlier.
            let velocity = (&now.velocity + &after.velocity) * 0.5;
            let acceleration = (&after.velocity - &now.velocity) / (after.time_s - now.time_s);
            let needed = oracle.torque([&now.position, &velocity, &acceleration]);
            let [q, rates, accelerations, _] = trajectory.at(now.time_s);
            let predicted = ours(robot.dynamics.as_ref().unwrap(), [&q, &rates, &accelerations]);
            worst = worst.zip_map(&(predicted - &needed), |w: f64, d| w.max(d.abs()));
            peak = peak.zip_map(&needed, |p: f64, t| p.max(t.abs()));
        }
        let ratio = worst.component_div(&peak);
        println!("{name}: {:.1e} of the peaks {peak:.2}", ratio.amax());
        assert!(ratio.amax() < 0.01, "{name}: {ratio}");
    }
}

/// A swinging arc with the tool turning, at the arm's full limits.
fn planned(robot: &Robot) -> mujoco_sim::planner::manipulator::JointTrajectory {
    let first = robot.chain.forward(&robot.preferred);
    let poses: Vec<Pose> = (0..40)
        .map(|i| {
            let angle = 4.0 * f64::from(i) / 39.0;
            let mut pose = first;
            pose.translation.vector += 0.08 * Vector3::new(1.0 - angle.cos(), angle.sin(), 0.3 * angle.sin());
            pose.rotation *= UnitQuaternion::from_scaled_axis(Vector3::new(0.2, -0.3, 0.1) * angle.sin());
            pose
        })
        .collect();
    let request = Request { poses, start: Some(robot.preferred.as_slice().to_vec()), ..Request::default() };
    plan(robot, &Config::default(), &request).unwrap().trajectory
}
