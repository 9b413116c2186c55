//! ROS 2 node `mujoco_arm`: an arm in MuJoCo that looks like a real one from outside.
//!
//! A thread of its own lets time pass in the simulation and tells where the joints are; subscriptions and the action only hand
//! trajectories to the controller that the simulation follows.

mod action;
mod controller;
mod message;
mod settings;
mod simulation;
mod world;

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use futures::StreamExt;
use planner::manipulator::Robot;
use r2r::trajectory_msgs::msg::JointTrajectory;
use r2r::{Context, Node, QosProfile};
use tokio::signal::unix::{SignalKind, signal};

use crate::settings::Settings;
use crate::simulation::{Clock, Simulation};
use crate::world::World;

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

/// Data wakes the spinning thread at once; this only bounds how long a shutdown takes.
const SPIN_TIMEOUT: Duration = Duration::from_millis(50);
/// How long the middleware may take to say goodbye.
const SHUTDOWN_DEADLINE: Duration = Duration::from_secs(3);

fn main() -> ExitCode {
    if std::env::args().any(|argument| argument == "--help" || argument == "-h") {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mujoco_arm: {error}");
            ExitCode::from(2)
        }
    }
}

/// Why the arm does not start, or stops.
#[derive(Debug, thiserror::Error)]
enum ArmError {
    #[error("parameters: {0}")]
    Parameters(String),
    #[error("ROS 2 refuses the command line or a parameter file: {0}")]
    CommandLine(String),
    #[error("{0}")]
    Simulation(#[from] mujoco_sim::SimError),
    #[error("the middleware stopped: {0}")]
    Middleware(String),
    #[error("ROS 2: {0}")]
    Ros(#[from] r2r::Error),
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

fn run() -> Result<(), ArmError> {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let result = runtime.block_on(serve());
    runtime.shutdown_background();
    result
}

/// r2r panics where rcl refuses the arguments; this makes an error of it.
fn create_context() -> Result<Context, ArmError> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let created = std::panic::catch_unwind(Context::create);
    std::panic::set_hook(hook);
    match created {
        Ok(context) => Ok(context?),
        Err(panic) => {
            let why = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
            let words: Vec<_> = why.unwrap_or("no reason given").split_whitespace().collect();
            Err(ArmError::CommandLine(words.join(" ")))
        }
    }
}

async fn serve() -> Result<(), ArmError> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let context = create_context()?;
    let mut node = Node::create(context.clone(), "mujoco_arm", "")?;
    let settings = Settings::read(&node)?;
    let robot = Robot::shipped(&settings.robot).map_err(|error| ArmError::Parameters(format!("robot: {error}")))?;
    let positions = settings.start(&robot)?;
    let world = Arc::new(Mutex::new(World::new(&settings.robot, robot.clone(), &positions)?));
    let logger = node.logger().to_owned();

    let latched = QosProfile::default().reliable().transient_local().keep_last(1);
    let description = node.create_publisher::<r2r::std_msgs::msg::String>("robot_description", latched)?;
    let (urdf, _) =
        Robot::shipped_description(&settings.robot).map_err(|error| ArmError::Parameters(error.to_string()))?;
    let mut trajectories = node.subscribe::<JointTrajectory>("joint_trajectory", QosProfile::default().reliable())?;
    let mut goals = node.create_action_server("joint_trajectory_controller/follow_joint_trajectory")?;
    let clock = Clock::new(settings.clock);
    let simulation = Simulation::create(&mut node, &settings, clock, Arc::clone(&world))?;
    description.publish(&r2r::std_msgs::msg::String { data: urdf.to_owned() })?;

    let stop = Arc::new(AtomicBool::new(false));
    let mut spinning = tokio::task::spawn_blocking({
        let stop = Arc::clone(&stop);
        move || {
            while !stop.load(Ordering::Relaxed) {
                node.spin_once(SPIN_TIMEOUT);
            }
            drop(node);
        }
    });
    let mut simulating = tokio::task::spawn_blocking({
        let stop = Arc::clone(&stop);
        move || simulation.run(&stop)
    });
    r2r::log_info!(&logger, "{} in MuJoCo, {} joints", settings.robot, robot.chain.dof());

    loop {
        tokio::select! {
            _ = interrupt.recv() => break,
            _ = terminate.recv() => break,
            ended = &mut spinning => return Err(ArmError::Middleware(format!("{ended:?}"))),
            ended = &mut simulating => {
                return ended.unwrap_or_else(|panic| Err(ArmError::Middleware(panic.to_string())));
            }
            Some(message) = trajectories.next() => {
                let starts_at_s = clock.seconds(&message.header.stamp);
                let played = world::lock(&world).play(starts_at_s, message::trajectory(&message));
                if let Err(why) = played {
                    r2r::log_error!(&logger, "a trajectory is refused: {why}");
                }
            }
            Some(request) = goals.next() => action::serve(request, Arc::clone(&world), clock, &logger),
        }
    }
    stop.store(true, Ordering::Relaxed);
    let _ = simulating.await;
    drop((trajectories, goals, description));
    if tokio::time::timeout(SHUTDOWN_DEADLINE, spinning).await.is_err() {
        // As in reorder_node: Fast DDS can take minutes to say goodbye (eProsima/Fast-DDS#6513).
        std::process::exit(0);
    }
    drop(context);
    Ok(())
}
