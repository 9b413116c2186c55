//! exp, log and distance against a table computed at 100 digits (`data/make_golden.py`).
//!
//! Errors are relative to the norm of the expected vector (the exponential's quaternion has norm 1; its tiny vector part is
//! judged by the logarithm). The bound 4e-15 is 18 ε: squaring, root and half-angle sine cost 2 ε, an angle of 10 rad multiplies
//! that by 5, and the logarithm's atan2, root, quotient and product cost 3 ε more.
#![allow(clippy::unwrap_used)]

use nalgebra::{Complex, Isometry2, Similarity2, UnitComplex, UnitQuaternion, Vector2, Vector3};
use se3_geom::{
    LieGroup, LogError, Manifold, PlanarTwist, Pose, Se2, Se2Group, Se3, Se3Group, Sim2, Sim2Group, SimilarityTwist,
    So2, So2Group, So3, So3Group, Twist, nalgebra,
};
use serde_json::Value;

const SPATIAL_BOUND: f64 = 4e-15;
const PLANAR_BOUND: f64 = 1e-14;

fn table(name: &str) -> Vec<Value> {
    let table: Value = serde_json::from_str(include_str!("data/groups_golden.json")).unwrap();
    table[name].as_array().unwrap().clone()
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list: Vec<f64> = value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    list.try_into().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Asserts ‖got − expected‖ ≤ bound·‖expected‖, scaled so that 1e-300 is a number like any other.
fn assert_close(what: &str, case: &Value, bound: f64, got: &[f64], expected: &[f64]) {
    assert_eq!(got.len(), expected.len());
    let scale = expected.iter().fold(f64::MIN_POSITIVE, |largest, x| largest.max(x.abs()));
    let norm = |terms: &mut dyn Iterator<Item = f64>| terms.map(|x| (x / scale).powi(2)).sum::<f64>().sqrt();
    let error = norm(&mut got.iter().zip(expected).map(|(g, e)| g - e));
    let limit = bound * norm(&mut expected.iter().copied());
    assert!(error <= limit, "{what}: {:e} > {bound:e}, got {got:?} at {case}", error / limit * bound);
}

#[test]
fn rotations_and_poses_match_the_table() {
    let cases = table("spatial");
    assert_eq!(cases.len(), 153);
    let metric = Se3::with_weights(0.25, 4.0).unwrap();
    let mut half_turns = 0;
    for case in &cases {
        let close = |what, got: &[f64], key| {
            let expected: Vec<f64> = case[key].as_array().unwrap().iter().map(number).collect();
            assert_close(what, case, SPATIAL_BOUND, got, &expected);
        };
        let twist = Twist::new(Vector3::from(numbers(&case["linear"])), Vector3::from(numbers(&case["angular"])));

        let exp = Se3Group::exp(twist);
        assert_eq!(exp.rotation, So3Group::exp(twist.angular));
        close("exp rotation", exp.rotation.coords.as_slice(), "quaternion_xyzw");
        close("exp translation", exp.translation.vector.as_slice(), "translation");
        if twist.angular.norm() < 3.0 {
            // No digit of a small angle is lost in the vector part either.
            let expected: [f64; 4] = numbers(&case["quaternion_xyzw"]);
            assert_close("exp vector", case, SPATIAL_BOUND, exp.rotation.imag().as_slice(), &expected[..3]);
        }

        // The rounded quaternion as it stands: its norm is 1 within ε, and normalising it again would change its last bits.
        let [x, y, z, w] = numbers(&case["quaternion_xyzw"]);
        let rotation = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
        let pose = Pose::from_parts(Vector3::from(numbers::<3>(&case["translation"])).into(), rotation);
        let log = Se3Group::log(&pose).unwrap();
        assert_eq!(log.angular, So3Group::log(&rotation).unwrap());
        close("log angular", log.angular.as_slice(), "log_angular");
        close("log linear", log.linear.as_slice(), "log_linear");

        let distance = number(&case["distance_from_identity_alpha_0.25_beta_4"]);
        assert_close("distance", case, SPATIAL_BOUND, &[metric.distance(&Pose::identity(), &pose)], &[distance]);
        let logs = [
            So3.log(&UnitQuaternion::identity(), &rotation),
            metric.log(&Pose::identity(), &pose).map(|twist| twist.angular),
        ];
        for log in logs {
            if w.abs() < f64::EPSILON {
                assert!(matches!(log, Err(LogError::CutLocus { .. })), "half a turn: {log:?} at {case}");
                half_turns += 1;
            } else {
                close("manifold log", log.unwrap().as_slice(), "log_angular");
            }
        }
    }
    assert_eq!(half_turns, 2 * 2);
}

#[test]
fn planar_motions_match_the_table() {
    let cases = table("planar");
    assert_eq!(cases.len(), 202);
    let mut half_turns = 0;
    for case in &cases {
        let twist = PlanarTwist::new(Vector2::from(numbers(&case["linear"])), number(&case["angular"]));
        let (cos_sin, translation) = (numbers::<2>(&case["cos_sin"]), numbers::<2>(&case["translation"]));

        let exp = Se2Group::exp(twist);
        assert_eq!(exp.rotation, So2Group::exp(twist.angular));
        assert_close("exp rotation", case, PLANAR_BOUND, &[exp.rotation.re, exp.rotation.im], &cos_sin);
        assert_close("exp translation", case, PLANAR_BOUND, exp.translation.vector.as_slice(), &translation);

        let rotation = unit_complex(cos_sin);
        let log = Se2Group::log(&Isometry2::from_parts(Vector2::from(translation).into(), rotation)).unwrap();
        assert_eq!(log.angular, So2Group::log(&rotation).unwrap());
        assert_close("log angular", case, PLANAR_BOUND, &[log.angular], &[number(&case["log_angular"])]);
        assert_close("log linear", case, PLANAR_BOUND, log.linear.as_slice(), &numbers::<2>(&case["log_linear"]));

        let pose = Isometry2::from_parts(Vector2::from(translation).into(), rotation);
        let logs = [
            So2.log(&UnitComplex::identity(), &rotation),
            Se2::default().log(&Isometry2::identity(), &pose).map(|twist| twist.angular),
        ];
        for log in logs {
            if is_half_turn(cos_sin) {
                assert!(matches!(log, Err(LogError::CutLocus { .. })), "half a turn: {log:?} at {case}");
                half_turns += 1;
            } else {
                assert_close("manifold log", case, PLANAR_BOUND, &[log.unwrap()], &[number(&case["log_angular"])]);
            }
        }
    }
    assert_eq!(half_turns, 2 * 4);
}

#[test]
fn similarities_match_the_table() {
    let cases = table("similar");
    assert_eq!(cases.len(), 505);
    let mut half_turns = 0;
    for case in &cases {
        let twist = SimilarityTwist::new(
            Vector2::from(numbers(&case["linear"])),
            number(&case["angular"]),
            number(&case["scaling"]),
        );
        let (cos_sin, translation) = (numbers::<2>(&case["cos_sin"]), numbers::<2>(&case["translation"]));
        let scale = number(&case["scale"]);

        let exp = Sim2Group::exp(twist);
        let rotation = exp.isometry.rotation;
        assert_close("exp rotation", case, PLANAR_BOUND, &[rotation.re, rotation.im], &cos_sin);
        assert_close("exp scale", case, PLANAR_BOUND, &[exp.scaling()], &[scale]);
        assert_close("exp translation", case, PLANAR_BOUND, exp.isometry.translation.vector.as_slice(), &translation);

        let element = Similarity2::from_parts(Vector2::from(translation).into(), unit_complex(cos_sin), scale);
        let log = Sim2Group::log(&element).unwrap();
        assert_close("log angular", case, PLANAR_BOUND, &[log.angular], &[number(&case["log_angular"])]);
        assert_close("log scaling", case, PLANAR_BOUND, &[log.scaling], &[number(&case["log_scaling"])]);
        assert_close("log linear", case, PLANAR_BOUND, log.linear.as_slice(), &numbers::<2>(&case["log_linear"]));

        // Between scales multiplied by a power of two, which is exact, so that the table holds of them too.
        for power in [1.0, 2f64.powi(900), 2f64.powi(-900)] {
            let base = Similarity2::from_isometry(Isometry2::identity(), power);
            let grown = Similarity2::from_isometry(element.isometry, power * scale);
            let log = Sim2::default().log(&base, &grown);
            if is_half_turn(cos_sin) {
                assert!(matches!(log, Err(LogError::CutLocus { .. })), "half a turn: {log:?} at {case}");
                half_turns += 1;
                continue;
            }
            let log = log.unwrap();
            assert_close("manifold angular", case, PLANAR_BOUND, &[log.angular], &[number(&case["log_angular"])]);
            assert_close("manifold scaling", case, PLANAR_BOUND, &[log.scaling], &[number(&case["log_scaling"])]);
            assert_eq!(log.linear, Vector2::from(translation));
        }
    }
    assert_eq!(half_turns, 3 * 10);
}

/// Within 2 ε of (−1, 0), where the manifolds refuse.
fn is_half_turn([cosine, sine]: [f64; 2]) -> bool {
    cosine < 0.0 && sine.abs() < 2.0 * f64::EPSILON
}

fn unit_complex([cosine, sine]: [f64; 2]) -> UnitComplex<f64> {
    UnitComplex::new_unchecked(Complex::new(cosine, sine))
}
