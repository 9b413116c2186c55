//! An arm that is led step by step goes where one that executes a whole trajectory goes.
#![allow(clippy::unwrap_used)]

mod support;

use mujoco_sim::planner::manipulator::nalgebra::DVector;
use mujoco_sim::{ExecuteOptions, Reference, SimError};
use support::{HOME, quintic_move, ur5e};

const GOAL: [f64; 6] = [-0.6, -1.2, 1.2, -1.8, -1.0, 0.8];

#[test]
fn steps_towards_references_are_those_of_an_execution() {
    let trajectory = quintic_move(HOME, GOAL, 1.0);
    let mut arm = ur5e();
    let whole = arm.execute(&trajectory, &ExecuteOptions { settle_s: 0.0, ..ExecuteOptions::default() }).unwrap();
    let last = whole.samples.last().unwrap();

    let mut led = ur5e();
    led.stand_at(&HOME).unwrap();
    let steps = (last.time_s / whole.timestep_s).round() as usize;
    for step in 0..steps {
        let time_s = step as f64 * whole.timestep_s;
        let [position, velocity, acceleration, _] = trajectory.at(time_s);
        let mid_velocity = trajectory.at(time_s + 0.5 * whole.timestep_s)[1].clone();
        let reference = Reference { position, velocity, acceleration, mid_velocity };
        assert_eq!(led.step_towards(&reference).unwrap(), whole.timestep_s);
    }
    assert_eq!(led.joint_state(), (last.position.clone(), last.velocity.clone()));
}

#[test]
fn a_reference_that_is_none_is_refused() {
    let mut arm = ur5e();
    let short = arm.step_towards(&Reference::rest(DVector::zeros(5))).unwrap_err();
    assert!(matches!(short, SimError::WrongSize { given: 5, expected: 6, .. }), "{short}");
    let nan = arm.step_towards(&Reference::rest(DVector::repeat(6, f64::NAN))).unwrap_err();
    assert_eq!(nan.to_string(), "the reference position contains a value that is not a finite number");
}
