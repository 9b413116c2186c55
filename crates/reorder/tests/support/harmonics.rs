//! Smooth curves of three harmonics in several spaces, with their true reach, and samples of them in true order.

use std::f64::consts::TAU;

use se3_geom::nalgebra::{Isometry3, SVector, UnitQuaternion, Vector2, Vector3};
use se3_geom::{Manifold, Pose, R2, R3, Se3, Sphere, Twist};

use super::Random;

/// Points of the grid on which length and reach are measured. The reach of a curve of three harmonics changes by less than
/// 1 % when the grid is twice as fine.
const GRID: usize = 480;

/// f(t) = Σₖ (aₖ cos kt + bₖ sin kt)/k, k = 1, 2, 3, coefficients uniform in [-1, 1).
#[derive(Debug, Clone)]
pub(crate) struct Harmonics([[f64; 2]; 3]);

impl Harmonics {
    pub(crate) fn random(random: &mut Random) -> Self {
        Self(std::array::from_fn(|_| [random.signed(), random.signed()]))
    }
    pub(crate) fn at(&self, t: f64) -> f64 {
        let term = |(k, [a, b]): (f64, &[f64; 2])| (a * (k * t).cos() + b * (k * t).sin()) / k;
        [1.0, 2.0, 3.0].into_iter().zip(&self.0).map(term).sum()
    }
}

/// How the samples lie along the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Spacing {
    /// Independent and uniform over the length: gaps from nearly nothing to ln n times their mean.
    Iid,
    /// All the same length apart.
    Even,
    /// Even, each moved by up to this share of the spacing.
    Jittered(f64),
}

/// A curve by its length, with its reach.
pub(crate) struct Measured<M: Manifold> {
    pub(crate) manifold: M,
    at: Box<dyn Fn(f64) -> M::Point>,
    pub(crate) closed: bool,
    /// Length of the curve up to each point of the grid.
    lengths: Vec<f64>,
    /// min over pairs of ‖v‖²/(2‖v⊥‖), v = log_p(q), with tangents from central differences.
    pub(crate) reach: f64,
    span: f64,
}

impl<M: Manifold> Measured<M> {
    /// A curve over t in [0, 2π).
    pub(crate) fn closed(manifold: M, at: impl Fn(f64) -> M::Point + 'static) -> Self {
        Self::over(manifold, Box::new(at), true, TAU)
    }
    /// The part of a curve over t in [0, span].
    pub(crate) fn open(manifold: M, at: impl Fn(f64) -> M::Point + 'static, span: f64) -> Self {
        Self::over(manifold, Box::new(at), false, span)
    }
    fn over(manifold: M, at: Box<dyn Fn(f64) -> M::Point>, closed: bool, span: f64) -> Self {
        let step = span / GRID as f64;
        let points: Vec<_> = (0..=GRID).map(|k| at(step * k as f64)).collect();
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + manifold.distance(&pair[0], &pair[1]));
        }
        let tangents: Vec<_> = (0..=GRID).map(|k| tangent(&manifold, &at, step * k as f64, 0.1 * step)).collect();
        let reach = federer_reach(&manifold, &points, &tangents);
        Self { manifold, at, closed, lengths, reach, span }
    }
    pub(crate) fn length(&self) -> f64 {
        self.lengths[GRID]
    }
    /// The point after the given length.
    pub(crate) fn after(&self, length: f64) -> M::Point {
        let cell = self.lengths.partition_point(|&l| l <= length).clamp(1, GRID) - 1;
        let share = (length - self.lengths[cell]) / (self.lengths[cell + 1] - self.lengths[cell]);
        (self.at)(self.span * (cell as f64 + share) / GRID as f64)
    }
    /// n samples in true order.
    pub(crate) fn sample(&self, random: &mut Random, n: usize, spacing: Spacing) -> Vec<M::Point> {
        let slots = if self.closed { n } else { n - 1 } as f64;
        let even = self.length() / slots;
        let mut lengths: Vec<f64> = (0..n)
            .map(|k| match spacing {
                Spacing::Iid => self.length() * 0.5 * (1.0 + random.signed()),
                Spacing::Even => even * k as f64,
                Spacing::Jittered(share) => (even * (k as f64 + share * random.signed())).clamp(
                    if self.closed { f64::NEG_INFINITY } else { 0.0 },
                    if self.closed { f64::INFINITY } else { self.length() },
                ),
            })
            .map(|length| if self.closed { length.rem_euclid(self.length()) } else { length })
            .collect();
        lengths.sort_by(f64::total_cmp);
        lengths.into_iter().map(|length| self.after(length)).collect()
    }
    /// How many samples bring ε̂ about to what is wanted: the greatest of n independent gaps is about (ln n + 0.58) times their mean.
    pub(crate) fn count_for(&self, epsilon: f64, spacing: Spacing) -> usize {
        let greatest = |n: f64| match spacing {
            Spacing::Iid => n.ln() + 0.58,
            Spacing::Even => 1.0,
            Spacing::Jittered(share) => 1.0 + 1.8 * share,
        };
        let wanted = 2.0 * epsilon * self.reach / self.length();
        let enough = |n: &usize| greatest(*n as f64) / *n as f64 <= wanted;
        // Ratio 1.02: finer than the scatter of the greatest gap.
        let counts = std::iter::successors(Some(8), |&n: &usize| Some((n + n / 50).max(n + 1)));
        counts.take_while(|&n| n < 100_000).find(enough).unwrap_or(100_000)
    }
    /// ε̂ = half the greatest gap between samples in true order, in units of the true reach.
    pub(crate) fn epsilon(&self, samples: &[M::Point]) -> f64 {
        let closing = self.closed.then(|| (samples.len() - 1, 0));
        let gaps = (1..samples.len()).map(|k| (k - 1, k)).chain(closing);
        0.5 * gaps.map(|(a, b)| self.manifold.distance(&samples[a], &samples[b])).fold(0.0, f64::max) / self.reach
    }
    pub(crate) fn mean_gap(&self, n: usize) -> f64 {
        self.length() / n as f64
    }
}

/// Unit velocity by a central difference over ±h.
fn tangent<M: Manifold>(manifold: &M, at: &dyn Fn(f64) -> M::Point, t: f64, h: f64) -> M::Tangent {
    let p = at(t);
    let to = |s: f64| manifold.log(&p, &at(s)).expect("a short step has a logarithm");
    let velocity = to(t + h) - to(t - h);
    velocity * (1.0 / manifold.norm(&p, velocity))
}

fn federer_reach<M: Manifold>(manifold: &M, points: &[M::Point], tangents: &[M::Tangent]) -> f64 {
    let mut reach = f64::INFINITY;
    for gap in 1..points.len() {
        for i in 0..points.len() - gap {
            // A ball through two points is at least half their distance in radius.
            if manifold.distance(&points[i], &points[i + gap]) >= 2.0 * reach {
                continue;
            }
            for (at, other) in [(i, i + gap), (i + gap, i)] {
                let (p, u) = (&points[at], tangents[at]);
                let Ok(v) = manifold.log(p, &points[other]) else { continue };
                let normal = manifold.norm(p, v - u * manifold.inner(p, v, u));
                // First and last point of a closed curve coincide up to rounding.
                if normal > 1e-9 {
                    reach = reach.min(manifold.inner(p, v, v) / (2.0 * normal));
                }
            }
        }
    }
    reach
}

/// Closed in SE(3), one radian counting as `metres_per_radian`: three harmonics in every coordinate of position and of the
/// rotation vector.
pub(crate) fn pose_curve(random: &mut Random) -> impl Fn(f64) -> Pose + use<> {
    let h: [Harmonics; 6] = std::array::from_fn(|_| Harmonics::random(random));
    move |t| {
        let [x, y, z, a, b, c] = std::array::from_fn(|i| h[i].at(t));
        Isometry3::from_parts(Vector3::new(x, y, z).into(), UnitQuaternion::from_scaled_axis(Vector3::new(a, b, c)))
    }
}

/// Closed in space.
pub(crate) fn space_curve(random: &mut Random) -> impl Fn(f64) -> Vector3<f64> + use<> {
    let h: [Harmonics; 3] = std::array::from_fn(|_| Harmonics::random(random));
    move |t| Vector3::from_fn(|i, _| h[i].at(t))
}

/// Closed in the plane, and as a rule crossing itself.
pub(crate) fn crossing_curve(random: &mut Random) -> impl Fn(f64) -> Vector2<f64> + use<> {
    let h: [Harmonics; 2] = std::array::from_fn(|_| Harmonics::random(random));
    move |t| Vector2::from_fn(|i, _| h[i].at(t))
}

/// Closed and simple in the plane: a circle whose radius has three harmonics on a logarithmic scale.
pub(crate) fn plane_curve(random: &mut Random) -> impl Fn(f64) -> Vector2<f64> + use<> {
    let h = Harmonics::random(random);
    move |t| Vector2::new(t.cos(), t.sin()) * (0.5 * h.at(t)).exp()
}

/// Closed and simple on the unit sphere: the equator with three harmonics in its latitude.
pub(crate) fn sphere_curve(random: &mut Random) -> impl Fn(f64) -> Vector3<f64> + use<> {
    let h = Harmonics::random(random);
    move |t| Vector3::new(t.cos(), t.sin(), 0.6 * h.at(t)).normalize()
}

/// Tangents from as many independent numbers as the space has dimensions, so that numbers of mean square s² give a
/// tangent of mean square length dimension·s².
pub(crate) trait Isotropic: Manifold {
    const DIMENSION: usize;
    fn tangent_of(&self, at: &Self::Point, x: [f64; 6]) -> Self::Tangent;
}
impl Isotropic for R2 {
    const DIMENSION: usize = 2;
    fn tangent_of(&self, _: &Vector2<f64>, x: [f64; 6]) -> Vector2<f64> {
        SVector::from_fn(|i, _| x[i])
    }
}
impl Isotropic for R3 {
    const DIMENSION: usize = 3;
    fn tangent_of(&self, _: &Vector3<f64>, x: [f64; 6]) -> Vector3<f64> {
        SVector::from_fn(|i, _| x[i])
    }
}
impl Isotropic for Sphere {
    const DIMENSION: usize = 2;
    fn tangent_of(&self, at: &Vector3<f64>, x: [f64; 6]) -> Vector3<f64> {
        let aside = if at.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let u = at.cross(&aside).normalize();
        u * x[0] + at.cross(&u) * x[1]
    }
}
impl Isotropic for Se3 {
    const DIMENSION: usize = 6;
    fn tangent_of(&self, _: &Pose, x: [f64; 6]) -> Twist {
        let linear = Vector3::new(x[0], x[1], x[2]);
        Twist { linear, angular: Vector3::new(x[3], x[4], x[5]) / self.metres_per_radian() }
    }
}

/// Every point moved independently by Gaussian noise of the given total root mean square.
pub(crate) fn with_noise<M: Isotropic>(
    manifold: &M,
    random: &mut Random,
    points: &[M::Point],
    rms: f64,
) -> Vec<M::Point> {
    let each = rms / (M::DIMENSION as f64).sqrt();
    let moved = |p: &M::Point| manifold.exp(p, manifold.tangent_of(p, std::array::from_fn(|_| each * random.gauss())));
    points.iter().map(moved).collect()
}
