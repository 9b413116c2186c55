//! Why there is no page.

/// One sentence each.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReportError {
    /// What is given as a run is none, or one of another trajectory.
    #[error("no run of this trajectory as `reorder simulate --format json` prints it: {reason}")]
    Simulation {
        /// What is missing or wrong.
        reason: String,
    },
    /// What is given as the drawing library is something else.
    #[error(
        "not the CommonJS build of three.js (build/three.cjs of the npm package three, up to version 0.184): {reason}"
    )]
    Library {
        /// How that is seen.
        reason: &'static str,
    },
}
