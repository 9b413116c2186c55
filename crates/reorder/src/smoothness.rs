//! Whether points in order look like samples of a smooth curve without noise.

use se3_geom::Manifold;

use crate::curve::Curve;

/// How rough the samples are, and how sharply the order turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothness {
    /// Greatest turn from one edge to the next.
    pub(crate) turn_rad: f64,
    /// Greatest miss of a point from the parabola through the point before and the two after it, in units of what is allowed.
    pub(crate) roughness: f64,
    /// Most points in a row at which the order turns back against the turn before.
    pub(crate) zigzag: usize,
}

/// A third derivative by length of up to this many times 1/reach² is smooth.
const THIRD_DERIVATIVE: f64 = 20.0;
/// A miss of at most this share of the shortest gap around cannot have swapped two points.
const MISS_TO_GAP: f64 = 0.1;

pub(crate) fn smoothness<M: Manifold>(curve: &Curve<M>, reach: f64) -> Smoothness {
    let mut found = Smoothness { turn_rad: 0.0, roughness: 0.0, zigzag: 0 };
    let mut run = 0;
    for k in 0..curve.len() {
        let Some((before, after)) = curve.previous(k).zip(curve.next(k)) else { continue };
        if let Some(cosine) = curve.cosine(k, before, after) {
            found.turn_rad = found.turn_rad.max(std::f64::consts::PI - cosine.clamp(-1.0, 1.0).acos());
        }
        let Some(beyond) = curve.next(after).filter(|&beyond| beyond != before) else { continue };
        let (Some(a), Some(b), Some(c)) = (curve.log(k, before), curve.log(k, after), curve.log(k, beyond)) else {
            continue;
        };
        let norm = |v| curve.manifold.norm(curve.point(k), v);
        let (g0, g1, g2) = (norm(a), norm(b), norm(c - b));
        // Divided differences: second ones at k and at the next point, and the third from both.
        let (u, v, w) = (a * (-1.0 / g0), b * (1.0 / g1), (c - b) * (1.0 / g2));
        let (here, there) = ((v - u) * (1.0 / (g0 + g1)), (w - v) * (1.0 / (g1 + g2)));
        let third = norm((there - here) * (1.0 / (g0 + g1 + g2)));
        let spans = g0 * g1 * (g1 + g2);
        let allowed = (THIRD_DERIVATIVE / 6.0 * spans / (reach * reach)).max(MISS_TO_GAP * g0.min(g1).min(g2));
        found.roughness = found.roughness.max(third * spans / allowed);
        run = if curve.manifold.inner(curve.point(k), here, there) < 0.0 { run + 1 } else { 0 };
        found.zigzag = found.zigzag.max(run);
    }
    found
}
