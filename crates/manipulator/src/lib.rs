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
//! freedom that is left keeps them away from limits and singularities.
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

mod arc_length;
mod audit;
mod bounds;
mod branches;
mod chain;
mod constant_speed;
mod continuation;
mod dynamics;
mod error;
mod error_places;
mod excess;
mod executed;
mod faults;
mod follow;
mod gridpoints;
mod handover;
mod holding;
mod ik;
mod inertia;
mod joint_path;
mod layers;
mod link;
mod optimise;
mod options;
mod path_report;
mod posture;
mod posture_spline;
mod quintic;
mod quintic_spline;
mod reach;
mod relaxation;
mod rest_to_rest;
mod robot;
mod route;
mod rows;
mod sampling;
mod settings_keys;
mod slowing;
mod speed_profile;
mod stations;
mod tightening;
mod timing;
mod tolerance;
mod trajectory;
mod uncorrected;
mod urdf;

pub use audit::{Audit, AuditRules, MaxRatio, audit, audit_from, audit_under};
pub use chain::Chain;
pub use dynamics::{Drive, Dynamics, GRAVITY_M_S2};
pub use error::ManipulatorError;
pub use follow::{PathOptions, follow};
pub use handover::connect;
pub use ik::{IkOptions, solve_ik};
pub use inertia::Inertia;
pub use joint_path::JointPath;
pub use link::Link;
pub use nalgebra;
pub use options::{JointLimits, TimingOptions};
pub use path_report::{PathReport, Worst};
pub use quintic_spline::EndDerivatives;
pub use reach::{OutOfReach, PoseMiss};
pub use rest_to_rest::rest_to_rest;
pub use robot::{Limits, Robot};
pub use slowing::slow_to_stop;
pub use timing::{TimedPath, least_duration_s, time_path};
pub use trajectory::{JointPoint, JointTrajectory};
pub use uncorrected::uncorrected_duration_s;
