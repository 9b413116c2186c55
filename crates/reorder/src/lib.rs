//! Recovers the order of points sampled from a curve on a manifold.
//!
//! [`order`] takes the points in any order and returns their order along the curve, by the exact minimum spanning tree of their
//! geodesic distances (P. Shah, *On Curve Reconstruction in Riemannian Manifolds: Ordering Motion Frames*, chapters 5 and 6).
//! [`order_poses`] does so for poses in SE(3) and also checks the weight between rotation and translation.
//!
//! ```
//! use reorder::{Options, Topology, Verdict, order};
//! use se3_geom::{R3, nalgebra::Vector3};
//! # fn main() -> Result<(), reorder::OrderError> {
//! let helix = |t: f64| Vector3::new(t.cos(), t.sin(), 0.3 * t);
//! let shuffled = [0.6, 0.0, 1.2, 0.9, 2.1, 0.3, 1.5, 1.8].map(helix);
//! let ordering = order(&R3::default(), &shuffled, &Options::default())?;
//! assert_eq!(ordering.order, [1, 5, 0, 3, 2, 6, 7, 4]);
//! assert_eq!((ordering.topology, ordering.verdict), (Topology::Open, Verdict::Plausible));
//! # Ok(()) }
//! ```
//!
//! # Verdict
//!
//! A silent wrong order is the worst defect. An order is [`Verdict::Plausible`] only if none of these doubts arises, and nothing
//! is ever called [`Verdict::Certified`] yet:
//!
//! - the tree branches;
//! - a gap is more than 3 times longer, or more than 8 times shorter, than the median of the five gaps on either side;
//! - the order turns by 90° or more at a point, by `log` at the point;
//! - a point's edges are not those that NN-CRUST would draw: somebody else is nearer than its nearest neighbour, or nearer than
//!   its other neighbour and on the same side; past an open end, nearer than twice the longest of the five last gaps;
//! - the sampling parameter ε at a point, from its gaps and its smallest tangent ball through another sample, is above 0.72;
//! - both ends come near each other, but do not clearly meet;
//! - two neighbours lie on each other's cut locus;
//! - two neighbours both occur more than once;
//! - twelve gaps in a row alternate while every second point alone is spaced far more evenly, as where a curve runs back beside
//!   itself;
//! - there are three to seven distinct points: too few to tell one curve from another;
//! - for poses: the order changes when a radian counts for half or for twice as many metres.
//!
//! What it cannot see: a curve that runs back along itself while its points happen to fall evenly between each other, or
//! one that leaves out a stretch and goes straight on. No distance tells those from an honest curve.
//!
//! # Open or closed
//!
//! Told from the ends of the path: closed if their distance is at most 1.1 times the longest gap (up to 1.5 times where the gaps next
//! to the ends are as uneven) and at most twice the longest of the five gaps next to either end, and the curve turns by less
//! than 90° at both ends.

mod agreement;
mod curve;
mod doubts;
mod duplicates;
mod error;
mod order;
mod ordering;
mod poses;
mod recovery;
mod repair;
mod spanning_tree;
mod sweep;
mod topology;
mod tour;
mod walk;
mod weight;

pub use error::OrderError;
pub use order::{MOST_REPAIRED_UNASKED, order};
pub use ordering::{Certificate, Doubt, Method, MethodChoice, Options, Ordering, Repair, Repaired, Topology, TopologyChoice, Verdict};
pub use petgraph;
pub use poses::{order_poses, order_weighted};
pub use spanning_tree::{Tree, minimum_spanning_tree};
pub use weight::{Weight, Weighted, automatic_weight};
