//! Surfaces that are graphs of a function.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};

use crate::geodesic_flow::{Connection, flow};
use crate::geodesic_search::{shortest_distance, shortest_geodesic};
use crate::manifold::{LogError, Manifold};

/// A height with its first and second derivatives at one point of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightJet {
    /// h(x, y).
    pub height: f64,
    /// (h_x, h_y).
    pub gradient: Vector2<f64>,
    /// \[h_xx, h_xy; h_xy, h_yy\].
    pub hessian: Matrix2<f64>,
}

/// The Monge patch z = h(x, y) over the whole plane, with the metric of the surrounding space (thesis §4.2).
///
/// With ∇h and H the gradient and Hessian of h:
///
/// | | |
/// | --- | --- |
/// | points, tangents | (x, y) and (ẋ, ẏ), in the coordinates of the plane and the unit of the height |
/// | metric | g = I + ∇h∇hᵀ (eq. 4.2: E = 1 + h_x², F = h_x·h_y, G = 1 + h_y²) |
/// | Christoffel symbols | Γᵏᵢⱼ = h_k·h_ij/(1 + ‖∇h‖²) |
/// | exp | the geodesic ẍ = −∇h·(ẋᵀHẋ)/(1 + ‖∇h‖²) (eq. 3.9; eqs. 4.5–4.6 for h = xy), integrated |
/// | log | its boundary-value problem, solved by shooting (Examples 4.2 and 4.3); beyond the injectivity radius the shortest geodesic **found** |
/// | distance | length of the logarithm, so beyond the injectivity radius an upper bound; NaN where none was found |
/// | transport | ẇ = −∇h·(ẋᵀHw)/(1 + ‖∇h‖²) (eq. 3.8), integrated |
/// | injectivity radius | the lower bound that the caller states |
///
/// `exp` and `transport` integrate these equations to a relative error of 1e-13 a step. `log` shoots: Newton's method on the end
/// point, first from the straight line of the plane. A geodesic shorter than the injectivity radius is the shortest. Where none was
/// found, 21 straight, bowed and weaving paths are shortened (relaxation), shots follow each from both ends, and the shortest
/// geodesic of all is returned, from p to q and from q to p the same unless the last shot from one end fails: **beyond the
/// injectivity radius that is the best found, not a proven minimum**, and [`LogError::CutLocus`] says that two of those found are
/// equally long. To know which it is, compare
/// `norm(p, v)` with the radius. For a distance that cannot miss a valley, at first order in the grid, see
/// [`DistanceMap`](crate::DistanceMap). Geodesics over many hills may not be found at all (an error of 1e-16 grows
/// exponentially along them): [`LogError::NotFound`], and NaN as distance.
///
/// Where h or a derivative is not finite, results are NaN, which [`Manifold::is_finite`] sees.
///
/// ```
/// use se3_geom::{HeightJet, Manifold, MongePatch, nalgebra::{Matrix2, Vector2}};
/// // Example 4.2: the saddle z = xy, whose curvature is negative, so that every geodesic is a shortest one.
/// let saddle = MongePatch::new(
///     |x, y| HeightJet { height: x * y, gradient: Vector2::new(y, x), hessian: Matrix2::new(0.0, 1.0, 1.0, 0.0) },
///     f64::INFINITY,
/// );
/// let distance = saddle.distance(&Vector2::new(1.0, 1.0), &Vector2::new(-1.0, -1.0));
/// assert!((distance - (6f64.sqrt() + 2f64.sqrt().asinh())).abs() < 1e-12); // a piece of parabola
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MongePatch<H> {
    height: H,
    injectivity_radius: f64,
}

impl<H: Fn(f64, f64) -> HeightJet + Sync> MongePatch<H> {
    /// The graph of `height`, smooth on the whole plane, with a lower bound of its injectivity radius.
    ///
    /// π/κ is one, with κ the greatest absolute principal curvature (κ ≤ ‖H‖): conjugate points lie at least π/κ apart
    /// (Rauch), and by Schur's comparison a space curve of curvature ≤ κ, such as a geodesic of the surface, needs the length
    /// 2π/κ to come back to its start. Where det H ≤ 0 everywhere the radius is infinite (Cartan–Hadamard). Zero claims
    /// nothing: then every logarithm is searched from all starts.
    pub fn new(height: H, injectivity_radius: f64) -> Self {
        Self { height, injectivity_radius }
    }

    /// The point (x, y, h(x, y)) of space.
    pub fn embed(&self, p: &Vector2<f64>) -> Vector3<f64> {
        Vector3::new(p.x, p.y, (self.height)(p.x, p.y).height)
    }

    /// The velocity in space of a tangent at p.
    pub fn embed_tangent(&self, p: &Vector2<f64>, v: Vector2<f64>) -> Vector3<f64> {
        Vector3::new(v.x, v.y, (self.height)(p.x, p.y).gradient.dot(&v))
    }
}

impl<H: Fn(f64, f64) -> HeightJet + Sync> Connection<2> for MongePatch<H> {
    fn parallel_rate(&self, x: &Vector2<f64>, u: &Vector2<f64>, w: &Vector2<f64>) -> Vector2<f64> {
        let HeightJet { gradient, hessian, .. } = (self.height)(x.x, x.y);
        gradient * (-u.dot(&(hessian * w)) / (1.0 + gradient.norm_squared()))
    }
    fn metric(&self, x: &Vector2<f64>) -> SMatrix<f64, 2, 2> {
        let gradient = (self.height)(x.x, x.y).gradient;
        Matrix2::identity() + gradient * gradient.transpose()
    }
    fn project(&self, x: &Vector2<f64>) -> Option<Vector2<f64>> {
        Some(*x)
    }
    fn project_tangent(&self, _: &Vector2<f64>, v: &Vector2<f64>) -> Vector2<f64> {
        *v
    }
}

impl<H: Fn(f64, f64) -> HeightJet + Sync> Manifold for MongePatch<H> {
    type Point = Vector2<f64>;
    type Tangent = Vector2<f64>;

    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point {
        flow(self, [*p, v]).map_or(SVector::repeat(f64::NAN), |[end, _]| end)
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError> {
        if !(self.is_finite(p) && self.is_finite(q)) {
            return Err(LogError::NotAPoint);
        }
        shortest_geodesic(self, p, q, self.injectivity_radius)
    }
    fn inner(&self, p: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64 {
        let gradient = (self.height)(p.x, p.y).gradient;
        u.dot(&v) + gradient.dot(&u) * gradient.dot(&v)
    }
    fn transport(&self, p: &Self::Point, along: Self::Tangent, v: Self::Tangent) -> Self::Tangent {
        flow(self, [*p, along, v]).map_or(SVector::repeat(f64::NAN), |[_, _, carried]| carried)
    }
    /// The length of the logarithm, exactly symmetric. Beyond the injectivity radius an upper bound of the distance; NaN where no
    /// geodesic was found.
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        shortest_distance(self, p, q, self.injectivity_radius)
    }
    /// The lower bound given to [`MongePatch::new`].
    fn injectivity_radius(&self) -> f64 {
        self.injectivity_radius
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        self.embed(p).iter().all(|x| x.is_finite())
    }
}
