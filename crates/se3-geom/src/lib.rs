//! Manifolds as values, Lie groups, geodesics and C² splines for robot motion.
//!
//! A [`Manifold`] is a value that owns its metric; points and tangents are plain [`nalgebra`] data. Two structures live on
//! SE(3) and are kept apart by type:
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
mod chart_functions;
mod curve;
mod embedding;
mod euclidean;
mod geodesic_flow;
mod geodesic_search;
mod group;
mod level_set;
mod manifold;
mod monge;
mod nearest_rotation;
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
mod twist;

pub use curve::{
    ArcLengthError, Bezier, ByArcLength, CubicEnds, CubicSpline, Curve, Derivatives, Geodesic, Jet, JetSpace,
    Parameterisation, PartialGeodesic, PoseJet, Screw, arc_length, centripetal_knots, curvature,
};
pub use embedding::{Embedding, RoundFactor};
pub use euclidean::{Euclidean, R2, R3};
pub use geodesic_search::GeodesicError;
pub use group::{LieGroup, NoLogarithm, Se2Group, Se3Group, Sim2Group, So2Group, So3Group};
pub use level_set::{Constraint, LevelSet, UnitSegments};
pub use manifold::{CutLocus, Manifold, Tangent};
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
pub use twist::Twist;
