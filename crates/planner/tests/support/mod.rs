//! Random pose sets, a follower of curves that shares no search with the planner, and readers of what a session hands out.

// Each test binary uses its part of this, and helpers of tests are not seen as tests.
#![allow(dead_code, clippy::unwrap_used)]

pub(crate) mod closing;
pub(crate) mod follower;
pub(crate) mod outputs;
pub(crate) mod pose_sets;
pub(crate) mod random;
