//! ROS 2 node `reorder`: unordered poses in, an audited joint trajectory out.
//!
//! A thin shell around [`planner::Session`]: one task owns the session, subscriptions feed it, plans run on a thread of their own,
//! so that nothing slow ever happens where messages are received.

mod arguments;
mod collecting;
mod diagnostics;
mod execution;
mod frames;
mod inbox;
mod interface;
mod lifecycle;
mod log;
mod managed;
mod message;
mod node;
mod parameters;
mod placing;
mod shell;
mod stamps;

use std::process::ExitCode;

const HELP: &str = "\
reorder_node: poses in any order in, an audited joint trajectory out (ROS 2 node /reorder)

usage: reorder_node [--ros-args --params-file FILE -p NAME:=VALUE -r FROM:=TO …]

       reorder_node --parameters        prints every parameter with its default, as a parameter file

in   ~/poses            geometry_msgs/PoseArray     in any order, in the base frame or one that /tf knows
     ~/pose             geometry_msgs/PoseStamped   one by one, until quiet_s or ~/replan
     joint_states       sensor_msgs/JointState      where the robot stands
     /tf, /tf_static    tf2_msgs/TFMessage          where the frame of the poses is to the base frame
     robot_description  std_msgs/String             the robot's URDF, instead of the one that is built in
out  joint_trajectory   trajectory_msgs/JointTrajectory
     ~/ordered_poses    geometry_msgs/PoseArray     latched
     ~/path             nav_msgs/Path               latched
     ~/report           std_msgs/String (JSON)      latched: order, verdict, doubts, audit, or the refusal
     ~/markers          visualization_msgs/MarkerArray  latched: poses, order, curve, doubts
     /diagnostics       diagnostic_msgs/DiagnosticArray
     or goals of FollowJointTrajectory (parameter execution)
srv  ~/replan, ~/clear, ~/cancel  std_srvs/Trigger
     ~/change_state …   lifecycle_msgs, as of every managed node";

fn main() -> ExitCode {
    if std::env::args().any(|argument| argument == "--help" || argument == "-h") {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    if std::env::args().any(|argument| argument == "--parameters") {
        print!("{}", parameters::defaults());
        return ExitCode::SUCCESS;
    }
    trace_if_asked();
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reorder_node: {error}");
            ExitCode::from(2)
        }
    }
}

/// Developers ask for notes on what happens inside with `RUST_LOG`, as `reorder_node=debug`; they go to standard error.
fn trace_if_asked() {
    use tracing_subscriber::filter::Targets;
    use tracing_subscriber::prelude::*;
    let Ok(wanted) = std::env::var("RUST_LOG") else { return };
    match wanted.parse::<Targets>() {
        Ok(targets) => {
            let notes = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
            tracing_subscriber::registry().with(notes).with(targets).init();
        }
        Err(error) => eprintln!("reorder_node: RUST_LOG={wanted} is ignored: {error}"),
    }
}

fn run() -> Result<(), NodeError> {
    // r2r panics on a parameter file that it cannot read, so they are read here first.
    arguments::check_parameter_files(std::env::args())?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let result = runtime.block_on(node::run());
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
