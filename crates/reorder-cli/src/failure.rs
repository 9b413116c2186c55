//! What ends the command early, and with which exit code.

use std::fmt;
use std::process::ExitCode;

/// One sentence for standard error. Bad input exits with 2, a refusal (no trajectory exists, or none is safe) with 1.
#[derive(Debug)]
pub(crate) enum Failure {
    BadInput(String),
    Refused(String),
}

impl Failure {
    pub(crate) fn bad_input(error: impl fmt::Display) -> Self {
        Self::BadInput(error.to_string())
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::BadInput(_) => ExitCode::from(2),
            Self::Refused(_) => ExitCode::from(1),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadInput(sentence) => write!(f, "reorder: {sentence}"),
            Self::Refused(sentence) => write!(f, "reorder: refused: {sentence}"),
        }
    }
}
