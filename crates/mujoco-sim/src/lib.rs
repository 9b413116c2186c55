//! Executes joint trajectories in MuJoCo and reports tracking, contacts and limits.
//!
//! ```text
//! JointTrajectory ─► SimulatedArm::execute ─► Execution { tracking, contacts, torques, tool path } ─► pose_errors
//! ```
//!
//! Joints are in rad (m for slides), times in s. Poses are `world_from_tool`: in the models of the shipped robots the
//! world is the arm's base frame and the tool site its tool frame, so that they agree with the planner's `base_from_tool`.
//!
//! Whether the arm hits itself or what stands around it is told without running anything, by [`SimulatedArm::sweep`].
//!
//! `cargo xtask soak executions 50` executes fifty random plans on each shipped arm, and says how far joints, tool and torques were off.
//!
//! ```no_run
//! use mujoco_sim::{ExecuteOptions, SimulatedArm, TOOL_SITE, model_file, read_trajectory};
//! # fn main() -> Result<(), mujoco_sim::SimError> {
//! let mut arm = SimulatedArm::load(model_file("ur5e")?, TOOL_SITE)?;
//! let execution = arm.execute(&read_trajectory("trajectory.csv")?, &ExecuteOptions::default())?;
//! println!("{:.4} rad at worst, {} contacts", execution.tracking_max_rad, execution.contacts.len());
//! # Ok(()) }
//! ```

mod arm;
mod chain;
mod command;
mod contact;
mod error;
mod execution;
mod live;
mod model;
mod mujoco_arm;
mod reach;
mod servo;
mod sweep;
mod trajectory_file;

pub use arm::{ExecuteOptions, SimulatedArm};
pub use chain::{read_chain, read_dynamics};
pub use contact::{ContactEvent, Touch};
pub use error::SimError;
pub use execution::{Execution, JointTracking, PoseErrors, Sample};
pub use live::Reference;
pub use model::model_file;
pub use mujoco_arm::MujocoArm;
pub use planner;
pub use sweep::{Sweep, SweepOptions};
pub use trajectory_file::read_trajectory;

/// The site that marks the tool in the models of the set-up, and in many of MuJoCo Menagerie.
pub const TOOL_SITE: &str = "attachment_site";
