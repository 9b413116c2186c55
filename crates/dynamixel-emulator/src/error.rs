use crate::packet::Refusal;

/// Why there is no bus, or no port to it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A control table of this crate does not say what it must.
    #[error("row {row} of the control table of the {model} is wrong: {what}")]
    Table {
        /// The servo's model.
        model: &'static str,
        /// The row, counted from 1 with the heading.
        row: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A servo without an ID of its own.
    #[error("servo {index} has the ID {id}, which {why}")]
    Id {
        /// Its place in the list.
        index: usize,
        /// Its ID.
        id: u8,
        /// What is wrong with the ID.
        why: &'static str,
    },
    /// A setting that the servo does not take.
    #[error("servo {id} does not take {value} at address {address}: {refusal}")]
    Setting {
        /// The servo.
        id: u8,
        /// The item's address.
        address: u16,
        /// The value.
        value: i32,
        /// The servo's reason.
        refusal: Refusal,
    },
    /// The system gives no pseudo-terminal.
    #[error("cannot {what} a pseudo-terminal: {source}")]
    Terminal {
        /// What was tried.
        what: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
}
