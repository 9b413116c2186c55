//! The tasks around the shell, from start to end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use futures::StreamExt;
use planner::Session;
use r2r::{Node, ParameterValue};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::mpsc;

use crate::NodeError;
use crate::arguments;
use crate::execution::Controller;
use crate::interface::{Interface, Publishers};
use crate::log::Log;
use crate::parameters::{Execution, Parameters};
use crate::shell::{Outward, Shell};

/// Data wakes the spinning thread at once; this only bounds how long a shutdown takes.
const SPIN_TIMEOUT: Duration = Duration::from_millis(50);

/// How long the middleware may take to say goodbye.
const SHUTDOWN_DEADLINE: Duration = Duration::from_secs(3);

/// As often as tools expect a word on `/diagnostics`.
const REPORT_PERIOD: Duration = Duration::from_secs(1);

/// Runs until SIGINT or SIGTERM.
pub(crate) async fn run() -> Result<(), NodeError> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let context = arguments::create_context()?;
    let mut node = Node::create(context.clone(), "reorder", "")?;
    let parameters = Parameters::at_start(given(&node))?;
    let robot = parameters.robot.load()?;
    if parameters.use_sim_time {
        node.get_time_source().enable_sim_time(&mut node)?;
    }
    let (name, log) = (node.fully_qualified_name()?, Log::create(&mut node)?);
    let publishers = Publishers::create(&mut node)?;
    let mut interface = Interface::create(&mut node)?;
    let (events, mut executed) = mpsc::unbounded_channel();
    let controller = match parameters.execution {
        Execution::Topic => None,
        Execution::Action => Some(Controller::create(&mut node, &parameters.action, events)?),
    };

    let stop = Arc::new(AtomicBool::new(false));
    let mut spinning = tokio::task::spawn_blocking({
        let stop = Arc::clone(&stop);
        let mut emptying = std::mem::take(&mut interface.emptying);
        move || {
            while !stop.load(Ordering::Relaxed) {
                node.spin_once(SPIN_TIMEOUT);
                emptying.iter_mut().for_each(|empty| empty());
            }
            drop(emptying);
            drop(node);
        }
    });

    let outward = Outward { publishers, controller, name, log };
    let (finish, mut finished) = mpsc::unbounded_channel();
    let session = Session::new(robot, parameters.planner_config());
    let (mut shell, mut arrivals) = Shell::new(session, parameters, interface, outward, finish);
    shell.start();
    let mut report = tokio::time::interval(REPORT_PERIOD);
    report.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = interrupt.recv() => break,
            _ = terminate.recv() => break,
            // It ends by itself only by a panic inside the middleware; without it nothing would ever arrive again.
            ended = &mut spinning => return Err(NodeError::Middleware(format!("{ended:?}"))),
            Some(arrival) = arrivals.next() => shell.take(arrival),
            Some(job) = finished.recv() => shell.finish(job),
            Some(event) = executed.recv() => shell.executed(event),
            () = until(shell.deadline()) => shell.tend(),
            _ = report.tick() => shell.report(),
        }
    }
    shell.say_goodbye();
    stop.store(true, Ordering::Relaxed);
    // Publishers and subscriptions go before the node, the node before the context.
    drop((shell, arrivals));
    if tokio::time::timeout(SHUTDOWN_DEADLINE, spinning).await.is_err() {
        // Destroying a participant while its peers leave can hang for minutes inside Fast DDS (eProsima/Fast-DDS#6513), with
        // signals ignored. Nothing of ours is pending any more, so the process leaves.
        eprintln!("reorder_node: the middleware did not shut down within {SHUTDOWN_DEADLINE:?}; leaving without it");
        std::process::exit(0);
    }
    drop(context);
    Ok(())
}

/// Until then, or for ever.
async fn until(deadline: Option<Instant>) {
    match deadline {
        Some(deadline) => tokio::time::sleep_until(deadline.into()).await,
        None => std::future::pending().await,
    }
}

/// Parameters as ROS gave them at the start.
fn given(node: &Node) -> Vec<(String, ParameterValue)> {
    let given = node.params.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    given.iter().map(|(name, parameter)| (name.clone(), parameter.value.clone())).collect()
}
