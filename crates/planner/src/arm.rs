//! What an arm is to whoever moves it, be it simulated or real.

use manipulator::JointTrajectory;

use crate::controller::Refused;

/// An arm that plays trajectories: [`Controller`](crate::Controller) says where its joints are to be, the arm brings them there.
///
/// Time is in s on the arm's own clock, which begins at 0 and passes only in [`Arm::run`]. Joints are in rad (m for slides), in the
/// order of [`Arm::joint_names`].
///
/// Whatever happens an arm never jumps: a trajectory that begins elsewhere is refused, a stop is smooth, and what goes on after a fault
/// goes on from where the joints are.
pub trait Arm: Send {
    /// Names of the joints.
    fn joint_names(&self) -> &[String];

    /// Lets time pass until `until_s`.
    ///
    /// # Errors
    /// Where the arm can never be moved again. What can be mended is a [`Present::fault`].
    fn run(&mut self, until_s: f64) -> Result<(), ArmLost>;

    /// Takes a trajectory up that begins at `starts_at_s`, in the past or the future, or at once. Returns its [`Present::number`].
    ///
    /// # Errors
    /// Where it is no trajectory for this arm, or would begin with a jump, or the arm has a fault; then nothing changes.
    fn play(&mut self, starts_at_s: Option<f64>, trajectory: JointTrajectory) -> Result<u64, Refused>;

    /// Stops on the path as soon as the limits allow.
    fn stop(&mut self);

    /// Where the joints are, and where they are to be.
    fn present(&self) -> Present;

    /// Goes on after a fault, at rest where the joints are.
    ///
    /// # Errors
    /// Where the cause is still there, in a sentence.
    fn recover(&mut self) -> Result<(), Refused> {
        Ok(())
    }

    /// Behind the wall clock by more than this, in s, the arm goes on later rather than to make up for it.
    fn most_behind_s(&self) -> f64 {
        0.1
    }
}

/// An arm at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Present {
    /// The time, in s of the arm's clock.
    pub now_s: f64,
    /// Counts what was played, so that whoever asked for something sees that something newer took over.
    pub number: u64,
    /// Where the joints are, as last measured.
    pub position: Vec<f64>,
    /// How fast they are, per s.
    pub velocity: Vec<f64>,
    /// Where they are to be: position, velocity (per s), acceleration (per s²).
    pub desired: [Vec<f64>; 3],
    /// Where they will rest.
    pub goal: Vec<f64>,
    /// When they will, in s of the arm's clock.
    pub ends_at_s: f64,
    /// Why the arm stopped, in a sentence; nothing is played until [`Arm::recover`].
    pub fault: Option<String>,
}

/// Why an arm can never be moved again, in a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ArmLost(pub String);
