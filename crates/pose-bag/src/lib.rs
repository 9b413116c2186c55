//! Poses in rosbag2 (MCAP, SQLite), CSV, EuRoC, TUM and KITTI files.
//!
//! | format | read | write | order of the quaternion |
//! | --- | --- | --- | --- |
//! | rosbag2 folder, MCAP and `.db3` files | [`read_poses`]; [`BagReader`]: every [`msg::Message`] | [`BagWriter`]: every [`msg::Message`], MCAP | x, y, z, w by name |
//! | CSV by header | [`read_poses`], [`read_table`] for columns of any name | [`write_csv`] | columns `qx,qy,qz,qw` |
//! | EuRoC | [`read_poses`], [`read_table`] | – | by the names in its header (w first) |
//! | TUM | [`read_poses`] | [`write_tum`] | `t x y z qx qy qz qw` |
//! | KITTI | [`read_poses`] | – | none: `(R | t)` row by row |
//!
//! Positions are in metres, stamps in nanoseconds. What comes in is checked: numbers are finite, quaternions have norm 1 to
//! 1e-3 (and are normalised), bytes suffice for the lengths they claim, a bag's own definitions of its messages are the standard
//! ones, and nothing unpacks to more than is held in memory. What goes out appears whole or not at all.

mod bag_reader;
mod bag_writer;
mod bounded;
mod cdr;
mod channel;
mod error;
mod lines;
mod mcap_messages;
mod mcap_records;
mod metadata;
pub mod msg;
mod pending;
mod pose_set;
mod pose_sets;
mod pose_topic;
mod schema;
mod sqlite;
mod table;
mod track;

pub use bag_reader::BagReader;
pub use bag_writer::{BagWriter, Compression, OfferedQos, library_of};
pub use cdr::{CdrError, decode, encode};
pub use channel::BagMessage;
pub use error::BagError;
pub use pending::remove_abandoned;
pub use pose_set::{Grouping, Origin, PoseSet, Selection, read_poses, recover_poses};
pub use table::{POSE_COLUMNS, Table, read_table, write_csv};
pub use track::write_tum;
