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
//! let shuffled = [0.6, 0.0, 1.2, 0.9, 2.1, 0.3, 1.5, 1.8, 2.7, 2.4].map(helix);
//! let ordering = order(&R3::default(), &shuffled, &Options::default())?;
//! assert_eq!(ordering.order, [1, 5, 0, 3, 2, 6, 7, 4, 9, 8]);
//! assert_eq!((ordering.topology, ordering.verdict), (Topology::Open, Verdict::Plausible));
//! # Ok(()) }
//! ```
//!
//! # Verdict
//!
//! A silent wrong order is the worst defect. An order is [`Verdict::Plausible`] only if none of these doubts arises, and
//! [`Verdict::Certified`] only if the conditions further down hold too:
//!
//! - the tree branches;
//! - a gap is more than 3 times longer, or more than 8 times shorter, than the median of the five gaps on either side (unless the
//!   samples are dense and their gaps look like those of independent points, which are that uneven);
//! - the order turns by 90° or more at a point, by `log` at the point;
//! - a point's edges are not those that NN-CRUST would draw: somebody else is nearer than its nearest neighbour, or nearer than
//!   its other neighbour and on the same side; past an open end, nearer than twice the longest of the five last gaps;
//! - the sampling parameter ε at a point, from its gaps and its smallest tangent ball through another sample, is above 0.72;
//! - both ends come near each other, but do not clearly meet;
//! - the longest gap of a loop is more than 1.5 times the next, or exceeds it by more than 3.5 mean gaps where the gaps look like those of
//!   independent points: it may be open there, unless a loop is asked for;
//! - two neighbours lie on each other's cut locus;
//! - two neighbours both occur more than once;
//! - points that differ by no more than the rounding of their coordinates come one after the other in a row, or were merged and leave
//!   fewer than ten;
//! - twelve gaps in a row alternate while every second point alone is spaced far more evenly, or every second or third point alone is spaced
//!   so much more evenly over twenty gaps as chance makes it once in 200 sets, or even gaps are followed by others that are as long two by two:
//!   so are the points of a curve that runs over itself;
//! - two gaps within twelve are much longer or much shorter than both beside them, while most gaps change smoothly; or three are, anywhere, where
//!   the points lie on a straight line, a geodesic, as where something goes to and fro on a rail or about an axis;
//! - the points were denoised ([`Options::denoise`]), and two neighbours are nearer than three deviations of the noise in their distance,
//!   estimated from the moves;
//! - there are three to nine distinct points: too few to tell one curve from another; or fewer than 25, and half the longest gap is more than
//!   0.6 of the reach;
//! - ten points in a row step from side to side, while every second one alone is smooth: the curve may run back beside itself;
//! - for poses: the order changes when a radian counts for half or for twice as many metres.
//!
//! Where something in this list speaks against the order (and there are no more than [`MOST_REPAIRED_UNASKED`] points), the order
//! is sought again as the path that is short and turns little ([`Method::Repaired`]): by local search with 3 units of length for a
//! unit of turning. It is judged by searches that should find the same, at other prices of turning (0, 1, 8), from another start, and
//! at other weights: every place where one of them differs is a doubt. If none differs, the samples are clean, and no more than twelve points in a row are in dispute, as where a curve crosses itself, doubts about neighbourhoods are taken
//! back, and the order is plausible. On noisy samples, and where a curve runs back beside itself, they stand, since there all searches
//! agree on one wrong order too often.
//!
//! An order by a method that was asked for ([`MethodChoice`]) is also doubted where the method's edges are no single curve, and where the
//! minimum spanning tree has others. Several curves ordered apart ([`ComponentsChoice`]) are trusted as the least of them is;
//! every jump to an outlier is a doubt. Every doubt says between which two points one more would settle it.
//!
//! Samples are clean where nine of ten points miss the parabola through their neighbours by at most a tenth of a gap, which cannot have
//! swapped two points; or nine of ten by at most a quarter, or half of them by at most a tenth, while at no more than five points in
//! a row the order turns back. Noise is everywhere, and moves the median as it moves the rest; a curve that is sampled too sparsely
//! in its bends misses there and nowhere else.
//!
//! What it cannot see: a curve that runs back along itself while its points happen to fall evenly between each other, or
//! one that leaves out a stretch and goes straight on. No distance tells those from an honest curve.
//!
//! # Certified
//!
//! **Theorem.** Let C be a simple curve, an arc or a loop, in a complete Riemannian manifold, S finitely many points on it, the ends
//! of an arc among them, and ρ > 0 such that (a) from any point c of the manifold, the distance to C has at most one local minimum,
//! strict or not, that is below ρ, and (b) consecutive points of S are less than 2ρ apart. Then every edge of a minimum spanning tree
//! of S joins consecutive points.
//!
//! *Proof.* Let pq be an edge of the tree, 2r its length, c its midpoint, f the distance to c on C. The tree is minimal, so every arc
//! of C from p to q holds two consecutive points that are at least 2r apart; hence r < ρ. Let K be the part of C where f ≤ r; it holds
//! p and q, where f = r. K is connected: otherwise it would fall into two closed parts, and f is least on each of them at a local
//! minimum on C, for near either part f > r elsewhere. So K is the whole loop, or an arc that holds p and q.
//!
//! Call a stretch an arc in K between p and q, or one that leads from p or q on to an end of K without the other. Every stretch holds a
//! local minimum on C that is neither p nor q: if f = r throughout, every inner point is one; otherwise f is least at an inner
//! point, or at an end of K, beyond which f > r or C ends. Different stretches meet in p and q at most, so by (a) there is one: K is no
//! loop, which has two, and it does not run on past p or q. K is an arc from p to q. Between them f < r, for a point with f = r there
//! would part K into two arcs with a local minimum within each, by the same argument. So any two points of K other than the pair p, q are
//! less than 2r apart. Hence no point of S is between p and q on K, and they are consecutive. ∎
//!
//! In flat space (a) follows from a reach of ρ: at a local minimum x the vector c − x is normal to C, and then x is the only point of C
//! that is nearest to c, if ‖c − x‖ is below the reach (Federer, *Curvature Measures*, 4.8). It says nothing of minima farther away: from
//! a point between the parallel sides of a stadium both sides have one. Elsewhere it also needs ρ below the injectivity radius, which
//! makes the feet of normal geodesics the only candidates for minima. It improves on Theorem 6.1 of the thesis (gaps below ρ) by the
//! factor 2.
//!
//! So a certified order asserts: **if** the curve is simple, has a reach ρ above `required_reach` (half the longest gap), and is
//! left without a sample nowhere for 2ρ, **then** this order is its order, and no other curve of that kind through these points has
//! another. That the premise is likely is what the samples must show, and these conditions ask for it
//! ([`Certificate::conditions`]):
//!
//! - no doubt in the list above; in particular every edge is one that NN-CRUST draws too, and no vertex branches;
//! - the reach by the samples, in a space as curved as the injectivity radius allows, is at least twice `required_reach`
//!   (`epsilon` ≤ 0.5): so the estimate may be wrong by a factor of 2;
//! - the samples are smooth, not noisy: each point misses the parabola through three neighbours by no more than a third
//!   derivative of 20/reach² explains, or by less than a tenth of the shortest gap there, which cannot have swapped two points; and at
//!   no more than three points in a row does the order turn back against the turn before;
//! - the ends of an arc are at least 4 times the longest gap apart, the longest gap of a loop is at most 1.1 times the next, or at most
//!   twice the next and 3.5 mean gaps longer where the gaps look like those of independent points;
//! - no gap is more than 1.9 times the median of the gaps around it, where the gaps do not look like those of independent points;
//! - there are at least 12 distinct points.
//!
//! What it cannot assert: that the curve does nothing between two samples. A detour that no sample shows, or a second pass
//! whose points fall on the line of the first, or beside it by less than a tenth of a gap and in no regular alternation with it,
//! breaks the premise and leaves no trace. Nor
//! that a loop is one: the theorem gives the neighbours, and the closing edge is what a statistic of the gaps makes likely. An arc
//! whose ends are at most 3.5 mean gaps farther apart than its longest gap passes for a loop where its gaps look independent: the longest
//! gap of a loop exceeds the next by more once in 33 times ([`Options::topology`](Options) settles it). The order within a certified
//! answer was never wrong on the random curves of `tests/random_orders.rs` (`cargo xtask soak orders`), sparse, uneven, noisy,
//! crossing and retraced ones among them.
//!
//! # Progress
//!
//! The phases are spans of the [`tracing`](https://docs.rs/tracing) crate, at level debug: `spanning tree`, `certificate`, `search`. Nobody
//! listening costs nothing.
//!
//! # Open or closed
//!
//! Told from the ends of the path: closed if their distance is at most 1.1 times the longest gap (up to 1.5 times where the gaps next
//! to the ends are as uneven) and at most twice the longest of the five gaps next to either end, and the curve turns by less
//! than 90° at both ends. Where the gaps look like those of independent points, of which the longest exceeds all others by more than
//! two mean gaps only once in seven times, that much is enough. Also closed where they do, the closing gap is at most twice the longest,
//! and the loop meets every condition of a certified order. Where a loop is asked for and the tree is a path that nothing
//! speaks against, its ends are joined; elsewhere a short loop is sought.

mod agreement;
mod certificate;
mod components;
mod crust;
mod curve;
mod denoise;
mod doubts;
mod drawing;
mod duplicates;
mod edges;
mod equality;
mod error;
mod finish;
mod forest;
mod independence;
mod named;
mod near_pairs;
mod nearest;
mod nn_crust;
mod order;
mod ordering;
mod passes;
mod poses;
mod recovery;
mod repair;
mod settling;
mod sides;
mod smoothness;
mod spanning_tree;
mod start;
mod sweep;
mod thread;
mod topology;
mod tour;
mod walk;
mod weight;

pub use certificate::{Certificate, Condition};
pub use components::{APART, Component, Components, FEWEST_OF_A_CURVE, Split, order_components, split};
pub use crust::crust;
pub use drawing::{Drawing, NoCurve, Strand};
pub use edges::EdgeFigures;
pub use error::OrderError;
pub use nearest::nearest_chain;
pub use nn_crust::nn_crust;
pub use order::{MOST_DENOISED, MOST_REPAIRED_UNASKED, order};
pub use ordering::{
    ComponentsChoice, Doubt, Method, MethodChoice, Options, Ordering, Part, Repair, Repaired, Topology, TopologyChoice,
    Verdict,
};
pub use petgraph;
pub use poses::{order_poses, order_weighted};
pub use spade;
pub use spanning_tree::{Tree, minimum_spanning_tree};
pub use weight::{Weight, Weighted, automatic_weight};

/// The README's example, compiled and run with the other examples.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
