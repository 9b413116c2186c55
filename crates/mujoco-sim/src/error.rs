//! Everything that can go wrong between a model file and a report.

use planner::pose_bag::BagError;

/// Why nothing was simulated, or the simulation says nothing. Points, poses and rows count from 0 unless a line is named.
#[derive(Debug, thiserror::Error)]
pub enum SimError {
    /// No model is shipped under that name.
    #[error("there is no model named {name:?}: known are {known}; any other is given as the path of its .xml file")]
    UnknownRobot {
        /// As asked for.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A file cannot be read.
    #[error("{file}: {source}{hint}")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
        /// What to do about it, where that is known.
        hint: &'static str,
    },
    /// MuJoCo does not accept the model.
    #[error("{file} is not a model that MuJoCo loads: {reason}")]
    Model {
        /// The file.
        file: String,
        /// What MuJoCo says, on one line.
        reason: String,
    },
    /// The model has no site that marks the tool.
    #[error("{file} has no site {site:?} to mark the tool")]
    MissingSite {
        /// The file.
        file: String,
        /// Name of the site.
        site: String,
    },
    /// What moves the tool is no serial chain of hinges and slides.
    #[error("{file}: no chain of hinges and slides leads to site {site:?}: {why}")]
    NotAChain {
        /// The file.
        file: String,
        /// Name of the site.
        site: String,
        /// Which joint is in the way, and why.
        why: String,
    },
    /// An actuator is not a position servo on one joint.
    #[error("{file}: actuator {actuator:?} {why}; only position servos that act on one joint each are supported")]
    NotAServo {
        /// The file.
        file: String,
        /// Name of the actuator.
        actuator: String,
        /// In what way.
        why: &'static str,
    },
    /// No actuator at all.
    #[error("{file} has no actuators, so nothing can be executed")]
    NoActuators {
        /// The file.
        file: String,
    },
    /// The trajectory moves joints that the model cannot.
    #[error("the model has no actuated joint {missing}; it has {present}")]
    MissingInModel {
        /// Names that the trajectory has.
        missing: String,
        /// Names that the model has.
        present: String,
    },
    /// The trajectory leaves joints without command.
    #[error("the trajectory says nothing about joint {missing} of the model")]
    MissingInTrajectory {
        /// Names that the model has.
        missing: String,
    },
    /// A joint occurs twice.
    #[error("the trajectory names joint {joint} twice")]
    DuplicateJoint {
        /// Its name.
        joint: String,
    },
    /// There is nothing to execute.
    #[error("the trajectory has no points")]
    EmptyTrajectory,
    /// A vector has the wrong number of joints.
    #[error("{what} has {given} values for {expected} joints")]
    WrongSize {
        /// Which vector.
        what: String,
        /// Number of joints.
        expected: usize,
        /// Number of values.
        given: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} contains a value that is not a finite number")]
    NonFinite {
        /// Where.
        what: String,
    },
    /// Times of the trajectory do not increase from zero or later.
    #[error(
        "the time of point {point} of the trajectory ({time_s} s) does not come after the one before, or is negative"
    )]
    TimesNotIncreasing {
        /// Which.
        point: usize,
        /// Its time.
        time_s: f64,
    },
    /// The run would not end in reasonable time.
    #[error("the run would last {duration_s} s, but at most {limit_s} s are simulated")]
    TooLong {
        /// Trajectory and settling.
        duration_s: f64,
        /// The bound.
        limit_s: f64,
    },
    /// A sweep would not end in reasonable time.
    #[error("a sweep with a clearance of {clearance_m} m would take {checks:.0} checks, more than {limit:.0}")]
    TooManyChecks {
        /// How many.
        checks: f64,
        /// The bound.
        limit: f64,
        /// The clearance that was asked for.
        clearance_m: f64,
    },
    /// Nothing that moves has a shape, so that freedom from contacts would mean nothing.
    #[error("the model has no shape that moves and can collide: nothing can be said about contacts")]
    NoShapes,
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
    /// The simulation became unstable; its figures would mean nothing.
    #[error(
        "the simulation diverged at {time_s:.4} s: the model's time step of {timestep_s} s is too long for its servos"
    )]
    Diverged {
        /// When.
        time_s: f64,
        /// Time step of the model.
        timestep_s: f64,
    },
    /// There is not one time for each pose.
    #[error("there are {times} times for {poses} poses")]
    PoseTimeCount {
        /// Number of poses.
        poses: usize,
        /// Number of times.
        times: usize,
    },
    /// A pose is due outside the run.
    #[error("pose {pose} is due at {time_s} s, but the run lasts from 0 to {end_s} s")]
    PoseTime {
        /// Which.
        pose: usize,
        /// Its time.
        time_s: f64,
        /// End of the run.
        end_s: f64,
    },
    /// A file of numbers is malformed.
    #[error(transparent)]
    Table(#[from] BagError),
    /// A table is no trajectory.
    #[error("{file} is no joint trajectory: {reason}")]
    TrajectoryFile {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A row of a trajectory cannot follow the one before.
    #[error("{file}, line {line}: t is {time_s} s, which must be at least 0 and come after the line before")]
    TrajectoryLine {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Its time.
        time_s: f64,
    },
    /// It is not clear which poses are meant.
    #[error("{file} holds {sets} sets of poses (counted from 0): choose one of them with --message")]
    PoseSets {
        /// The file.
        file: String,
        /// How many there are.
        sets: usize,
    },
    /// A report does not say when the tool should be where.
    #[error("{file} is no report of a plan: {reason}")]
    Report {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A result cannot be written.
    #[error("{file} could not be written: {reason}")]
    Write {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
}

pub(crate) type Result<T> = std::result::Result<T, SimError>;
