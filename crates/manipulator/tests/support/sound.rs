//! Whether a joint path is what it is said to be.

use std::f64::consts::TAU;

use manipulator::{JointPath, PathOptions, Robot};
use se3_geom::{Manifold, PoseSpline, Se3, So3};

/// What must hold of every path: the tool within tolerance and the joints within limits on fifty places an interval of the spline,
/// the poses passed, and closed curves closed in the joints too.
pub(crate) fn assert_sound(robot: &Robot, curve: &PoseSpline, path: &JointPath, options: &PathOptions) {
    for pair in path.knots().windows(2) {
        for i in 0..50 {
            let s = pair[0] + (pair[1] - pair[0]) * f64::from(i) / 50.0;
            let [q, ..] = path.at(s);
            let (tool, target) = (robot.chain.forward(&q), curve.pose(s));
            let off = (tool.translation.vector - target.translation.vector).norm();
            assert!(off <= options.tolerance_m, "{}: {off} m at {s}", robot.name);
            assert!(So3.distance(&tool.rotation, &target.rotation) <= options.tolerance_rad);
            let inside = |j: usize| q[j] >= robot.limits.lower[j] - 1e-9 && q[j] <= robot.limits.upper[j] + 1e-9;
            assert!((0..q.len()).all(inside), "{}: {q} at {s}", robot.name);
        }
    }
    for &s in path.pose_parameters() {
        // Samples are solved to 1e-9 m and 1e-9 rad.
        assert!(Se3::default().distance(&robot.chain.forward(&path.at(s)[0]), &curve.pose(s)) < 2e-9);
    }
    if curve.is_closed() {
        let [first, last] = [path.domain().0, path.domain().1].map(|s| path.at(s));
        let turns = (&last[0] - &first[0]).map(|way| way - TAU * (way / TAU).round());
        assert!(turns.amax() < 1e-6, "{}: open by {turns}", robot.name);
        for order in [1, 2] {
            // The curve's derivatives agree to rounding, the configurations to 1e-8 after division by the least singular value.
            let size = 1.0 + first[order].amax();
            assert!((&last[order] - &first[order]).amax() < 1e-5 * size, "{} order {order}", robot.name);
        }
    }
}
