//! The simulated arm, its controller and its clock.

use std::sync::{Mutex, MutexGuard, PoisonError};

use mujoco_sim::planner::manipulator::nalgebra::DVector;
use mujoco_sim::{SimError, SimulatedArm, TOOL_SITE, model_file};
use planner::manipulator::{JointTrajectory, Robot};

use crate::controller::{Controller, Refused};

pub(crate) struct World {
    arm: SimulatedArm,
    controller: Controller,
    /// For each joint of the robot its place among the servos of the model, and the other way round.
    servo_of: Vec<usize>,
    joint_of: Vec<usize>,
    pub(crate) joint_names: Vec<String>,
    now_s: f64,
    timestep_s: f64,
    /// Counts what was played, so that whoever asked for something sees that it is over.
    number: u64,
}

/// The joints at one time, in the robot's order.
pub(crate) struct Present {
    pub(crate) now_s: f64,
    pub(crate) number: u64,
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) desired: [Vec<f64>; 3],
    pub(crate) goal: Vec<f64>,
    pub(crate) ends_at_s: f64,
}

impl World {
    /// The arm at rest at `positions`, at time 0.
    pub(crate) fn new(name: &str, robot: Robot, positions: &[f64]) -> Result<Self, SimError> {
        let mut arm = SimulatedArm::load(model_file(name)?, TOOL_SITE)?;
        let joint_names = robot.chain.joint_names().to_vec();
        let servos: Vec<String> = arm.joint_names().map(str::to_owned).collect();
        let place = |names: &[String], wanted: &String| names.iter().position(|name| name == wanted);
        let missing = || SimError::MissingInModel { missing: joint_names.join(", "), present: servos.join(", ") };
        let servo_of: Option<Vec<_>> = joint_names.iter().map(|name| place(&servos, name)).collect();
        let joint_of: Option<Vec<_>> = servos.iter().map(|name| place(&joint_names, name)).collect();
        let (servo_of, joint_of) = servo_of.zip(joint_of).ok_or_else(missing)?;
        let in_servo_order: Vec<f64> = joint_of.iter().map(|&joint| positions[joint]).collect();
        arm.stand_at(&in_servo_order)?;
        let timestep_s = arm.timestep_s();
        let controller = Controller::at_rest(robot, positions);
        Ok(Self { arm, controller, servo_of, joint_of, joint_names, now_s: 0.0, timestep_s, number: 0 })
    }

    /// Lets time pass until `until_s`.
    pub(crate) fn run(&mut self, until_s: f64) -> Result<(), SimError> {
        while self.now_s + self.timestep_s <= until_s {
            let mut reference = self.controller.reference(self.now_s, self.timestep_s);
            for values in [
                &mut reference.position,
                &mut reference.velocity,
                &mut reference.acceleration,
                &mut reference.mid_velocity,
            ] {
                *values = values.select_rows(&self.joint_of);
            }
            self.now_s += self.arm.step_towards(&reference)?;
        }
        Ok(())
    }

    /// The number of what is played from now on.
    pub(crate) fn play(&mut self, starts_at_s: Option<f64>, trajectory: JointTrajectory) -> Result<u64, Refused> {
        self.controller.play(self.now_s, starts_at_s, trajectory)?;
        self.number += 1;
        Ok(self.number)
    }

    pub(crate) fn stop(&mut self) {
        self.controller.stop(self.now_s);
    }

    pub(crate) fn present(&self) -> Present {
        let (position, velocity) = self.arm.joint_state();
        let own = |values: DVector<f64>| self.servo_of.iter().map(|&servo| values[servo]).collect();
        let reference = self.controller.reference(self.now_s, self.timestep_s);
        Present {
            now_s: self.now_s,
            number: self.number,
            position: own(position),
            velocity: own(velocity),
            desired: [reference.position, reference.velocity, reference.acceleration].map(|v| v.as_slice().to_vec()),
            goal: self.controller.goal().to_vec(),
            ends_at_s: self.controller.ends_at_s(),
        }
    }
}

/// A world whose thread panicked in the midst of a step is as good as any other: the step is not made.
pub(crate) fn lock(world: &Mutex<World>) -> MutexGuard<'_, World> {
    world.lock().unwrap_or_else(PoisonError::into_inner)
}
