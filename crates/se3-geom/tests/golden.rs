//! exp, log and distance against a table computed at 60 digits (`data/make_golden.py`).
#![allow(clippy::unwrap_used)]

use nalgebra::{UnitQuaternion, Vector3};
use se3_geom::{LieGroup, Manifold, Pose, Se3, Se3Group, So3Group, Twist, nalgebra, rotation_from_xyzw};

fn numbers<const N: usize>(value: &serde_json::Value) -> [f64; N] {
    let list: Vec<f64> = value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    list.try_into().unwrap()
}

#[test]
fn exp_log_and_distance_match_sixty_digits() {
    let table: serde_json::Value = serde_json::from_str(include_str!("data/so3_se3_golden.json")).unwrap();
    let cases = table["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 57);
    let metric = Se3::with_weights(0.25, 4.0).unwrap();
    for case in cases {
        let twist = Twist::new(Vector3::from(numbers(&case["linear"])), Vector3::from(numbers(&case["angular"])));
        let rotation: UnitQuaternion<f64> = rotation_from_xyzw(numbers(&case["quaternion_xyzw"])).unwrap();
        let translation = Vector3::from(numbers::<3>(&case["translation"]));
        let angle = twist.angular.norm();

        let exp = Se3Group::exp(twist);
        // Half an ulp of each operation of three multiplications and one sine: within 4 ε.
        assert!((exp.rotation.coords - rotation.coords).norm() < 4.0 * f64::EPSILON, "exp at {angle}");
        assert!((exp.translation.vector - translation).norm() < 8.0 * f64::EPSILON, "V at {angle}");

        // Relative to the angle: the table's quaternion is rounded, which moves its logarithm by 2 ε at most.
        let log = So3Group::log(&rotation).unwrap();
        assert!((log - twist.angular).norm() < 8.0 * f64::EPSILON * angle.max(1.0), "log at {angle}");
        let small = So3Group::log(&So3Group::exp(twist.angular)).unwrap();
        assert!((small - twist.angular).norm() <= 8.0 * f64::EPSILON * angle, "relative accuracy at {angle}");

        let distance = case["distance_from_identity_alpha_0.25_beta_4"].as_f64().unwrap();
        let pose = Pose::from_parts(translation.into(), rotation);
        assert!((metric.distance(&Pose::identity(), &pose) - distance).abs() < 8.0 * f64::EPSILON * (1.0 + distance));
    }
}
