//! Serial manipulators: kinematics, joint paths along tool curves, legal timing, audit.
//!
//! ```text
//! URDF + settings ─► Robot ─► follow(curve) ─► JointPath ─► time_path ─► JointTrajectory ─► audit
//! ```
//!
//! Poses are `base_from_tool`, twists are of the tool in the tool frame, ordered (linear, angular); joints are in rad (m for prismatic
//! joints), times in s.
//!
//! Chains may have any number of joints. With fewer than six no pose can be followed ([`ManipulatorError::Singular`]); with more, the
//! joints take the least motion from each pose to the next, which uses none of the freedom that is left to avoid limits.
//!
//! ```
//! use manipulator::{follow, time_path, PathOptions, Robot, TimingOptions};
//! use se3_geom::{centripetal_knots, nalgebra::Vector3, Ends, PoseSpline, Se3};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let robot = Robot::shipped("ur5e")?;
//! let first = robot.chain.forward(&robot.preferred);
//! let poses: Vec<_> = (0..4)
//!     .map(|i| {
//!         let mut pose = first;
//!         pose.translation.vector += Vector3::new(0.05, 0.0, 0.02) * f64::from(i);
//!         pose
//!     })
//!     .collect();
//! let curve = PoseSpline::through(&poses, &centripetal_knots(&Se3::default(), &poses), Ends::Natural)?;
//! let path = follow(&robot, &curve, Some(&robot.preferred), &PathOptions::default())?;
//! let timed = time_path(&robot, &path, &TimingOptions::default())?;
//! assert!(timed.audit.limits_ok);
//! # Ok(()) }
//! ```

mod audit;
mod bounds;
mod branches;
mod chain;
mod constant_speed;
mod continuation;
mod dynamics;
mod error;
mod follow;
mod ik;
mod inertia;
mod joint_path;
mod optimise;
mod options;
mod quintic;
mod quintic_spline;
mod rest_to_rest;
mod robot;
mod rows;
mod sampling;
mod speed_profile;
mod timing;
mod trajectory;
mod urdf;

pub use audit::{Audit, AuditRules, MaxRatio, audit, audit_under};
pub use chain::Chain;
pub use dynamics::{Drive, Dynamics, GRAVITY_M_S2};
pub use error::ManipulatorError;
pub use follow::{PathOptions, follow};
pub use ik::{IkOptions, solve_ik};
pub use inertia::Inertia;
pub use joint_path::JointPath;
pub use nalgebra;
pub use options::{JointLimits, TimingOptions};
pub use quintic_spline::EndDerivatives;
pub use rest_to_rest::rest_to_rest;
pub use robot::{Limits, Robot};
pub use timing::{TimedPath, time_path};
pub use trajectory::{JointPoint, JointTrajectory};
