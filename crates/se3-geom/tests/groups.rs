//! One law suite for every Lie group, one line a group.
//!
//! It knows a group only by its matrices: products, exponentials, adjoints and Jacobians are judged against matrix products and
//! the power series of the matrix exponential, which share no formula with the code under test.
#![allow(clippy::unwrap_used)]

use nalgebra::{DMatrix, DVector, Matrix1, Matrix2, Matrix3, Matrix4, Vector2, Vector3, Vector6};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use se3_geom::{
    LieGroup, PlanarTwist, Se2Group, Se3Group, Sim2Group, SimilarityTwist, So2Group, So3Group, Twist, nalgebra,
};

/// The coordinates of a group: linear part first, then the angular part, then the scale.
trait Coordinates: LieGroup {
    const LINEAR: usize;
    const ANGULAR: usize;
    const SCALING: usize;
    const DIMENSION: usize = Self::LINEAR + Self::ANGULAR + Self::SCALING;
    fn algebra(v: &[f64]) -> Self::Algebra;
    fn coordinates(v: Self::Algebra) -> Vec<f64>;
    fn map(m: Self::AlgebraMap) -> DMatrix<f64>;
    /// The element as a matrix that acts on (x, 1), or on x where nothing translates.
    fn matrix(a: &Self::Element) -> DMatrix<f64>;
    fn point(x: &[f64]) -> Self::Point;
    fn point_coordinates(x: Self::Point) -> Vec<f64>;

    /// The matrix of an algebra element.
    fn hat(v: &[f64]) -> DMatrix<f64> {
        let (linear, rest) = v.split_at(Self::LINEAR);
        let (angular, scaling) = rest.split_at(Self::ANGULAR);
        let n = if Self::ANGULAR == 1 { 2 } else { 3 };
        let mut hat = DMatrix::zeros(n + linear.len().min(1), n + linear.len().min(1));
        if n == 2 {
            (hat[(0, 1)], hat[(1, 0)]) = (-angular[0], angular[0]);
        } else {
            (hat[(2, 1)], hat[(1, 2)]) = (angular[0], -angular[0]);
            (hat[(0, 2)], hat[(2, 0)]) = (angular[1], -angular[1]);
            (hat[(1, 0)], hat[(0, 1)]) = (angular[2], -angular[2]);
        }
        (0..n).for_each(|i| hat[(i, i)] = scaling.iter().sum());
        linear.iter().enumerate().for_each(|(i, x)| hat[(i, n)] = *x);
        hat
    }
}

fn dynamic<const R: usize, const C: usize>(m: nalgebra::SMatrix<f64, R, C>) -> DMatrix<f64> {
    DMatrix::from_column_slice(R, C, m.as_slice())
}

impl Coordinates for So2Group {
    const LINEAR: usize = 0;
    const ANGULAR: usize = 1;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> f64 {
        v[0]
    }
    fn coordinates(v: f64) -> Vec<f64> {
        vec![v]
    }
    fn map(m: f64) -> DMatrix<f64> {
        dynamic(Matrix1::new(m))
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(Matrix2::new(a.re, -a.im, a.im, a.re))
    }
    fn point(x: &[f64]) -> Vector2<f64> {
        Vector2::from_column_slice(&x[..2])
    }
    fn point_coordinates(x: Vector2<f64>) -> Vec<f64> {
        x.as_slice().to_vec()
    }
}

impl Coordinates for So3Group {
    const LINEAR: usize = 0;
    const ANGULAR: usize = 3;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(v)
    }
    fn coordinates(v: Vector3<f64>) -> Vec<f64> {
        v.as_slice().to_vec()
    }
    fn map(m: Matrix3<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_rotation_matrix().into_inner())
    }
    fn point(x: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(x)
    }
    fn point_coordinates(x: Vector3<f64>) -> Vec<f64> {
        x.as_slice().to_vec()
    }
}

impl Coordinates for Se2Group {
    const LINEAR: usize = 2;
    const ANGULAR: usize = 1;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> PlanarTwist {
        PlanarTwist::from_vector(&Vector3::from_column_slice(v))
    }
    fn coordinates(v: PlanarTwist) -> Vec<f64> {
        v.to_vector().as_slice().to_vec()
    }
    fn map(m: Matrix3<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_homogeneous())
    }
    fn point(x: &[f64]) -> Vector2<f64> {
        Vector2::from_column_slice(&x[..2])
    }
    fn point_coordinates(x: Vector2<f64>) -> Vec<f64> {
        vec![x.x, x.y, 1.0]
    }
}

impl Coordinates for Se3Group {
    const LINEAR: usize = 3;
    const ANGULAR: usize = 3;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> Twist {
        Twist::from_vector(&Vector6::from_column_slice(v))
    }
    fn coordinates(v: Twist) -> Vec<f64> {
        v.to_vector().as_slice().to_vec()
    }
    fn map(m: nalgebra::Matrix6<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_homogeneous())
    }
    fn point(x: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(x)
    }
    fn point_coordinates(x: Vector3<f64>) -> Vec<f64> {
        vec![x.x, x.y, x.z, 1.0]
    }
}

impl Coordinates for Sim2Group {
    const LINEAR: usize = 2;
    const ANGULAR: usize = 1;
    const SCALING: usize = 1;
    fn algebra(v: &[f64]) -> SimilarityTwist {
        SimilarityTwist::from_vector(&nalgebra::Vector4::from_column_slice(v))
    }
    fn coordinates(v: SimilarityTwist) -> Vec<f64> {
        v.to_vector().as_slice().to_vec()
    }
    fn map(m: Matrix4<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_homogeneous())
    }
    fn point(x: &[f64]) -> Vector2<f64> {
        Vector2::from_column_slice(&x[..2])
    }
    fn point_coordinates(x: Vector2<f64>) -> Vec<f64> {
        vec![x.x, x.y, 1.0]
    }
}

/// Scaling and squaring: ‖m/256‖ < 0.1, where 12 terms leave 0.1¹²/12! ≈ 2e-21, and eight squarings multiply roundings by 256.
fn matrix_exponential(m: &DMatrix<f64>) -> DMatrix<f64> {
    let small = m / 256.0;
    let mut sum = DMatrix::identity(m.nrows(), m.ncols());
    let mut term = sum.clone();
    for k in 1..=12 {
        term = &term * &small / f64::from(k);
        sum += &term;
    }
    (0..8).for_each(|_| sum = &sum * &sum);
    sum
}

/// Angles on both sides of every switch of branch, down to 1e-12 and up to just below π.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        (-12.0..0.3_f64).prop_map(|e| 10f64.powf(e)),
        (0.49..0.51_f64),
        (0.99..1.01_f64),
        (1.99..2.01_f64),
        (1e-12..1e-3_f64).prop_map(|gap| std::f64::consts::PI - gap),
    ]
}

/// Coordinates with linear entries below 2, a rotation vector of the angles above, and scales from e⁻¹·⁵ to e¹·⁵.
fn algebra<G: Coordinates>() -> impl Strategy<Value = Vec<f64>> {
    let direction = prop::array::uniform3(-1.0..1.0_f64)
        .prop_filter("no direction", |d| Vector3::from(*d)[0].abs() > 0.1)
        .prop_map(Vector3::from);
    (prop::array::uniform3(-2.0..2.0_f64), direction, angle(), -1.5..1.5_f64).prop_map(
        |(linear, direction, angle, scaling)| {
            let mut v = linear[..G::LINEAR].to_vec();
            let axis = direction.rows(0, G::ANGULAR).into_owned();
            v.extend((axis.normalize() * angle).iter());
            v.extend(std::iter::repeat_n(scaling, G::SCALING));
            v
        },
    )
}

fn gap(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    (a - b).norm()
}

/// Matrices of norm up to about 30, whose series exponential has multiplied roundings by 256: 30·256 ε. Every law that fails, fails
/// by the size of an entry somewhere in a thousand cases.
const TOLERANCE: f64 = 8e3 * f64::EPSILON;

fn group_laws<G: Coordinates>() {
    let config = Config { cases: 1000, rng_seed: RngSeed::Fixed(17), failure_persistence: None, ..Config::default() };
    let strategy = (algebra::<G>(), algebra::<G>(), prop::array::uniform3(-2.0..2.0_f64));
    TestRunner::new(config)
        .run(&strategy, |(u, v, x)| {
            let (a, b) = (G::exp(G::algebra(&u)), G::exp(G::algebra(&v)));
            let (ma, mb) = (G::matrix(&a), G::matrix(&b));
            let close = |what: &str, left: &DMatrix<f64>, right: &DMatrix<f64>| {
                assert!(gap(left, right) < TOLERANCE, "{what} at {u:?}, {v:?}: {left} {right}");
            };
            close("exp is the matrix exponential", &ma, &matrix_exponential(&G::hat(&u)));
            close("compose is the matrix product", &G::matrix(&G::compose(&a, &b)), &(&ma * &mb));
            let one = DMatrix::identity(ma.nrows(), ma.ncols());
            close("identity", &G::matrix(&G::identity()), &one);
            close("inverse", &(&ma * G::matrix(&G::inverse(&a))), &one);
            close("inverse is exp(−u)", &G::matrix(&G::inverse(&a)), &G::matrix(&G::exp(-G::algebra(&u))));

            let back = G::coordinates(G::log(&a).unwrap());
            assert!((DVector::from_vec(back) - DVector::from_vec(u.clone())).norm() < TOLERANCE, "log(exp) at {u:?}");

            let point = G::point_coordinates(G::act(&a, &G::point(&x)));
            let moved = &ma * DVector::from_vec(G::point_coordinates(G::point(&x)));
            assert!((DVector::from_vec(point) - moved).norm() < TOLERANCE, "action at {u:?}");

            let adjoint = G::map(G::adjoint(&a));
            let adjoined = &adjoint * DVector::from_vec(v.clone());
            close("adjoint", &(&ma * G::hat(&v)), &(G::hat(adjoined.as_slice()) * &ma));

            let [left, right] = [G::left_jacobian, G::right_jacobian].map(|j| G::map(j(G::algebra(&u))));
            let [left_inverse, right_inverse] =
                [G::left_jacobian_inverse, G::right_jacobian_inverse].map(|j| G::map(j(G::algebra(&u))));
            let one = DMatrix::identity(G::DIMENSION, G::DIMENSION);
            close("Jl·Jl⁻¹", &(&left * left_inverse), &one);
            close("Jr·Jr⁻¹", &(&right * right_inverse), &one);
            close("Jl = Ad·Jr", &left, &(&adjoint * &right));
            Ok(())
        })
        .unwrap();
}

/// Angles (and, in Sim(2), sizes |σ + iω|) just below and above each switch: of d at 0.5, of the Jacobian of SE(3) at 2, of
/// half-angle functions at √10, of φ at 1e-8 and of φ′ at 1; and in between.
const SLOPE_ANGLES: [f64; 17] = [
    0.0, 1e-9, 0.99e-8, 1.01e-8, 1e-3, 0.3, 0.499_999, 0.500_001, 0.999_999, 1.000_001, 1.999_999, 2.000_001, 2.7,
    3.12, 3.162_277, 3.162_278, 5.0,
];
const STEP: f64 = 0.2;

/// What a claimed Jacobian misses of the slope of exp, at step h: central differences with two Richardson extrapolations, whose
/// own error falls with h⁶.
fn slope_error<G: Coordinates>(v: &[f64], jacobian: &DMatrix<f64>, left: bool, h: f64) -> f64 {
    let exp = |v: &[f64]| G::matrix(&G::exp(G::algebra(v)));
    let inverse = G::matrix(&G::inverse(&G::exp(G::algebra(v))));
    let mut error: f64 = 0.0;
    for k in 0..G::DIMENSION {
        let central = |h: f64| {
            let stepped =
                |h: f64| exp(&v.iter().enumerate().map(|(i, x)| if i == k { x + h } else { *x }).collect::<Vec<_>>());
            (stepped(h) - stepped(-h)) / (2.0 * h)
        };
        let [coarse, middle, fine] = [central(h), central(h / 2.0), central(h / 4.0)];
        let [first, second] = [(&middle * 4.0 - coarse) / 3.0, (fine * 4.0 - middle) / 3.0];
        let slope = (second * 16.0 - first) / 15.0;
        let trivialised = if left { slope * &inverse } else { &inverse * slope };
        error = error.max(gap(&trivialised, &G::hat(jacobian.column(k).as_slice())));
    }
    error
}

/// Whether the error falls with the fourth power of the step at least, or is rounding (1e-15/h through a few products)
/// throughout. An error of the Jacobian above 1e-10 would stay when the step is halved.
fn is_slope_of_exp<G: Coordinates>(v: &[f64], jacobian: &DMatrix<f64>, left: bool) -> bool {
    let [coarse, fine] = [STEP, STEP / 2.0].map(|h| slope_error::<G>(v, jacobian, left, h));
    let order = (coarse / fine).log2();
    (order > 4.0 && fine < 1e-8) || coarse < 1e-12
}

fn slope_points<G: Coordinates>() -> impl Iterator<Item = Vec<f64>> {
    SLOPE_ANGLES.into_iter().map(|angle| {
        // A unit vector of the angular part and the scale, so that the size of σ + iω is `angle`.
        let rest: &[f64] = match (G::ANGULAR, G::SCALING) {
            (3, _) => &[0.48, -0.6, 0.64],
            (_, 1) => &[0.96, -0.28],
            _ => &[-1.0],
        };
        [0.7, -1.1, 0.4][..G::LINEAR].iter().copied().chain(rest.iter().map(|x| x * angle)).collect()
    })
}

fn jacobians_are_slopes_of_exp<G: Coordinates>() {
    for v in slope_points::<G>() {
        for (left, jacobian) in [(true, G::left_jacobian(G::algebra(&v))), (false, G::right_jacobian(G::algebra(&v)))] {
            let jacobian = G::map(jacobian);
            let errors = [STEP, STEP / 2.0].map(|h| slope_error::<G>(&v, &jacobian, left, h));
            assert!(is_slope_of_exp::<G>(&v, &jacobian, left), "left {left} at {v:?}: errors {errors:?}");
        }
    }
}

/// The checks above must tell each of these wrong Jacobians from the right one, at every angle above 1e-3.
fn mutants_are_seen<G: Coordinates>() {
    for v in slope_points::<G>().filter(|v| DVector::from_column_slice(&v[G::LINEAR..]).norm() >= 1e-3) {
        let u = || G::algebra(&v);
        let identity = DMatrix::identity(G::DIMENSION, G::DIMENSION);
        let mutants = [
            ("J = I", identity, true),
            ("J = I", DMatrix::identity(G::DIMENSION, G::DIMENSION), false),
            ("flipped sign", G::map(G::left_jacobian(-u())), true),
            ("flipped sign", G::map(G::right_jacobian(-u())), false),
            ("inverse for forward", G::map(G::left_jacobian_inverse(u())), true),
            ("inverse for forward", G::map(G::right_jacobian_inverse(u())), false),
        ];
        for (name, jacobian, left) in mutants {
            assert!(!is_slope_of_exp::<G>(&v, &jacobian, left), "{name} passes at {v:?}, left {left}");
        }
    }
}

macro_rules! suite {
    ($($module:ident: $group:ty, $($law:ident),+;)+) => { $(mod $module {
        use super::*;
        $(#[test]
        fn $law() {
            super::$law::<$group>();
        })+
    })+ };
}
suite! {
    so2: So2Group, group_laws, jacobians_are_slopes_of_exp; // commutative: its Jacobians are 1
    so3: So3Group, group_laws, jacobians_are_slopes_of_exp, mutants_are_seen;
    se2: Se2Group, group_laws, jacobians_are_slopes_of_exp, mutants_are_seen;
    se3: Se3Group, group_laws, jacobians_are_slopes_of_exp, mutants_are_seen;
    sim2: Sim2Group, group_laws, jacobians_are_slopes_of_exp, mutants_are_seen;
}
