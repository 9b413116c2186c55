//! A bus of Dynamixel X-series servos that are not there, byte for byte as one that is.
//!
//! ```text
//! master ─► pseudo-terminal ─► Bus ─► Servo: control table, instructions, controllers, motor, protection ─► Plant
//!              EmulatedPort     │        ×n                                                               shafts
//!                               └─ wire: baud rate, return delay, collisions, faults
//! ```
//!
//! [`Bus`] takes bytes and time and gives bytes; it reads no clock and opens no port. [`EmulatedPort`] serves one behind a
//! pseudo-terminal, whose path a master opens as it would `/dev/ttyUSB0`. What the shafts drive is a [`Plant`].
//!
//! The control tables lie in `tables/` as the [e-manual](https://emanual.robotis.com/docs/en/dxl/x/xm540-w270/) has them. Where it is
//! silent, the code says "Assumed": units of the gains, the overload rule, heat, inertia and friction of the motor, what In-Position
//! means, how long a servo boots. Behind a servo that is missing in a sync read, all are silent; a broadcast ping is answered in the
//! order of IDs. Torque that comes on, and a new operating mode, take the position as it is for the goal, and 0 for the current, velocity
//! or PWM that the mode controls, where the e-manual has the limit; the gains of every mode are the factory's. Bounds follow their limits
//! when those are written, and only 0 takes the watchdog's error away. Not emulated: a host that talks over an answer (it is counted, and
//! waits), Protocol 1.0, the external ports of the XM540, the sync cable of dual mode, backlash.
//!
//! ```
//! use dynamixel_emulator::packet::{Packet, instruction};
//! use dynamixel_emulator::{Bus, FreeShafts, Model, ServoSettings};
//!
//! let shafts = FreeShafts::new(&[Model::Xm540W270]);
//! let mut bus = Bus::new(vec![ServoSettings::new(1, Model::Xm540W270)], Box::new(shafts))?;
//! let ping = Packet { id: 1, instruction: instruction::PING, parameters: vec![] };
//! let answers = bus.receive(&ping.encode());
//! assert_eq!(answers[0].bytes[9..11], 1120u16.to_le_bytes());
//! # Ok::<(), dynamixel_emulator::Error>(())
//! ```

mod bus;
mod error;
mod faults;
pub mod item;
mod memory;
mod model;
pub mod packet;
mod plant;
mod port;
mod servo;
mod table;
pub mod units;

pub use bus::{Bus, Transmission};
pub use error::Error;
pub use faults::{Connection, Faults, Rates, ServoFaults};
pub use item::Item;
pub use model::{Datasheet, Model};
pub use plant::{FreeShafts, Plant, Shaft};
pub use port::{EmulatedPort, Timing};
pub use servo::{HardwareError, Servo, ServoSettings};
