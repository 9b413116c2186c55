//! ROS 2 node `mujoco_arm`: an arm in MuJoCo that looks like a real one from outside.

mod settings;

use std::process::ExitCode;

use arm_node::{Opened, Parameters};
use mujoco_sim::MujocoArm;
use planner::manipulator::Robot;

use crate::settings::Settings;

const HELP: &str = "\
mujoco_arm: an arm in MuJoCo with the ROS 2 interface of a real one (node /mujoco_arm)

usage: mujoco_arm [--ros-args -p NAME:=VALUE -r FROM:=TO …]

in   joint_trajectory   trajectory_msgs/JointTrajectory
act  joint_trajectory_controller/follow_joint_trajectory   control_msgs/FollowJointTrajectory
out  joint_states       sensor_msgs/JointState
     robot_description  std_msgs/String, latched
     /clock             rosgraph_msgs/Clock, with clock:=true

-p robot:=ur5e          ur5e, vx300s or panda
-p rate_hz:=200.0       joint states a second of simulated time, 10 … 1000
-p clock:=false         publish /clock, and stamp with it: needed for any speed but 1
-p speed:=1.0           simulated seconds a second, 0.01 … 100, as far as the machine can
-p positions:=[…]       where the joints are at the start, base to tool; else where the robot's settings prefer them";

fn main() -> ExitCode {
    arm_node::run("mujoco_arm", HELP, open)
}

fn open(given: Parameters) -> Result<Opened, String> {
    let settings = Settings::from_parameters(given)?;
    let robot = Robot::shipped(&settings.robot).map_err(|error| format!("robot: {error}"))?;
    let (urdf, _) = Robot::shipped_description(&settings.robot).map_err(|error| format!("robot: {error}"))?;
    let positions = settings.start(&robot)?;
    let says = format!("{} in MuJoCo, {} joints", settings.robot, robot.chain.dof());
    let arm = MujocoArm::new(&settings.robot, robot, &positions).map_err(|error| error.to_string())?;
    Ok(Opened { arm: Box::new(arm), urdf: urdf.to_owned(), pacing: settings.pacing, says })
}
