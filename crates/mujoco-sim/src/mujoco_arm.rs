//! The simulated arm as an arm like any other.

use planner::manipulator::nalgebra::DVector;
use planner::manipulator::{JointTrajectory, Robot};
use planner::{Arm, ArmLost, Controller, Present, Refused};

use crate::error::{Result, SimError};
use crate::live::Reference;
use crate::{SimulatedArm, TOOL_SITE, model_file};

/// A shipped arm in MuJoCo with its controller.
pub struct MujocoArm {
    arm: SimulatedArm,
    controller: Controller,
    /// For each joint of the robot its place among the servos of the model, and the other way round.
    servo_of: Vec<usize>,
    joint_of: Vec<usize>,
    joint_names: Vec<String>,
    now_s: f64,
    timestep_s: f64,
}

impl MujocoArm {
    /// The arm at rest at `positions` (rad, m for slides, in the robot's joint order), at time 0.
    ///
    /// # Errors
    /// Where there is no model of that name, it has other joints, or `positions` are not of the arm.
    pub fn new(model: &str, robot: Robot, positions: &[f64]) -> Result<Self> {
        let mut arm = SimulatedArm::load(model_file(model)?, TOOL_SITE)?;
        let joint_names = robot.chain.joint_names().to_vec();
        if positions.len() != joint_names.len() {
            let (expected, given) = (joint_names.len(), positions.len());
            return Err(SimError::WrongSize { what: "the configuration".into(), expected, given });
        }
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
        Ok(Self { arm, controller, servo_of, joint_of, joint_names, now_s: 0.0, timestep_s })
    }

    /// Where the joints are to be now, in the order of the servos.
    fn reference(&self) -> Reference {
        let [position, velocity, acceleration] =
            self.controller.at(self.now_s).map(|values| values.select_rows(&self.joint_of));
        let [_, mid_velocity, _] = self.controller.at(self.now_s + 0.5 * self.timestep_s);
        Reference { position, velocity, acceleration, mid_velocity: mid_velocity.select_rows(&self.joint_of) }
    }
}

impl Arm for MujocoArm {
    fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    fn run(&mut self, until_s: f64) -> std::result::Result<(), ArmLost> {
        while self.now_s + self.timestep_s <= until_s {
            let step = self.arm.step_towards(&self.reference());
            self.now_s += step.map_err(|error| ArmLost(error.to_string()))?;
        }
        Ok(())
    }

    fn play(&mut self, starts_at_s: Option<f64>, trajectory: JointTrajectory) -> std::result::Result<u64, Refused> {
        self.controller.play(self.now_s, starts_at_s, trajectory)
    }

    fn stop(&mut self) {
        self.controller.stop(self.now_s);
    }

    fn present(&self) -> Present {
        let (position, velocity) = self.arm.joint_state();
        let own = |values: DVector<f64>| self.servo_of.iter().map(|&servo| values[servo]).collect();
        self.controller.present(self.now_s, own(position), own(velocity))
    }
}
