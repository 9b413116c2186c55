//! Manifolds as values, Lie groups, geodesics and C² splines for robot motion.
//!
//! A [`Manifold`] is a value that owns its metric; points and tangents are plain [`nalgebra`] data. Each page below states the
//! space's points, tangents, metric, exponential, logarithm, transport, injectivity radius, units, errors and source; "thesis" is
//! P. Shah, *On Curve Reconstruction in Riemannian Manifolds: Ordering Motion Frames*.
//!
//! | space | as a manifold | as a group |
//! | --- | --- | --- |
//! | ℝᴺ | [`Euclidean`] | |
//! | directions S² | [`Sphere`] | |
//! | rotations | [`So2`], [`So3`] | [`So2Group`], [`So3Group`] |
//! | rigid motions | [`Se2`], [`Se3`] | [`Se2Group`], [`Se3Group`] |
//! | similarities of the plane | [`Sim2`] | [`Sim2Group`] |
//! | surfaces z = h(x, y) | [`MongePatch`] | |
//! | implicit sets F(x) = 0 | [`LevelSet`] | |
//!
//! | curve | what it is |
//! | --- | --- |
//! | [`Geodesic`], [`Screw`] | the straight line of a manifold, and of the group SE(3) |
//! | [`PartialGeodesic`] | slerp of rotations, C² cubic spline of positions (thesis eqs. 6.9, 6.10) |
//! | [`Bezier`] | de Casteljau with given end velocities (eq. 6.15) |
//! | [`PoseSpline`] | C² through every pose: the one to want for execution |
//! | [`CubicSpline`] | C² through vectors |
//! | [`ByArcLength`] | any of them at constant speed |
//!
//! Two structures live on SE(3) and are kept apart by type:
//!
//! | type | structure | straight line between two poses | use it for |
//! | --- | --- | --- | --- |
//! | [`Se3`] | Riemannian manifold with the left-invariant product metric | slerp + straight line of the origin | distances, ordering, interpolation |
//! | [`Se3Group`] | Lie group | screw motion | twists, Jacobians, kinematic chains |
//!
//! The norm of the group logarithm is **not** a distance (it breaks the triangle inequality), so only [`Se3::distance`]
//! may weigh an edge.
//!
//! Conventions: a [`Pose`] reads `world_from_tool`; a [`Twist`] has named fields `linear`, `angular` and is expressed in the body
//! (tool) frame; metres, radians, and whatever unit the caller's parameter has.
//!
//! ```
//! use se3_geom::{pose_from_xyzw, centripetal_knots, Ends, PoseSpline, Se3};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let s = 0.5_f64.sqrt();
//! let poses = [
//!     pose_from_xyzw([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])?,
//!     pose_from_xyzw([0.1, 0.0, 0.0], [0.0, 0.0, s, s])?,
//!     pose_from_xyzw([0.1, 0.1, 0.0], [0.0, 0.0, 1.0, 0.0])?,
//! ];
//! let knots = centripetal_knots(&Se3::default(), &poses);
//! let spline = PoseSpline::through(&poses, &knots, Ends::Natural)?;
//! let motion = spline.at(knots[1]);
//! assert!((motion.pose.translation.vector - poses[1].translation.vector).norm() < 1e-12);
//! # Ok(()) }
//! ```

mod angle_series;
mod block_tridiagonal;
mod curvature_flow;
mod curve;
mod distance_map;
mod embedding;
mod euclidean;
mod geodesic_flow;
mod geodesic_search;
mod group;
mod level_set;
mod manifold;
mod monge;
mod nearest_rotation;
mod path_relaxation;
mod planar_twist;
mod pose;
mod pose_spline;
mod rotation_segment;
mod se2;
mod se3;
mod sim2;
mod so2;
mod so3;
mod sphere;
mod spline_error;
mod spline_rates;
mod stumpff;
mod surface_grid;
mod tridiagonal;
mod twist;
mod unit;

pub use curvature_flow::{CurvatureFlow, FlowError};
pub use curve::{
    ArcLengthError, Bezier, ByArcLength, CubicEnds, CubicSpline, Curve, Derivatives, Geodesic, Jet, JetSpace,
    Parameterisation, PartialGeodesic, PoseJet, Screw, arc_length, centripetal_knots, curvature,
};
pub use distance_map::{DistanceMap, FrontError};
pub use embedding::{Embedding, RoundFactor};
pub use euclidean::{Euclidean, R2, R3};
pub use group::{LieGroup, NoLogarithm, Se2Group, Se3Group, Sim2Group, So2Group, So3Group};
pub use level_set::{Constraint, LevelSet, UnitSegments};
pub use manifold::{LogError, Manifold, Tangent};
pub use monge::{HeightJet, MongePatch};
pub use nalgebra;
pub use nearest_rotation::{NearestRotationError, nearest_rotation};
pub use planar_twist::{PlanarTwist, SimilarityTwist};
pub use pose::{InvalidPose, Pose, UNIT_QUATERNION_TOLERANCE, pose_from_xyzw, rotation_from_xyzw, xyzw_from_rotation};
pub use pose_spline::{Ends, HALF_TURN_MARGIN_RAD, Motion, PoseSpline, WINDING_BOUND_RAD};
pub use se2::Se2;
pub use se3::Se3;
pub use sim2::Sim2;
pub use so2::So2;
pub use so3::So3;
pub use sphere::Sphere;
pub use spline_error::SplineError;
pub use surface_grid::{SurfaceGrid, SurfaceGridError};
pub use twist::Twist;

/// The README's example, compiled and run with the other examples.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
