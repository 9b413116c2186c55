//! Why the node of an arm does not start, or stops.

/// One sentence each.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NodeError {
    #[error("parameters: {0}")]
    Parameters(String),
    #[error("ROS 2 refuses the command line or a parameter file: {0}")]
    CommandLine(String),
    #[error("{0}")]
    Arm(#[from] planner::ArmLost),
    #[error("the middleware stopped: {0}")]
    Middleware(String),
    #[error("ROS 2: {0}")]
    Ros(#[from] r2r::Error),
    #[error("{0}")]
    Io(#[from] std::io::Error),
}
