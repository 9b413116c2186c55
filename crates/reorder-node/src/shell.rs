//! The tasks around the session.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use futures::StreamExt;
use planner::{Input, Motion, Output, Session};
use r2r::std_srvs::srv::Trigger;
use r2r::{Node, ParameterValue, ServiceRequest};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::mpsc;

use crate::NodeError;
use crate::arguments;
use crate::interface::{Arrival, Publishers, arrivals};
use crate::settings;

/// Data wakes the spinning thread at once; this only bounds how long a shutdown takes.
const SPIN_TIMEOUT: Duration = Duration::from_millis(50);

/// How long the middleware may take to say goodbye.
const SHUTDOWN_DEADLINE: Duration = Duration::from_secs(3);

/// Runs until SIGINT or SIGTERM.
pub(crate) async fn run() -> Result<(), NodeError> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let context = arguments::create_context()?;
    let mut node = Node::create(context.clone(), "reorder", "")?;
    let (robot, config) = settings::from_parameters(parameters(&node))?;
    let logger = node.logger().to_owned();
    let publishers = Publishers::create(&mut node)?;
    let mut arrivals = arrivals(&mut node)?;
    r2r::log_info!(
        &logger,
        "ready for {} ({} joints, base frame {}); one radian counts as {} m",
        robot.name,
        robot.chain.dof(),
        robot.base_frame,
        config.metres_per_radian
    );

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

    let stamps = Stamps { started: Instant::now(), began_ns: 0, given: config.handover };
    let mut shell = Shell::new(Session::new(robot, config), publishers, stamps, logger);
    loop {
        tokio::select! {
            _ = interrupt.recv() => break,
            _ = terminate.recv() => break,
            // It ends by itself only by a panic inside the middleware; without it nothing would ever arrive again.
            ended = &mut spinning => return Err(NodeError::Middleware(format!("{ended:?}"))),
            Some(arrival) = arrivals.next() => match arrival {
                Arrival::Message(input) => shell.handle(input, None),
                Arrival::Service(input, request) => shell.handle(input, Some(request)),
            },
            Some(finished) = shell.finished.recv() => shell.handle(finished, None),
        }
    }
    r2r::log_info!(&shell.logger, "shutting down");
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

/// Parameters as ROS gave them at the start.
fn parameters(node: &Node) -> Vec<(String, ParameterValue)> {
    let given = node.params.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    given.iter().map(|(name, parameter)| (name.clone(), parameter.value.clone())).collect()
}

/// The session's clock, and what it shows in ROS time.
struct Stamps {
    started: Instant,
    /// ROS time when the session's clock was 0, in ns since the epoch.
    began_ns: i64,
    /// Whether trajectories are stamped; without a stamp they start when they arrive.
    given: bool,
}

/// The two clocks may drift apart by this much. Following them more closely would shift a trajectory against the one it takes over
/// from by the jitter of reading them.
const SAME_CLOCK_NS: i64 = 1_000_000;

impl Stamps {
    fn now_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// When a motion begins, in ns since the epoch.
    fn of(&mut self, motion: &Motion) -> i64 {
        if !self.given {
            return 0;
        }
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let began_ns = since_epoch.as_nanos() as i64 - self.started.elapsed().as_nanos() as i64;
        if (began_ns - self.began_ns).abs() > SAME_CLOCK_NS {
            self.began_ns = began_ns;
        }
        self.began_ns + (motion.starts_at_s * 1e9).round() as i64
    }
}

struct Shell {
    session: Session,
    stamps: Stamps,
    publishers: Publishers,
    logger: String,
    finished: mpsc::UnboundedReceiver<Input>,
    finish: mpsc::UnboundedSender<Input>,
}

impl Shell {
    fn new(session: Session, publishers: Publishers, stamps: Stamps, logger: String) -> Self {
        let (finish, finished) = mpsc::unbounded_channel();
        Self { session, stamps, publishers, logger, finished, finish }
    }

    fn handle(&mut self, input: Input, mut request: Option<ServiceRequest<Trigger::Service>>) {
        for output in self.session.handle(self.stamps.now_s(), input) {
            match output {
                Output::Run(job) => {
                    let finish = self.finish.clone();
                    tokio::spawn(async move {
                        let spare = job.clone();
                        let ran = tokio::task::spawn_blocking(move || job.run()).await;
                        let outcome = ran.unwrap_or_else(|panic| spare.lost(panic.to_string()));
                        // The receiver is gone only when the node shuts down.
                        let _ = finish.send(Input::Finished(outcome));
                    });
                }
                Output::Publish(outcome) => {
                    match &outcome.result {
                        Ok(plan) => r2r::log_info!(
                            &self.logger,
                            "{} poses in {:?} order, {} points, {:.2} s",
                            outcome.request.poses.len(),
                            plan.ordering.verdict,
                            plan.trajectory.points.len(),
                            plan.trajectory.duration_s()
                        ),
                        Err(refusal) if outcome.motion.is_some() => {
                            r2r::log_warn!(&self.logger, "stopping, because there is no trajectory: {refusal}");
                        }
                        Err(refusal) => r2r::log_warn!(&self.logger, "no trajectory: {refusal}"),
                    }
                    if let Err(error) =
                        self.publishers.publish(self.session.robot(), &outcome, |motion| self.stamps.of(motion))
                    {
                        r2r::log_error!(&self.logger, "publishing failed: {error}");
                    }
                }
                Output::Reply { success, message } => {
                    if let Some(request) = request.take()
                        && let Err(error) = request.respond(Trigger::Response { success, message })
                    {
                        r2r::log_error!(&self.logger, "a service was not answered: {error}");
                    }
                }
                Output::Withdraw => {
                    if let Err(error) = self.publishers.withdraw() {
                        r2r::log_error!(&self.logger, "publishing failed: {error}");
                    }
                }
                Output::Warn(sentence) => r2r::log_warn!(&self.logger, "{sentence}"),
            }
        }
    }
}
