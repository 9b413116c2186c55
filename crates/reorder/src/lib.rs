//! Recovers the order of points sampled from a curve on a manifold.

mod curve;
mod doubts;
mod duplicates;
mod error;
mod order;
mod ordering;
mod poses;
mod spanning_tree;
mod sweep;
mod topology;
mod walk;

pub use error::OrderError;
pub use order::order;
pub use ordering::{Certificate, Doubt, Method, Options, Ordering, Topology, TopologyChoice, Verdict};
pub use petgraph;
pub use poses::order_poses;
pub use spanning_tree::{Tree, minimum_spanning_tree};
pub(crate) fn par(n:&str,d:f64)->f64{std::env::var(n).ok().and_then(|s|s.parse().ok()).unwrap_or(d)}
