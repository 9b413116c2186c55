//! Everything that can go wrong between a robot description and a legal trajectory.

use crate::audit::{Audit, AuditRules};
use crate::excess::{beyond, figure, too_weak};
use crate::reach::OutOfReach;

/// Why there is no robot, no joint path or no trajectory. Pose indices count from 0 along the curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ManipulatorError {
    /// No robot of that name is shipped.
    #[error("there is no shipped robot {name:?}: known are {known}")]
    UnknownRobot {
        /// As asked for.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// The robot description is no URDF.
    #[error("the URDF cannot be read: {reason}")]
    Urdf {
        /// What the parser says.
        reason: String,
    },
    /// The settings beside the URDF are malformed.
    #[error("the robot settings cannot be read: {reason}")]
    Settings {
        /// What the parser says, with the key.
        reason: String,
    },
    /// A frame that the settings name is no link of the URDF.
    #[error("the URDF has no link {frame:?}")]
    MissingFrame {
        /// The link's name.
        frame: String,
    },
    /// The tool is not a descendant of the base, or nothing moves between them.
    #[error("no chain of moving joints leads from {base:?} to {tool:?}")]
    NoChain {
        /// Base frame.
        base: String,
        /// Tool frame.
        tool: String,
    },
    /// A chain of no joints.
    #[error("nothing moves the tool: a chain needs at least one joint")]
    NoJoints,
    /// A pose has six coordinates, and an arm with fewer joints reaches the poses of a surface at most.
    #[error("the arm has {joints} moving joints, and following a curve of poses takes six")]
    TooFewJoints {
        /// Joints of the chain.
        joints: usize,
    },
    /// A joint on the chain is of a kind that a serial chain of single axes cannot have.
    #[error("joint {joint:?} is {kind}: only revolute, continuous, prismatic and fixed joints are supported")]
    UnsupportedJoint {
        /// Its name.
        joint: String,
        /// What it is.
        kind: String,
    },
    /// A figure of a joint is absent or impossible.
    #[error("joint {joint:?}: {what} is {value}, but must be {must_be}")]
    InvalidJoint {
        /// Its name.
        joint: String,
        /// Which figure.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What would be right.
        must_be: &'static str,
    },
    /// The inertia of a body is impossible.
    #[error("the inertia of a body is impossible: {reason}")]
    Inertia {
        /// In which way.
        reason: &'static str,
    },
    /// The inertia of a link is impossible.
    #[error("the inertia of link {link:?} is impossible: {reason}")]
    LinkInertia {
        /// Its name.
        link: String,
        /// In which way.
        reason: &'static str,
    },
    /// The settings do not cover a joint of the chain.
    #[error("the robot settings say nothing about joint {joint:?}: its acceleration and jerk limits are needed")]
    MissingSettings {
        /// Its name.
        joint: String,
    },
    /// The settings speak of a joint that the chain does not have.
    #[error("the robot settings name joint {joint:?}, which is not on the chain")]
    UnknownJoint {
        /// Its name.
        joint: String,
    },
    /// A vector has the wrong number of joints.
    #[error("{what} has {given} values for a robot of {expected} joints")]
    WrongSize {
        /// What the vector is.
        what: &'static str,
        /// Joints of the robot.
        expected: usize,
        /// Values given.
        given: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} contains a value that is not a finite number")]
    NonFinite {
        /// Where.
        what: &'static str,
    },
    /// A trajectory that this robot cannot execute.
    #[error(
        "{what} is none of this robot: it needs its joints in their order, finite numbers for each, and increasing times from 0"
    )]
    NotOfRobot {
        /// What the trajectory is.
        what: &'static str,
    },
    /// An option is out of its range.
    #[error("option {name} is {value}, but must be {must_be}")]
    InvalidOption {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        must_be: &'static str,
    },
    /// Parameters of a joint path do not increase.
    #[error("path parameter {index} ({value}) does not come after the one before")]
    ParametersNotIncreasing {
        /// Which.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The samples of a joint path are spaced so unevenly that no spline through them was found.
    #[error("the joint path's samples are spaced too unevenly for a spline")]
    SplineSingular,
    /// Inverse kinematics of a single pose did not converge within the joint limits.
    #[error(
        "the pose is not reached within the joint limits: the nearest tool pose found is {position_error_m:.2e} m and {rotation_error_rad:.2e} rad away"
    )]
    IkNotConverged {
        /// Distance left.
        position_error_m: f64,
        /// Angle left.
        rotation_error_rad: f64,
    },
    /// The arm cannot reach some poses of the curve.
    #[error("{0}")]
    Unreachable(OutOfReach),
    /// Between two poses that the arm can take the curve leads out of its reach.
    #[error(
        "on the way to pose {pose} the curve leads out of reach: the nearest tool pose found is {position_error_m:.4} m and {rotation_error_rad:.4} rad away"
    )]
    UnreachableBetween {
        /// Index of the pose.
        pose: usize,
        /// Distance left.
        position_error_m: f64,
        /// Angle left.
        rotation_error_rad: f64,
    },
    /// The arm comes to an end on the way to a pose that it could take in another posture.
    #[error(
        "on the way to pose {pose} the arm comes to an end in every posture tried: the postures that take it there are cut off from those before"
    )]
    CutOff {
        /// Index of the pose.
        pose: usize,
    },
    /// The way to a pose leads over a joint limit on every branch tried.
    #[error(
        "on the way to pose {pose} joint {joint:?} would have to go to {}", beyond(*value, *lower, *upper)
    )]
    JointLimit {
        /// Index of the pose.
        pose: usize,
        /// The joint.
        joint: String,
        /// Position needed, in rad or m.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// The way to a pose leads through or too near a singular configuration.
    #[error(
        "on the way to pose {pose} the arm comes too close to a singularity: least singular value of its Jacobian {singular_value:.2e}, {} less than the {bound:.2e} asked for",
        figure(*bound - *singular_value)
    )]
    Singular {
        /// Index of the pose.
        pose: usize,
        /// Least singular value of the body Jacobian (rows in m and rad).
        singular_value: f64,
        /// Bound of the options.
        bound: f64,
    },
    /// The joints do not follow the curve continuously.
    #[error("on the way to pose {pose} the joints jump by {jump_rad:.3} rad, however finely the curve is sampled")]
    Jump {
        /// Index of the pose.
        pose: usize,
        /// Deviation of the midpoint that refinement did not remove.
        jump_rad: f64,
    },
    /// After a closed curve the arm stands otherwise than before it.
    #[error(
        "the arm comes back from the closed curve in another configuration: joint {joint:?} is at {to:.4} and began at {from:.4}, so that a second lap would begin with a jump"
    )]
    NotCyclic {
        /// The joint that is off by most.
        joint: String,
        /// Its position at the first pose, in rad or m.
        from: f64,
        /// Its position one lap later.
        to: f64,
    },
    /// The joint spline does not come within tolerance of the curve.
    #[error(
        "on the way to pose {pose} the tool path stays {position_error_m:.2e} m and {rotation_error_rad:.2e} rad off the curve, however finely it is sampled"
    )]
    PathTolerance {
        /// Index of the pose.
        pose: usize,
        /// Distance left.
        position_error_m: f64,
        /// Angle left.
        rotation_error_rad: f64,
    },
    /// The optimiser found no speed profile.
    #[error("no speed profile was found: {reason}")]
    Timing {
        /// What it says.
        reason: String,
    },
    /// A joint cannot even hold the arm still, or move it however slowly.
    #[error("joint {joint:?} needs {}", too_weak(*pose, configuration, *moving, [*needed, *effort], unit))]
    HoldingTorque {
        /// The joint.
        joint: String,
        /// Index of the pose that is nearest along the path; none on a move that leads through no poses.
        pose: Option<usize>,
        /// Positions of the joints there, in rad or m.
        configuration: Vec<f64>,
        /// Whether the arm can be held there, and dry friction makes the difference.
        moving: bool,
        /// Torque against gravity, and against dry friction where that makes the difference.
        needed: f64,
        /// Its limit.
        effort: f64,
        /// N·m, or N for a prismatic joint.
        unit: &'static str,
    },
    /// The limits do not let the tool keep a constant speed.
    #[error(
        "a constant tool speed of {wanted_m_s:.4} m/s cannot be held {}",
        pose.map_or_else(
            || format!("between the ramps up and down, which fill the path: {greatest_m_s:.4} m/s can"),
            |pose| format!("near pose {pose}: the limits allow {greatest_m_s:.4} m/s there"),
        )
    )]
    ConstantSpeed {
        /// Index of the pose at or before the narrowest place; none where the path is too short.
        pose: Option<usize>,
        /// As asked for.
        wanted_m_s: f64,
        /// What can be held from ramp to ramp.
        greatest_m_s: f64,
    },
    /// A configuration is beyond a position limit.
    #[error("{what}: {joint} is at {}", beyond(*value, *lower, *upper))]
    BeyondLimits {
        /// What the configuration is.
        what: &'static str,
        /// The joint.
        joint: String,
        /// Its position in rad or m.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// The trajectory would have more points than anybody could execute.
    #[error("the trajectory would last {duration_s:.3e} s, which is more than {most} points at {rate_hz} a second")]
    TooLong {
        /// How long, in s.
        duration_s: f64,
        /// Published points per second.
        rate_hz: f64,
        /// Most points there may be.
        most: usize,
    },
    /// A trajectory cannot be left at a time outside of it.
    #[error("the running trajectory lasts from 0 to {duration_s} s and cannot be left at {at_s} s")]
    NotRunning {
        /// The time asked for, in s.
        at_s: f64,
        /// Duration of the running trajectory, in s.
        duration_s: f64,
    },
    /// The last trajectory that was tried breaks limits; it is withheld.
    #[error("no trajectory that keeps every limit was found; of the last one tried {}", audit.faults(rules))]
    LimitsNotMet {
        /// What was found of it.
        audit: Box<Audit>,
        /// What it was to keep.
        rules: Box<AuditRules>,
    },
}

pub(crate) type Result<T> = std::result::Result<T, ManipulatorError>;
