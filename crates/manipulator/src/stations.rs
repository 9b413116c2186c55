//! Places along a curve at which the joints' way is chosen.

use se3_geom::{Manifold, PoseSpline, Se3};

/// Tool travel between stations, in m (a radian counts as much as a metre does with the arms that poses of the tool are given for).
pub(crate) const SPACING: f64 = 0.15;
const LEAST_INTERVALS: f64 = 6.0;

/// A place on the curve, with the tool's way to the next in m and rad as one number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Station {
    pub(crate) s: f64,
    pub(crate) length: f64,
}

/// Stations from the first parameter to the last, about evenly spaced in the tool's way from pose to pose, `density` times as many
/// as commonly.
pub(crate) fn stations(curve: &PoseSpline, density: f64) -> Vec<Station> {
    let metric = Se3::default();
    let knots = curve.knots();
    let poses: Vec<_> = knots.iter().map(|&s| curve.pose(s)).collect();
    let ways: Vec<f64> = poses.windows(2).map(|pair| metric.distance(&pair[0], &pair[1])).collect();
    let total: f64 = ways.iter().sum();
    let intervals = (density * (total / SPACING).max(LEAST_INTERVALS)).ceil().min((8 * knots.len()) as f64);
    let spacing = (total / intervals).max(f64::MIN_POSITIVE);
    let (mut stations, mut gone) = (vec![Station { s: knots[0], length: spacing }], 0.0);
    for (k, way) in ways.iter().enumerate() {
        // Every place in this segment at which a whole number of spacings is gone.
        let due = |count: usize| count as f64 * spacing - gone;
        while due(stations.len()) < *way && (stations.len() as f64) < intervals {
            let s = knots[k] + (knots[k + 1] - knots[k]) * due(stations.len()) / way;
            // Rounding may put a place on the one before.
            if s <= stations[stations.len() - 1].s {
                break;
            }
            stations.push(Station { s, length: spacing });
        }
        gone += way;
    }
    let end = knots[knots.len() - 1];
    // What rounding leaves next to the end is no interval of its own.
    while stations.len() > 1 && end - stations[stations.len() - 1].s < 1e-6 * (end - knots[0]) {
        stations.pop();
    }
    if let [only] = stations[..] {
        // A tool that stands still has no way to share out; a posture's ends need three stations.
        stations.push(Station { s: 0.5 * (only.s + end), ..only });
    }
    stations.push(Station { s: end, length: 0.0 });
    stations
}
