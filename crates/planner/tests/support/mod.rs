//! Random pose sets, and a follower of curves that shares no search with the planner.

// Each test binary uses its part of this, and helpers of tests are not seen as tests.
#![allow(dead_code, clippy::unwrap_used)]

pub(crate) mod follower;
pub(crate) mod pose_sets;
pub(crate) mod random;
