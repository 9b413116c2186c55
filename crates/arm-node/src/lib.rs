//! The ROS 2 side of an arm, the same for every [`planner::Arm`].
//!
//! A thread of its own lets the arm's time pass and tells where the joints are; subscriptions, the action and the service only speak
//! to the arm between two of its steps.
//!
//! | | |
//! | --- | --- |
//! | `joint_trajectory` in | trajectory_msgs/JointTrajectory |
//! | `joint_trajectory_controller/follow_joint_trajectory` action | control_msgs/FollowJointTrajectory |
//! | `~/recover` service | std_srvs/Trigger: go on after a fault |
//! | `joint_states` out | sensor_msgs/JointState |
//! | `robot_description` out | std_msgs/String, latched |
//! | `/rosout` out | rcl_interfaces/Log: goals that are rejected, faults, a pace that is missed |
//! | `/clock` out | rosgraph_msgs/Clock, where the arm has a time of its own |

mod action;
mod error;
mod log;
mod message;
mod pace;
mod parameters;

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use futures::StreamExt;
use planner::Arm;
pub use r2r::ParameterValue;
use r2r::std_srvs::srv::Trigger;
use r2r::trajectory_msgs::msg::JointTrajectory;
use r2r::{Context, Node, QosProfile, ServiceRequest};
use tokio::signal::unix::{SignalKind, signal};

use crate::error::NodeError;
use crate::log::Log;
use crate::pace::{Clock, Pace};
pub use crate::parameters::{Parameters, number};

/// Data wakes the spinning thread at once; this only bounds how long a shutdown takes.
const SPIN_TIMEOUT: Duration = Duration::from_millis(50);
/// How long an arm may take to stop, and how often it is looked at meanwhile.
const STOPPING_DEADLINE: Duration = Duration::from_secs(2);
const STOPPING_PERIOD: Duration = Duration::from_millis(10);
/// How long the middleware may take to say goodbye.
const SHUTDOWN_DEADLINE: Duration = Duration::from_secs(3);

/// An arm that is ready to be driven.
pub struct Opened {
    /// The arm, at time 0 of its clock.
    pub arm: Box<dyn Arm>,
    /// What `robot_description` says.
    pub urdf: String,
    /// How its time passes.
    pub pacing: Pacing,
    /// A line for the log.
    pub says: String,
}

/// How an arm's time passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pacing {
    /// Steps and joint states a second of the arm's time.
    pub rate_hz: f64,
    /// Whether `/clock` is published, and stamps are by it.
    pub clock: bool,
    /// Seconds of the arm a second.
    pub speed: f64,
}

pub(crate) type SharedArm = Arc<Mutex<Box<dyn Arm>>>;

/// An arm whose thread panicked in the midst of a step is as good as any other: the step is not made.
pub(crate) fn lock(arm: &SharedArm) -> MutexGuard<'_, Box<dyn Arm>> {
    arm.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The node of that name until a signal ends it: prints `help` where it is asked for, else lets `open` make the arm of the given
/// parameters.
pub fn run(name: &'static str, help: &str, open: fn(Parameters) -> Result<Opened, String>) -> ExitCode {
    if std::env::args().any(|argument| argument == "--help" || argument == "-h") {
        println!("{help}");
        return ExitCode::SUCCESS;
    }
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
    let served = runtime.map_err(NodeError::from).and_then(|runtime| {
        let result = runtime.block_on(serve(name, open));
        runtime.shutdown_background();
        result
    });
    match served {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{name}: {error}");
            ExitCode::from(2)
        }
    }
}

/// r2r panics where rcl refuses the arguments; this makes an error of it.
fn create_context() -> Result<Context, NodeError> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let created = std::panic::catch_unwind(Context::create);
    std::panic::set_hook(hook);
    match created {
        Ok(context) => Ok(context?),
        Err(panic) => {
            let why = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
            let words: Vec<_> = why.unwrap_or("no reason given").split_whitespace().collect();
            Err(NodeError::CommandLine(words.join(" ")))
        }
    }
}

async fn serve(name: &str, open: fn(Parameters) -> Result<Opened, String>) -> Result<(), NodeError> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let context = create_context()?;
    let mut node = Node::create(context.clone(), name, "")?;
    let given = parameters::given(&node);
    // An arm may take seconds to get ready.
    let opened = tokio::task::spawn_blocking(move || open(given)).await;
    let opened = opened.map_err(|panic| NodeError::Middleware(panic.to_string()))?;
    let Opened { arm, urdf, pacing, says } = opened.map_err(NodeError::Parameters)?;
    let arm: SharedArm = Arc::new(Mutex::new(arm));
    let log = Log::create(&mut node)?;

    let latched = QosProfile::default().reliable().transient_local().keep_last(1);
    let description = node.create_publisher::<r2r::std_msgs::msg::String>("robot_description", latched)?;
    let mut trajectories = node.subscribe::<JointTrajectory>("joint_trajectory", QosProfile::default().reliable())?;
    let mut goals = node.create_action_server("joint_trajectory_controller/follow_joint_trajectory")?;
    let mut recoveries = node.create_service::<Trigger::Service>("~/recover", QosProfile::services_default())?;
    let clock = Clock::new(pacing.clock);
    let pace = Pace::create(&mut node, &pacing, clock.clone(), Arc::clone(&arm), log.clone())?;
    description.publish(&r2r::std_msgs::msg::String { data: urdf })?;

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
    let mut moving = tokio::task::spawn_blocking({
        let stop = Arc::clone(&stop);
        move || pace.run(&stop)
    });
    log.info(says);

    let ended = loop {
        tokio::select! {
            _ = interrupt.recv() => break Ok(()),
            _ = terminate.recv() => break Ok(()),
            ended = &mut spinning => break Err(NodeError::Middleware(format!("{ended:?}"))),
            ended = &mut moving => {
                return ended.unwrap_or_else(|panic| Err(NodeError::Middleware(panic.to_string())));
            }
            Some(message) = trajectories.next() => {
                let starts_at_s = clock.seconds(&message.header.stamp);
                let played = lock(&arm).play(starts_at_s, message::trajectory(&message));
                if let Err(why) = played {
                    log.error(format_args!("a trajectory is refused: {why}"));
                }
            }
            Some(request) = goals.next() => action::serve(request, Arc::clone(&arm), clock.clone(), &log),
            Some(request) = recoveries.next() => recover(request, Arc::clone(&arm), log.clone()),
        }
    };
    come_to_rest(&arm).await;
    stop.store(true, Ordering::Relaxed);
    let _ = moving.await;
    ended?;
    drop((trajectories, goals, recoveries, description));
    if tokio::time::timeout(SHUTDOWN_DEADLINE, spinning).await.is_err() {
        // As in reorder_node: Fast DDS can take minutes to say goodbye (eProsima/Fast-DDS#6513).
        std::process::exit(0);
    }
    drop(context);
    Ok(())
}

/// Stops an arm that is in motion, and waits until it rests: nobody leads it any further afterwards.
async fn come_to_rest(arm: &SharedArm) {
    lock(arm).stop();
    let deadline = tokio::time::Instant::now() + STOPPING_DEADLINE;
    while tokio::time::Instant::now() < deadline {
        let present = lock(arm).present();
        if present.ends_at_s <= present.now_s {
            break;
        }
        tokio::time::sleep(STOPPING_PERIOD).await;
    }
}

/// Has the arm go on, which may take a moment, and answers.
fn recover(request: ServiceRequest<Trigger::Service>, arm: SharedArm, log: Log) {
    tokio::task::spawn_blocking(move || {
        let recovered = lock(&arm).recover();
        let success = recovered.is_ok();
        let message = recovered.err().map(|why| why.to_string()).unwrap_or_default();
        if let Err(error) = request.respond(Trigger::Response { success, message }) {
            log.error(format_args!("answering ~/recover failed: {error}"));
        }
    });
}
