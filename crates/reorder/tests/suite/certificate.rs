//! The figures of the certificate, and the shape of the answer as JSON.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::{Options, Ordering, TopologyChoice, Verdict, order, order_poses};
use se3_geom::nalgebra::Vector2;
use se3_geom::{Pose, R2, R3};

use crate::support::{Random, helix_pose};

fn in_plane(points: &[(f64, f64)]) -> Ordering {
    let points: Vec<_> = points.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
    order(&R2::default(), &points, &Options::default()).unwrap()
}

/// Chords of an n-gon on a circle of radius r: every ball through two samples that touches the circle is the circle, and the
/// parabola through three equidistant samples has the circle's tangent, so that the estimate is r up to rounding.
#[test]
fn the_certificate_of_a_circle_is_exact() {
    let (n, r) = (50, 2.5);
    let found = in_plane(
        &(0..n).map(|k| (TAU * f64::from(k) / f64::from(n)).sin_cos()).map(|(s, c)| (r * s, r * c)).collect::<Vec<_>>(),
    );
    let certificate = found.certificate;
    let gap = 2.0 * r * (std::f64::consts::PI / f64::from(n)).sin();
    // A sagitta of gap²/2r = 0.02 from coordinates rounded to 2 ε: 3e-14 relative.
    assert!((certificate.max_gap / gap - 1.0).abs() < 1e-14);
    assert!((certificate.reach.unwrap() / r - 1.0).abs() < 1e-12, "{certificate:?}");
    assert!((certificate.epsilon.unwrap() / (gap / (2.0 * r)) - 1.0).abs() < 1e-12);
    assert_eq!((certificate.injectivity_radius, certificate.margin), (None, None));
}

#[test]
fn a_straight_line_has_no_finite_reach() {
    let certificate = in_plane(&(0..10).map(|k| (f64::from(k), 0.0)).collect::<Vec<_>>()).certificate;
    assert_eq!((certificate.max_gap, certificate.reach, certificate.epsilon), (1.0, None, None));
}

/// Two strands 0.1 apart make the reach 0.05 however gently the curve bends elsewhere.
#[test]
fn the_reach_sees_strands_that_pass_each_other() {
    let mut points: Vec<_> = (0..=400).map(|k| (0.01 * f64::from(k), 0.0)).collect();
    points
        .extend((1..20).map(|k| (TAU * f64::from(k) / 40.0).sin_cos()).map(|(s, c)| (4.0 + 0.05 * s, 0.05 - 0.05 * c)));
    points.extend((0..=400).map(|k| (4.0 - 0.01 * f64::from(k), 0.1)));
    let found = in_plane(&points);
    assert_eq!(found.order, (0..points.len()).collect::<Vec<_>>());
    // Where line and arc of unequal steps meet, the parabola's tangent is off by less than a step's turn, 0.16 rad: 2 %.
    assert!((found.certificate.reach.unwrap() / 0.05 - 1.0).abs() < 0.02, "{:?}", found.certificate);
}

#[test]
fn json_has_the_fixed_shape() {
    let poses: Vec<Pose> = (0..10).map(|k| helix_pose(0.05 * f64::from(k))).collect();
    let options = Options { topology: TopologyChoice::Open, start: Some(9), ..Options::default() };
    let mut json = serde_json::to_value(order_poses(&poses, 0.5, &options).unwrap()).unwrap();
    let certificate = json.as_object_mut().unwrap().remove("certificate").unwrap();
    assert_eq!(
        json,
        serde_json::json!({
            "n": 10, "order": [9, 8, 7, 6, 5, 4, 3, 2, 1, 0], "topology": "open", "method": "mst", "verdict": "plausible", "weight_stable": true,
            "metres_per_radian": 0.5, "components": [[9, 8, 7, 6, 5, 4, 3, 2, 1, 0]], "duplicates": [],
            "repaired": null, "parts": [], "outliers": [], "moved": [], "doubts": []
        })
    );
    let mut keys: Vec<_> = certificate.as_object().unwrap().keys().cloned().collect();
    keys.sort_unstable();
    let expected = [
        "closing_bound",
        "curvature_radius",
        "distinct",
        "edge_epsilon",
        "epsilon",
        "injectivity_radius",
        "longest_to_usual",
        "margin",
        "max_gap",
        "noise",
        "opening",
        "reach",
        "required_reach",
        "roughness",
        "turn_rad",
        "usable_reach",
        "usual_miss",
        "weakest",
        "zigzag",
    ];
    assert_eq!(keys, expected);
    assert_eq!(certificate["injectivity_radius"], 0.5 * std::f64::consts::PI);
}

/// On a geodesic the points turn by rounding only, this way and that.
#[test]
fn a_straight_line_never_turns_back() {
    let mut random = Random::seeded(71);
    for _ in 0..50 {
        let (from, along) = (random.vector(), random.vector());
        let points: Vec<_> = (0..40).map(|k| from + along * (f64::from(k) + 0.2 * random.signed())).collect();
        let found = order(&R3::default(), &points, &Options::default()).unwrap();
        // Now and then twelve jittered gaps alternate by chance, which is a doubt.
        let expected = if found.doubts.is_empty() { Verdict::Certified } else { Verdict::Ambiguous };
        assert_eq!((found.verdict, found.certificate.zigzag), (expected, 0), "{:?}", found.certificate);
    }
}
