//! ROS 2 node `dynamixel_arm`: an arm of Dynamixel servos, real or emulated, as any other arm.

use std::process::ExitCode;

use arm_node::{Opened, Pacing, ParameterValue, Parameters};
use dynamixel_hil::Config;
use planner::manipulator::Robot;

const HELP: &str = "\
dynamixel_arm: an arm of Dynamixel servos with the ROS 2 interface of any other (node /dynamixel_arm)

usage: dynamixel_arm [--ros-args -p NAME:=VALUE -r FROM:=TO …]

in   joint_trajectory   trajectory_msgs/JointTrajectory
act  joint_trajectory_controller/follow_joint_trajectory   control_msgs/FollowJointTrajectory
srv  ~/recover          std_srvs/Trigger: go on after a fault, from where the joints are
out  joint_states       sensor_msgs/JointState
     robot_description  std_msgs/String, latched

-p config:=config/arms/vx300s.yaml   servos, joints, and the port: /dev/ttyUSB0, or `sim` for an emulated bus with MuJoCo behind it
-p port:=…                           another port than the configuration's

It holds where it stands from the start on, and goes on holding when the node ends: switch the power off to let it go.";

fn main() -> ExitCode {
    arm_node::run("dynamixel_arm", HELP, open)
}

fn open(given: Parameters) -> Result<Opened, String> {
    let (mut file, mut port) = ("config/arms/vx300s.yaml".to_owned(), None);
    for (name, value) in given {
        match (name.as_str(), value) {
            ("config", ParameterValue::String(given)) => file = given,
            ("port", ParameterValue::String(given)) => port = Some(given).filter(|port| !port.is_empty()),
            ("config" | "port", value) => return Err(format!("{name} cannot be a {}", value.type_name())),
            _ => return Err(format!("there is no parameter {name}")),
        }
    }
    let mut config = Config::read(&file).map_err(|error| error.to_string())?;
    config.port = port.unwrap_or(config.port);
    let (urdf, _) = Robot::shipped_description(&config.robot).map_err(|error| error.to_string())?;
    let pacing = Pacing { rate_hz: config.rate_hz, clock: false, speed: 1.0 };
    let says = format!("{} on {}, {} servos at {} baud", config.robot, config.port, config.servos.len(), config.baud);
    let (arm, _) = dynamixel_hil::open(config, None).map_err(|error| error.to_string())?;
    Ok(Opened { arm: Box::new(arm), urdf: urdf.to_owned(), pacing, says })
}
