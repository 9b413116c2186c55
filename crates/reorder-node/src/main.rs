//! ROS 2 node `reorder`: unordered poses in, an audited joint trajectory out.
//!
//! A thin shell around [`planner::Session`]: one task owns the session, subscriptions feed it, plans run on a thread of their own,
//! so that nothing slow ever happens where messages are received.

mod arguments;
mod interface;
mod message;
mod settings;
mod shell;

use std::process::ExitCode;

const HELP: &str = "\
reorder_node: poses in any order in, an audited joint trajectory out (ROS 2 node /reorder)

usage: reorder_node [--ros-args --params-file FILE -p NAME:=VALUE -r FROM:=TO …]

in   ~/poses          geometry_msgs/PoseArray     in the robot's base frame, in any order
     joint_states     sensor_msgs/JointState      where the robot stands
out  joint_trajectory trajectory_msgs/JointTrajectory
     ~/ordered_poses  geometry_msgs/PoseArray     latched
     ~/path           nav_msgs/Path               latched
     ~/report         std_msgs/String (JSON)      latched: order, verdict, doubts, audit, or the refusal
srv  ~/replan, ~/clear  std_srvs/Trigger
Parameters: config/reorder.yaml";

fn main() -> ExitCode {
    if std::env::args().any(|argument| argument == "--help" || argument == "-h") {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reorder_node: {error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), NodeError> {
    // r2r panics on a parameter file that it cannot read, so they are read here first.
    arguments::check_parameter_files(std::env::args())?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let result = runtime.block_on(shell::run());
    // A plan may still be running; nobody waits for it any more.
    runtime.shutdown_background();
    result
}

/// Why the node does not start, or stops.
#[derive(Debug, thiserror::Error)]
enum NodeError {
    #[error("parameter file {file}: {reason}")]
    ParameterFile { file: String, reason: String },
    #[error("parameters: {0}")]
    Parameters(String),
    #[error("{file}: {reason}")]
    RobotFile { file: String, reason: String },
    #[error("the middleware stopped: {0}")]
    Middleware(String),
    #[error("ROS 2 refuses the command line or a parameter file: {0}")]
    CommandLine(String),
    #[error("ROS 2: {0}")]
    Ros(#[from] r2r::Error),
    #[error("{0}")]
    Io(#[from] std::io::Error),
}
