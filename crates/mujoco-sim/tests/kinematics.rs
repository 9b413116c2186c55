//! The planner's arm and the simulated arm are the same arm.
#![allow(clippy::unwrap_used)]

use mujoco_sim::planner::manipulator::Robot;
use mujoco_sim::planner::manipulator::nalgebra::{DVector, Quaternion, UnitQuaternion};
use mujoco_sim::{SimulatedArm, TOOL_SITE, model_file};

/// SplitMix64: the same configurations on every machine.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What planning needs. The figures of both descriptions of the UR5e and the ViperX are the same to the last digit, so that rounding
/// alone would be 1e-14; the Panda's model has quaternions of seven digits.
const BOUND_M: f64 = 1e-6;
const BOUND_RAD: f64 = 1e-6;

#[test]
fn the_ur5e_agrees_on_1000_random_configurations() {
    assert_agreement("ur5e");
}

#[test]
fn the_viperx_agrees_on_1000_random_configurations() {
    assert_agreement("vx300s");
}

#[test]
fn the_panda_agrees_on_1000_random_configurations() {
    assert_agreement("panda");
}

fn assert_agreement(name: &str) {
    let robot = Robot::shipped(name).unwrap();
    let mut arm = SimulatedArm::load(model_file(name).unwrap(), TOOL_SITE).unwrap();
    assert!(arm.joint_names().eq(robot.chain.joint_names()), "the joints stand in another order");
    let mut random = Random(7);
    let (mut told_apart, mut worst) = (0, (0.0f64, 0.0f64));
    for _ in 0..1000 {
        let between = |i: usize| (robot.limits.lower[i], robot.limits.upper[i]);
        let q: Vec<f64> = (0..robot.chain.dof()).map(|i| random.between(between(i).0, between(i).1)).collect();
        let simulated = arm.tool_pose(&q).unwrap();
        let planned = robot.chain.forward(&DVector::from_vec(q));
        let (metres, radians) = (
            (simulated.translation.vector - planned.translation.vector).norm(),
            simulated.rotation.angle_to(&planned.rotation),
        );
        assert!(metres < BOUND_M && radians < BOUND_RAD, "{name}: {metres} m, {radians} rad apart");
        worst = (worst.0.max(metres), worst.1.max(radians));

        // The same four numbers read w first, or the rotation the wrong way round, must not pass for the same.
        let [x, y, z, w] = [planned.rotation.i, planned.rotation.j, planned.rotation.k, planned.rotation.w];
        let w_first = UnitQuaternion::new_normalize(Quaternion::new(x, y, z, w));
        let apart = |other: &UnitQuaternion<f64>| simulated.rotation.angle_to(other) > 1e3 * BOUND_RAD;
        told_apart += usize::from(apart(&w_first) && apart(&planned.rotation.inverse()));
    }
    println!("{name}: at worst {:.1e} m, {:.1e} rad apart", worst.0, worst.1);
    assert!(told_apart > 990, "only {told_apart} of the configurations tell quaternion orders apart");
}
