//! Length, curvature, and the parameter that is the length.

use super::{Curve, Derivatives};
use crate::manifold::Manifold;

/// Two ways of integrating a piece agree to this part of the whole length before either is believed.
const TOLERANCE: f64 = 1e-13;
/// Half of a piece, halved this often again, is no longer told apart from a point.
const HALVINGS: u32 = 48;
/// The part of the mean speed below which a curve stands still.
const STANDSTILL: f64 = 1e-6;

/// A curve whose length was not measured, or along which it is no parameter.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ArcLengthError {
    /// The speed is not finite somewhere, or varies without end.
    #[error("the length of the curve does not converge near parameter {parameter}")]
    NotConverged {
        /// Where.
        parameter: f64,
    },
    /// The curve stands still, so that its parameter has no derivative by its length.
    #[error("the curve stands still at parameter {parameter} (speed {speed:.1e}): it has no parameter by arc length")]
    Standstill {
        /// Where.
        parameter: f64,
        /// The speed there.
        speed: f64,
    },
}

/// A curve run through at unit speed: its parameter is the length s = ∫‖ċ‖dt from its start, under a given metric.
///
/// ```
/// use se3_geom::{nalgebra::Vector2, ByArcLength, CubicEnds, CubicSpline, Curve, R2};
/// let corners = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(Vector2::from);
/// let ring = CubicSpline::through(&corners, &[0.0, 1.0, 2.0, 3.0, 4.0], CubicEnds::Periodic)?;
/// let ring = ByArcLength::new(ring, R2::default())?;
/// let (_, length) = ring.domain();
/// assert!((ring.point(0.5 * length) - corners[2]).norm() < 1e-12);
/// assert!((ring.derivatives(0.3).velocity.norm() - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ByArcLength<C, M> {
    curve: C,
    metric: M,
    /// Parameter of the curve and length up to there, so close that eight points integrate between two of them.
    nodes: Vec<(f64, f64)>,
}

/// The length ∫‖ċ‖dt of a curve under a metric.
///
/// # Errors
/// [`ArcLengthError::NotConverged`].
pub fn arc_length<C, M>(curve: &C, metric: &M) -> Result<f64, ArcLengthError>
where
    C: Curve<Point = M::Point, Tangent = M::Tangent>,
    M: Manifold,
{
    Ok(measure(curve, metric)?.last().map_or(0.0, |(_, length)| *length))
}

/// κ = ‖a⊥‖/‖v‖², a⊥ the part of the acceleration across the velocity; `None` at standstill. Does not depend on the
/// parameterisation.
pub fn curvature<M: Manifold>(metric: &M, at: &Derivatives<M::Point, M::Tangent>) -> Option<f64> {
    let (p, v, a) = (&at.point, at.velocity, at.acceleration);
    let squared_speed = metric.inner(p, v, v);
    let across = a - v * (metric.inner(p, a, v) / squared_speed);
    let curvature = metric.norm(p, across) / squared_speed;
    curvature.is_finite().then_some(curvature)
}

impl<C, M> ByArcLength<C, M>
where
    C: Curve<Point = M::Point, Tangent = M::Tangent>,
    M: Manifold,
{
    /// The curve with its length as parameter.
    ///
    /// # Errors
    /// [`ArcLengthError`], also where the least speed, between the nodes of quadrature too, is below a millionth of its mean.
    pub fn new(curve: C, metric: M) -> Result<Self, ArcLengthError> {
        let nodes = measure(&curve, &metric)?;
        let (first, last) = curve.domain();
        let length = nodes.last().map_or(0.0, |(_, length)| *length);
        for piece in nodes.windows(2) {
            let (parameter, speed) = slowest(&curve, &metric, piece[0].0, piece[1].0);
            let moves = speed > STANDSTILL * length / (last - first);
            if !moves {
                return Err(ArcLengthError::Standstill { parameter, speed });
            }
        }
        Ok(Self { curve, metric, nodes })
    }

    /// The curve's own parameter at length `s`, to rounding.
    pub fn parameter_at(&self, s: f64) -> f64 {
        let s = s.clamp(0.0, self.domain().1);
        let piece = self.nodes.partition_point(|(_, length)| *length <= s).clamp(1, self.nodes.len() - 1) - 1;
        let ((from, before), (to, after)) = (self.nodes[piece], self.nodes[piece + 1]);
        let (mut low, mut high) = (from, to);
        let mut t = from + (to - from) * (s - before) / (after - before);
        // Newton, which the bracket keeps from leaving; the speed hardly varies within a piece.
        for _ in 0..60 {
            let missing = s - before - gauss(from, t, |t| speed(&self.curve, &self.metric, t));
            if missing > 0.0 {
                low = t
            } else {
                high = t
            }
            let next = t + missing / speed(&self.curve, &self.metric, t);
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            let moved = (next - t).abs();
            t = next;
            if moved <= 2.0 * f64::EPSILON * t.abs().max(to - from) {
                break;
            }
        }
        t
    }
}

impl<C, M> Curve for ByArcLength<C, M>
where
    C: Curve<Point = M::Point, Tangent = M::Tangent>,
    M: Manifold,
{
    type Point = M::Point;
    type Tangent = M::Tangent;

    /// From 0 to the length of the curve. Also a closed curve ends there.
    fn domain(&self) -> (f64, f64) {
        (0.0, self.nodes[self.nodes.len() - 1].1)
    }
    /// With σ = ‖ċ‖: dt/ds = 1/σ, d²t/ds² = −σ̇/σ³, d³t/ds³ = (3σ̇² − σσ̈)/σ⁵, and the chain rule.
    fn derivatives(&self, s: f64) -> Derivatives<M::Point, M::Tangent> {
        let Derivatives { point, velocity: v, acceleration: a, jerk: j } = self.curve.derivatives(self.parameter_at(s));
        let inner = |x, y| self.metric.inner(&point, x, y);
        let speed = inner(v, v).sqrt();
        let speed_dot = inner(a, v) / speed;
        let speed_ddot = (inner(j, v) + inner(a, a) - speed_dot * speed_dot) / speed;
        let first = 1.0 / speed;
        let second = -speed_dot * first.powi(3);
        let third = (3.0 * speed_dot * speed_dot - speed * speed_ddot) * first.powi(5);
        Derivatives {
            velocity: v * first,
            acceleration: a * (first * first) + v * second,
            jerk: j * first.powi(3) + a * (3.0 * first * second) + v * third,
            point,
        }
    }
    fn point(&self, s: f64) -> M::Point {
        self.curve.point(self.parameter_at(s))
    }
    fn knots(&self) -> Vec<f64> {
        let of = |knot: f64| self.nodes.iter().find(|(t, _)| *t == knot).map(|(_, s)| *s);
        self.curve.knots().into_iter().filter_map(of).collect()
    }
}

fn speed<C, M>(curve: &C, metric: &M, t: f64) -> f64
where
    C: Curve<Point = M::Point, Tangent = M::Tangent>,
    M: Manifold,
{
    let at = curve.derivatives(t);
    metric.norm(&at.point, at.velocity)
}

/// Where the speed is least on a piece that eight points integrate, and how small it is there.
///
/// d‖ċ‖²/dt = 2⟨ċ, c̈⟩. On such a piece the speed is all but a polynomial of degree 15, which has seven minima at most: each of
/// sixteen parts is searched for a slope that goes from falling to rising, and that is bisected to rounding.
fn slowest<C, M>(curve: &C, metric: &M, from: f64, to: f64) -> (f64, f64)
where
    C: Curve<Point = M::Point, Tangent = M::Tangent>,
    M: Manifold,
{
    const PARTS: u32 = 16;
    let falls = |t: f64| {
        let at = curve.derivatives(t);
        metric.inner(&at.point, at.velocity, at.acceleration) < 0.0
    };
    // The last parameter before the end, where the derivatives are still those of this piece.
    let place = |k: u32| (from + (to - from) * f64::from(k) / f64::from(PARTS)).min(to.next_down());
    let minimum = |k: u32| {
        let (mut low, mut high) = (place(k), place(k + 1));
        let comes_to_a_minimum = falls(low) && !falls(high);
        if !comes_to_a_minimum {
            return low;
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return low;
            }
            if falls(middle) { low = middle } else { high = middle }
        }
    };
    let candidates = (0..PARTS).map(minimum).chain([to]);
    // Not by `min`, which drops what is not a number.
    candidates
        .map(|t| (t, speed(curve, metric, t)))
        .fold((from, f64::INFINITY), |least, found| if found.1 >= least.1 { least } else { found })
}

/// Halves the pieces of the curve until eight points integrate each, and adds up.
fn measure<C, M>(curve: &C, metric: &M) -> Result<Vec<(f64, f64)>, ArcLengthError>
where
    C: Curve<Point = M::Point, Tangent = M::Tangent>,
    M: Manifold,
{
    let integrate = |from, to| gauss(from, to, |t| speed(curve, metric, t));
    let knots = curve.knots();
    let pieces = || knots.windows(2).map(|k| (k[0], k[1]));
    let rough: f64 = pieces().map(|(from, to)| integrate(from, to)).sum();
    let mut nodes = vec![(curve.domain().0, 0.0)];
    let mut length = 0.0;
    let mut left: Vec<_> = pieces().map(|(from, to)| (from, to, integrate(from, to), HALVINGS)).collect();
    left.reverse();
    while let Some((from, to, whole, halvings)) = left.pop() {
        let middle = 0.5 * (from + to);
        let (first, second) = (integrate(from, middle), integrate(middle, to));
        if (first + second - whole).abs() <= TOLERANCE * rough {
            length += first;
            nodes.push((middle, length));
            length += second;
            nodes.push((to, length));
        } else if halvings == 0 || !whole.is_finite() {
            return Err(ArcLengthError::NotConverged { parameter: middle });
        } else {
            left.push((middle, to, second, halvings - 1));
            left.push((from, middle, first, halvings - 1));
        }
    }
    Ok(nodes)
}

/// Gauss–Legendre quadrature with eight points: exact for polynomials up to degree 15, and never at the ends, where a knot's
/// derivatives are those of the next piece.
fn gauss(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    half * NODES.iter().map(|(x, w)| w * (f(middle - half * x) + f(middle + half * x))).sum::<f64>()
}
