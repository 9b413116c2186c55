//! An arm of Dynamixel servos, real or not.
//!
//! ```text
//! planner::Arm ─► DynamixelArm ─► Bus ─► dynamixel_sdk (Python) ─► /dev/ttyUSB0 ─► servos
//!                     │                                  └───────► /dev/pts/N ─► emulated servos ─► MuJoCo
//!                     └ goals, feed-forward, watch
//! ```
//!
//! A [`Config`] names the port: a serial port is a real arm, `sim` an emulated bus with the arm's model in MuJoCo behind it
//! ([`Simulation`]). Nothing else differs: the same SDK says the same bytes.
//!
//! Servos are driven by proportional position control without profiles. Such a servo lags by its speed and sags by its load; since both
//! are known from its data sheet and the arm's inertias, every goal lies ahead by as much; what is left is learnt slowly. Its own Profile
//! Velocity bounds its speed whatever it is told.
//!
//! After a fault the arm stops on its path where it can still be led, else it holds where it stands, and says why in one sentence that
//! names the servo; [`planner::Arm::recover`] goes on from where the joints are.
//!
//! ```no_run
//! use dynamixel_hil::{Config, open};
//! use planner::Arm;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (mut arm, _simulation) = open(Config::read("config/arms/vx300s.yaml")?, None)?;
//! arm.run(0.0045)?; // and so on, 220 times a second
//! println!("{:?}", arm.present().position);
//! # Ok(()) }
//! ```

mod arm;
mod bring_up;
mod bus;
mod config;
mod error;
mod joints;
mod link;
mod model;
mod plant;
pub mod register;
mod sdk;
mod search;
mod servo_state;
mod simulation;
mod statistics;
mod trim;
mod watch;

pub use arm::{Clock, DynamixelArm};
pub use bring_up::{identify, joint_position};
pub use bus::{Bus, Counters, GroupRead, GroupWrite};
pub use config::{Config, SIMULATED_PORT, Servo, Watch};
pub use dynamixel_emulator as emulator;
pub use error::{HardwareErrors, HilError, ServoName};
pub use model::Model;
pub use planner;
pub use plant::{ArmPlant, JointTruth, PlantView};
pub use servo_state::ServoState;
pub use simulation::{Simulation, open};
pub use statistics::StepTimes;
