//! One pass over all pairs of points: reach, local sampling density, and points that come between neighbours.

use se3_geom::Manifold;

use crate::curve::Curve;

/// The local sampling parameter above which a point is doubted.
///
/// NN-CRUST is correct in any dimension if every point of the curve has a sample within ε = 0.66 times its distance to the medial
/// axis; at 0.72 there are samples that two different curves share (Bjerkevik, arXiv 2112.03656).
pub(crate) const LOCAL_EPSILON: f64 = 0.72;

/// What the pass finds.
pub(crate) struct Sweep {
    /// Smallest radius of a ball that touches the tangent at one point and passes through another; infinite where all points
    /// lie on all tangents.
    pub(crate) reach: f64,
    /// For every position the nearest point that disputes one of its neighbours' places.
    pub(crate) rivals: Vec<Option<usize>>,
    /// For every position where ε = (longer gap)/(2·radius) exceeds [`LOCAL_EPSILON`]: the point on the smallest ball, and ε.
    pub(crate) sparse: Vec<Option<(usize, f64)>>,
}

struct Vertex<T> {
    nearer: usize,
    nearer_gap: f64,
    farther_gap: f64,
    /// Unit tangent; `None` at an open end or on a cut locus.
    tangent: Option<T>,
}

/// A point disputes the neighbours of p if it is nearer than p's nearer neighbour, or nearer than the farther one and on that
/// one's side (at more than 90° from the nearer one, by log at p). No rival anywhere means that every point's edges are the ones
/// which NN-CRUST (Dey and Kumar, 1999) draws. At an open end the missing neighbour counts as `beyond_ends` away.
///
/// The ball at p through q has radius ‖v‖²/(2‖v⊥‖) ≥ ‖v‖/2, v = log_p(q): only near pairs need their logarithm taken.
pub(crate) fn sweep<M: Manifold>(curve: &Curve<M>, beyond_ends: [f64; 2]) -> Sweep {
    let n = curve.len();
    let vertices: Vec<Vertex<M::Tangent>> = (0..n).map(|k| vertex(curve, k, beyond_ends)).collect();
    let mut found = Sweep { reach: f64::INFINITY, rivals: vec![None; n], sparse: vec![None; n] };
    let mut rival_distances = vec![f64::INFINITY; n];

    // Neighbours first: they bound the reach, so that most other pairs are told by their distance alone.
    for (k, next) in (0..n).filter_map(|k| Some((k, curve.next(k)?))) {
        found.measure_ball(curve, &vertices[k], k, next);
        found.measure_ball(curve, &vertices[next], next, k);
    }
    for i in 0..n {
        for j in (i + 2)..n {
            if curve.closed && i == 0 && j + 1 == n {
                continue;
            }
            let distance = curve.distance(i, j);
            for (at, other) in [(i, j), (j, i)] {
                let vertex = &vertices[at];
                if distance < 2.0 * found.reach || LOCAL_EPSILON * distance < vertex.farther_gap {
                    found.measure_ball(curve, vertex, at, other);
                }
                let near = distance < vertex.farther_gap && distance < rival_distances[at];
                if near && disputes(curve, vertex, at, other, distance) {
                    rival_distances[at] = distance;
                    found.rivals[at] = Some(other);
                }
            }
        }
    }
    found
}

impl Sweep {
    fn measure_ball<M: Manifold>(&mut self, curve: &Curve<M>, vertex: &Vertex<M::Tangent>, at: usize, other: usize) {
        let Some(radius) = vertex.tangent.and_then(|tangent| ball_radius(curve, tangent, at, other)) else { return };
        self.reach = self.reach.min(radius);
        let epsilon = vertex.farther_gap / (2.0 * radius);
        if epsilon > self.sparse[at].map_or(LOCAL_EPSILON, |(_, worst)| worst) {
            self.sparse[at] = Some((other, epsilon));
        }
    }
}

fn vertex<M: Manifold>(curve: &Curve<M>, k: usize, beyond_ends: [f64; 2]) -> Vertex<M::Tangent> {
    match (curve.previous(k), curve.next(k)) {
        (Some(a), Some(b)) => {
            let (gap_a, gap_b) = (curve.distance(k, a), curve.distance(k, b));
            let (nearer, nearer_gap, farther_gap) = if gap_a <= gap_b { (a, gap_a, gap_b) } else { (b, gap_b, gap_a) };
            Vertex { nearer, nearer_gap, farther_gap, tangent: parabola_tangent(curve, k, (a, gap_a), (b, gap_b)) }
        }
        (a, b) => {
            let nearer = a.or(b).unwrap_or(k);
            let nearer_gap = curve.distance(k, nearer);
            let farther_gap = beyond_ends[usize::from(b.is_none())].max(nearer_gap);
            Vertex { nearer, nearer_gap, farther_gap, tangent: None }
        }
    }
}

/// Unit velocity at position k of the parabola through k and its neighbours: second-order accurate for uneven gaps too.
fn parabola_tangent<M: Manifold>(
    curve: &Curve<M>,
    k: usize,
    (a, gap_a): (usize, f64),
    (b, gap_b): (usize, f64),
) -> Option<M::Tangent> {
    let velocity = curve.log(k, b)? * (gap_a / gap_b) - curve.log(k, a)? * (gap_b / gap_a);
    let speed = curve.manifold.norm(curve.point(k), velocity);
    (speed > 0.0).then(|| velocity * (1.0 / speed))
}

/// `None` where `other` lies on the tangent up to rounding, or on the cut locus, which is farther than any reach that matters.
fn ball_radius<M: Manifold>(curve: &Curve<M>, tangent: M::Tangent, at: usize, other: usize) -> Option<f64> {
    let (manifold, p) = (curve.manifold, curve.point(at));
    let v = curve.log(at, other)?;
    let length = manifold.norm(p, v);
    let normal = manifold.norm(p, v - tangent * manifold.inner(p, v, tangent));
    (normal > 8.0 * f64::EPSILON * length).then(|| length * length / (2.0 * normal))
}

fn disputes<M: Manifold>(
    curve: &Curve<M>,
    vertex: &Vertex<M::Tangent>,
    at: usize,
    other: usize,
    distance: f64,
) -> bool {
    distance < vertex.nearer_gap || curve.cosine(at, vertex.nearer, other).is_none_or(|cosine| cosine < 0.0)
}
