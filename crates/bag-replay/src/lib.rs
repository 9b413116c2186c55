//! Recordings put in order, a bag at a time: the engine of `reorder replay` and of the fleet in Python.
//!
//! [`find`] says which bags are meant and [`outputs`] where the results go; [`replay`] does the work of one bag and never fails: what is
//! wrong with a bag stands in its [`BagSummary`]. An output appears whole or not at all and says what it was made of and how, so that
//! the same bag replayed in the same way is left as it is.

mod bag;
mod error;
mod inputs;
mod outputs;
mod robot;
mod score;
mod summary;
mod task;

pub use bag::replay;
pub use error::ReplayError;
pub use inputs::{Input, InputFile, find};
pub use outputs::{outputs, spare};
pub use planner;
pub use robot::load_robot;
pub use score::Score;
pub use summary::{BagSummary, SetSummary, Status, TrajectorySummary, table};
pub use task::Task;
