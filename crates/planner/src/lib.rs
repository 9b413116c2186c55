//! The pipeline from unordered poses to an executable joint trajectory, without IO.
//!
//! [`plan`] is the pipeline as one pure function: poses, robot, start state and configuration in; ordered poses, spline, joint
//! trajectory and audit out, or a named [`Refusal`]. [`Session`] is the state machine around it that a node or a test drives:
//! inputs in, outputs out, no clock, file, thread or ROS inside, so that a transcript repeats bit for bit.

mod config;
mod message;
mod pipeline;
mod refusal;
mod report;
mod session;

pub use config::Config;
pub use manipulator;
pub use message::trajectory_message;
pub use pipeline::{Plan, Request, plan};
pub use pose_bag;
pub use refusal::Refusal;
pub use reorder;
pub use report::{PlanReport, Report};
pub use se3_geom;
pub use session::{Counters, Input, Job, Outcome, Output, RawPose, Session};
