//! Poses in rosbag2 (MCAP), CSV and TUM files.
//!
//! | format | read | write | order of the quaternion |
//! | --- | --- | --- | --- |
//! | rosbag2 folder, MCAP file | [`read_poses`]: `PoseArray`, `PoseStamped` | [`BagWriter`]: every [`msg::Message`] | x, y, z, w by name |
//! | CSV by header | [`read_poses`], [`read_table`] for columns of any name | [`write_csv`] | columns `qx,qy,qz,qw` |
//! | TUM | [`read_poses`] | [`write_tum`] | `t x y z qx qy qz qw` |
//!
//! Positions are in metres, stamps in nanoseconds. What comes in is checked: numbers are finite, quaternions have norm 1 to
//! 1e-3 (and are normalised), bytes suffice for the lengths they claim. What goes out appears whole or not at all.

mod bag_reader;
mod bag_writer;
mod cdr;
mod error;
mod lines;
mod mcap_messages;
mod mcap_records;
mod metadata;
pub mod msg;
mod pending;
mod pose_set;
mod table;
mod tum;

pub use bag_writer::{BagWriter, Compression, OfferedQos};
pub use cdr::{CdrError, decode, encode};
pub use error::BagError;
pub use pose_set::{Origin, PoseSet, read_poses};
pub use table::{POSE_COLUMNS, Table, read_table, write_csv};
pub use tum::write_tum;
