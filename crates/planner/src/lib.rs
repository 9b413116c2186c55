//! The pipeline from unordered poses to an executable joint trajectory, without IO.
//!
//! [`plan`] is the pipeline as one pure function: poses, robot, start state and configuration in; ordered poses, spline, joint
//! trajectory and audit out, or a named [`Refusal`]. [`Session`] is the state machine around it that a node or a test drives:
//! inputs in, outputs out, no clock, file, thread or ROS inside, so that a transcript repeats bit for bit. What executes the result is an
//! [`Arm`], simulated or real.
//!
//! ```
//! use planner::{Config, Request, manipulator::Robot, plan, pose_bag::read_poses};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let bag = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/lasa_sine");
//! let robot = Robot::shipped("ur5e")?;
//! let poses = read_poses(bag, None)?.remove(0).poses; // in any order
//! let request = Request { poses, ..Request::default() };
//! let plan = plan(&robot, &Config::default(), &request)?; // or a refusal that says why
//! println!("{:?}: {:?}", plan.ordering.verdict, plan.ordering.order);
//! println!("{:?} of the limits", plan.audit.max_ratio);
//! let [position, velocity, acceleration, jerk] = plan.trajectory.at(0.5 * plan.trajectory.duration_s());
//! # assert!(position.iter().chain(&velocity).chain(&acceleration).chain(&jerk).all(|x| x.is_finite()));
//! # Ok(()) }
//! ```

mod arm;
mod config;
mod controller;
mod exchange;
mod joints;
mod markers;
mod message;
mod motion;
mod pipeline;
mod refusal;
mod report;
mod session;

pub use arm::{Arm, ArmLost, Present};
pub use config::{Config, OnRefusal};
pub use controller::{Controller, Refused, START_TOLERANCE};
pub use exchange::{Counters, Input, Job, Outcome, Output, RawPose};
pub use manipulator;
pub use markers::{Drawn, markers};
pub use message::trajectory_message;
pub use motion::{Handover, Motion};
pub use pipeline::{Plan, Request, interpolate, path_along, plan};
pub use pose_bag;
pub use refusal::Refusal;
pub use reorder;
pub use report::{PlanReport, Report};
pub use se3_geom;
pub use session::Session;
