//! Spaces given by equations.

use nalgebra::{SMatrix, SVector, Vector1, Vector4};

use crate::geodesic_flow::{Connection, flow};
use crate::geodesic_search::{shortest_distance, shortest_geodesic};
use crate::manifold::{LogError, Manifold};

/// K equations F(x) = 0 in ℝᴺ with their first and second derivatives; DF must have rank K on the level set.
///
/// ```
/// use se3_geom::{Constraint, LevelSet, Manifold, nalgebra::{RowVector2, Vector1, Vector2}};
/// /// x² + 4y² = 1.
/// struct Ellipse;
/// impl Constraint<2, 1> for Ellipse {
///     fn value(&self, x: &Vector2<f64>) -> Vector1<f64> {
///         Vector1::new(x.x * x.x + 4.0 * x.y * x.y - 1.0)
///     }
///     fn jacobian(&self, x: &Vector2<f64>) -> RowVector2<f64> {
///         RowVector2::new(2.0 * x.x, 8.0 * x.y)
///     }
///     fn second_derivative(&self, _: &Vector2<f64>, u: &Vector2<f64>, v: &Vector2<f64>) -> Vector1<f64> {
///         Vector1::new(2.0 * u.x * v.x + 8.0 * u.y * v.y)
///     }
/// }
/// let ellipse = LevelSet::new(Ellipse, 0.0); // no radius of injectivity is claimed
/// let (vertex, co_vertex) = (Vector2::new(1.0, 0.0), Vector2::new(0.0, 0.5));
/// let quarter = 1.211_056_027_568_459_5; // E(3/4), the complete elliptic integral
/// assert!((ellipse.exp(&vertex, Vector2::new(0.0, quarter)) - co_vertex).norm() < 1e-10);
/// ```
pub trait Constraint<const N: usize, const K: usize>: Sync {
    /// F(x).
    fn value(&self, x: &SVector<f64, N>) -> SVector<f64, K>;
    /// DF(x).
    fn jacobian(&self, x: &SVector<f64, N>) -> SMatrix<f64, K, N>;
    /// D²F(x)(u, v), one bilinear form an equation.
    fn second_derivative(&self, x: &SVector<f64, N>, u: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, K>;
}

/// The level set F⁻¹(0) ⊂ ℝᴺ with the metric of the surrounding space (thesis §4.4).
///
/// With D = DF(x):
///
/// | | |
/// | --- | --- |
/// | points | vectors x with F(x) = 0; [`project`](Self::project) makes them |
/// | tangents at x | vectors v with D·v = 0; [`project_tangent`](Self::project_tangent) makes them |
/// | metric | ⟨u, v⟩ = uᵀv |
/// | exp | ẍ = −Dᵀ(DDᵀ)⁻¹·D²F(ẋ, ẋ): no acceleration along the set (thesis §4.4) |
/// | log | its boundary-value problem, solved by shooting; beyond the injectivity radius the shortest geodesic **found** |
/// | distance | length of the logarithm, so beyond the injectivity radius an upper bound; NaN where none was found |
/// | transport | ẇ = −Dᵀ(DDᵀ)⁻¹·D²F(ẋ, w) |
/// | injectivity radius | the lower bound that the caller states |
///
/// Geodesics are integrated to a relative error of 1e-13 a step, and each step is projected back onto the set. `log` works as on
/// [`MongePatch`](crate::MongePatch): beyond the injectivity radius it is the shortest geodesic found, not a proven minimum, and
/// [`LogError::NotFound`] where there was none. A point off the set is taken for the start of geodesics all the same.
///
/// ```
/// use se3_geom::{LevelSet, Manifold, nalgebra::Vector4};
/// // Example 4.4: a rod of unit length from (0, 0) to (1, 0). Its ends move apart sideways: it turns about its middle.
/// let rods = LevelSet::unit_segments();
/// let turned = rods.exp(&Vector4::new(0.0, 0.0, 1.0, 0.0), Vector4::new(0.0, -1.0, 0.0, 1.0) * 0.25 * std::f64::consts::PI);
/// assert!((turned - Vector4::new(0.5, -0.5, 0.5, 0.5)).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct LevelSet<C, const N: usize, const K: usize> {
    constraint: C,
    injectivity_radius: f64,
}

/// F(x₁, x₂, y₁, y₂) = ‖y − x‖² − 1: segments of unit length in the plane, by their ends (Example 4.4).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct UnitSegments;

impl Constraint<4, 1> for UnitSegments {
    fn value(&self, x: &Vector4<f64>) -> Vector1<f64> {
        let (dx, dy) = (x[2] - x[0], x[3] - x[1]);
        Vector1::new(dx * dx + dy * dy - 1.0)
    }
    fn jacobian(&self, x: &Vector4<f64>) -> SMatrix<f64, 1, 4> {
        let (dx, dy) = (x[2] - x[0], x[3] - x[1]);
        SMatrix::<f64, 1, 4>::new(-dx, -dy, dx, dy) * 2.0
    }
    fn second_derivative(&self, _: &Vector4<f64>, u: &Vector4<f64>, v: &Vector4<f64>) -> Vector1<f64> {
        Vector1::new(2.0 * ((u[2] - u[0]) * (v[2] - v[0]) + (u[3] - u[1]) * (v[3] - v[1])))
    }
}

impl LevelSet<UnitSegments, 4, 1> {
    /// The unit segments of the plane: translations of the middle, and turns with ½θ̇² in the metric. Half a turn, π/√2, is the
    /// injectivity radius.
    pub fn unit_segments() -> Self {
        Self::new(UnitSegments, std::f64::consts::PI * std::f64::consts::FRAC_1_SQRT_2)
    }
}

impl<C: Constraint<N, K>, const N: usize, const K: usize> LevelSet<C, N, K> {
    /// The level set with a lower bound of its injectivity radius.
    ///
    /// π/κ is one for a closed set, with κ the greatest curvature that a geodesic has in ℝᴺ, max ‖Dᵀ(DDᵀ)⁻¹·D²F(v, v)‖ over unit
    /// tangents v: see [`MongePatch::new`](crate::MongePatch::new). Zero claims nothing.
    pub fn new(constraint: C, injectivity_radius: f64) -> Self {
        Self { constraint, injectivity_radius }
    }

    /// The point of the set that Newton's method reaches from x along the normals; `None` where it does not settle or DF loses
    /// rank.
    pub fn project(&self, x: &SVector<f64, N>) -> Option<SVector<f64, N>> {
        let mut x = *x;
        let mut last_step = f64::INFINITY;
        for _ in 0..MOST_PROJECTION_STEPS {
            let correction = self.normal_lift(&x, &self.constraint.value(&x))?;
            x -= correction;
            let step = correction.norm();
            if !step.is_finite() {
                return None;
            }
            // Quadratic convergence: a step at rounding, or one that shrinks no more, is the last.
            if step <= f64::EPSILON * x.norm() || (step < 1e-12 * x.norm() && step >= 0.5 * last_step) {
                return Some(x);
            }
            last_step = step;
        }
        None
    }

    /// The orthogonal projection of v onto the tangent space at x, (I − Dᵀ(DDᵀ)⁻¹D)·v. NaN where DF loses rank.
    pub fn project_tangent(&self, x: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N> {
        let normal_part = self.normal_lift(x, &(self.constraint.jacobian(x) * v));
        normal_part.map_or(SVector::repeat(f64::NAN), |normal| v - normal)
    }

    /// The shortest vector n with DF·n = c: Dᵀ(DDᵀ)⁻¹c.
    fn normal_lift(&self, x: &SVector<f64, N>, c: &SVector<f64, K>) -> Option<SVector<f64, N>> {
        let jacobian = self.constraint.jacobian(x);
        let gram = (jacobian * jacobian.transpose()).cholesky()?;
        Some(jacobian.transpose() * gram.solve(c))
    }
}

const MOST_PROJECTION_STEPS: usize = 30;

impl<C: Constraint<N, K>, const N: usize, const K: usize> Connection<N> for LevelSet<C, N, K> {
    fn parallel_rate(&self, x: &SVector<f64, N>, u: &SVector<f64, N>, w: &SVector<f64, N>) -> SVector<f64, N> {
        let bending = self.normal_lift(x, &self.constraint.second_derivative(x, u, w));
        bending.map_or(SVector::repeat(f64::NAN), |normal| -normal)
    }
    fn metric(&self, _: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        SMatrix::identity()
    }
    fn project(&self, x: &SVector<f64, N>) -> Option<SVector<f64, N>> {
        self.project(x)
    }
    fn project_tangent(&self, x: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N> {
        self.project_tangent(x, v)
    }
}

impl<C: Constraint<N, K>, const N: usize, const K: usize> Manifold for LevelSet<C, N, K> {
    type Point = SVector<f64, N>;
    type Tangent = SVector<f64, N>;

    fn exp(&self, p: &Self::Point, v: Self::Tangent) -> Self::Point {
        flow(self, [*p, v]).map_or(SVector::repeat(f64::NAN), |[end, _]| end)
    }
    fn log(&self, p: &Self::Point, q: &Self::Point) -> Result<Self::Tangent, LogError> {
        shortest_geodesic(self, p, q, self.injectivity_radius)
    }
    fn inner(&self, _: &Self::Point, u: Self::Tangent, v: Self::Tangent) -> f64 {
        u.dot(&v)
    }
    fn transport(&self, p: &Self::Point, along: Self::Tangent, v: Self::Tangent) -> Self::Tangent {
        flow(self, [*p, along, v]).map_or(SVector::repeat(f64::NAN), |[_, _, carried]| carried)
    }
    /// As on [`MongePatch`](crate::MongePatch): exactly symmetric, an upper bound beyond the injectivity radius, NaN where no
    /// geodesic was found.
    fn distance(&self, p: &Self::Point, q: &Self::Point) -> f64 {
        shortest_distance(self, p, q, self.injectivity_radius)
    }
    /// The lower bound given to [`LevelSet::new`].
    fn injectivity_radius(&self) -> f64 {
        self.injectivity_radius
    }
    fn is_finite(&self, p: &Self::Point) -> bool {
        p.iter().all(|x| x.is_finite())
    }
}
