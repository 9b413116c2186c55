//! S² against a table computed at 60 digits (`data/make_sphere_golden.py`).
#![allow(clippy::unwrap_used)]

use nalgebra::Vector3;
use se3_geom::{Manifold, Sphere, nalgebra};

fn vector(value: &serde_json::Value) -> Vector3<f64> {
    Vector3::from([0, 1, 2].map(|i| value[i].as_f64().unwrap()))
}

#[test]
fn exp_log_and_distance_match_sixty_digits() {
    let table: serde_json::Value = serde_json::from_str(include_str!("data/sphere_golden.json")).unwrap();
    let cases = table["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 57);
    for case in cases {
        let angle = case["angle"].as_f64().unwrap();
        let (base, end) = (vector(&case["base"]), vector(&case["exp"]));
        // 1e-14 relative, up to 1e-8 from the antipode: some twenty operations of ε/2, and the table's own rounding.
        assert!((Sphere.exp(&base, vector(&case["tangent"])) - end).norm() < 1e-14, "exp at {angle}");
        let distance = case["distance"].as_f64().unwrap();
        assert!((Sphere.distance(&base, &end) - distance).abs() <= 1e-14 * distance, "distance at {angle}");
        let error = (Sphere.log(&base, &end).unwrap() - vector(&case["log"])).norm();
        assert!(error <= 1e-14 * distance, "log at {angle}: {error:e}");
    }
}
