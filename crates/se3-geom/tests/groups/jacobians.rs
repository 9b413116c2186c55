//! Jacobians against slopes of the exponential.

use nalgebra::{DMatrix, DVector};
use se3_geom::nalgebra;

use crate::coordinates::Coordinates;
use crate::gap;

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

pub(crate) fn jacobians_are_slopes_of_exp<G: Coordinates>() {
    for v in slope_points::<G>() {
        for (left, jacobian) in [(true, G::left_jacobian(G::algebra(&v))), (false, G::right_jacobian(G::algebra(&v)))] {
            let jacobian = G::map(jacobian);
            let errors = [STEP, STEP / 2.0].map(|h| slope_error::<G>(&v, &jacobian, left, h));
            assert!(is_slope_of_exp::<G>(&v, &jacobian, left), "left {left} at {v:?}: errors {errors:?}");
        }
    }
}

/// The checks above must tell each of these wrong Jacobians from the right one, at every angle above 1e-3.
pub(crate) fn mutants_are_seen<G: Coordinates>() {
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
