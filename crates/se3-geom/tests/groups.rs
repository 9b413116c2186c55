//! One law suite for every Lie group, one line a group.
//!
//! It knows a group only by its matrices: products, exponentials, adjoints and Jacobians are judged against matrix products and
//! the power series of the matrix exponential, which share no formula with the code under test.
#![allow(clippy::unwrap_used)]

#[path = "groups/coordinates.rs"]
mod coordinates;
#[path = "groups/jacobians.rs"]
mod jacobians;
mod samples;

use coordinates::Coordinates;
use jacobians::{jacobians_are_slopes_of_exp, mutants_are_seen};
use nalgebra::{DMatrix, DVector, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use samples::angle;
use se3_geom::{Se2Group, Se3Group, Sim2Group, So2Group, So3Group, nalgebra};

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

pub(crate) fn gap(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
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
