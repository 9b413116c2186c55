//! Flat space.

use nalgebra::SVector;

use crate::embedding::Embedding;
use crate::manifold::{LogError, Manifold, if_finite};

/// ℝᴺ with the ordinary distance: the flat space that the others are compared with (thesis §4.1).
///
/// | | |
/// | --- | --- |
/// | points, tangents | vectors, in the unit of the data |
/// | metric | ⟨u, v⟩ = uᵀv |
/// | exp, log | exp(p, v) = p + v, log(p, q) = q − p, everywhere |
/// | distance | ‖q − p‖, in the unit of the data |
/// | transport | v itself |
/// | injectivity radius | infinite: every two points have a `log` |
///
/// ```
/// use se3_geom::{Manifold, R3, nalgebra::Vector3};
/// let (p, q) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(1.0, 3.0, 4.0));
/// assert_eq!(R3::default().distance(&p, &q), 5.0);
/// assert_eq!(R3::default().geodesic(&p, &q, 0.5), Ok(Vector3::new(1.0, 1.5, 2.0)));
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Euclidean<const N: usize>;

/// The plane.
pub type R2 = Euclidean<2>;
/// Space.
pub type R3 = Euclidean<3>;

impl<const N: usize> Manifold for Euclidean<N> {
    type Point = SVector<f64, N>;
    type Tangent = SVector<f64, N>;

    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point {
        p + v
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError> {
        let difference = q - p;
        if_finite(difference, &difference)
    }
    fn inner(&self, _: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64 {
        u.dot(&v)
    }
    fn transport(&self, _: &Self::Point, _: Self::Tangent, v: Self::Tangent) -> Self::Tangent {
        v
    }
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        (q - p).norm()
    }
    fn injectivity_radius(&self) -> f64 {
        f64::INFINITY
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        p.iter().all(|x| x.is_finite())
    }
    fn embedding(&self) -> Option<Embedding> {
        Some(Embedding::flat(N, 1.0))
    }
    fn embed(&self, p: &Self::Point, coordinates: &mut [f64]) {
        coordinates[..N].copy_from_slice(p.as_slice());
    }
}
