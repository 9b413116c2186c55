//! Length, curvature, and the parameter by length.
#![allow(missing_docs, clippy::unwrap_used)]

use std::f64::consts::TAU;

use se3_geom::nalgebra::{UnitQuaternion, Vector1, Vector2, Vector3};
use se3_geom::{
    ArcLengthError, ByArcLength, CubicEnds, CubicSpline, Curve, Ends, Euclidean, Geodesic, LieGroup, Manifold,
    Parameterisation, Pose, PoseSpline, R2, R3, Screw, Se3, So3, So3Group, Twist, arc_length, curvature,
};

fn pose(p: [f64; 3], rotation_vector: [f64; 3]) -> Pose {
    Pose::from_parts(Vector3::from(p).into(), So3Group::exp(rotation_vector.into()))
}

fn sample_poses() -> Vec<Pose> {
    (0..7)
        .map(|i| f64::from(i) * 0.8)
        .map(|t| pose([t.cos(), (1.3 * t).sin(), 0.2 * t], [0.4 * t, (0.9 * t).sin(), 0.5 * (0.7 * t).cos()]))
        .collect()
}

/// A circle has its radius for curvature and its circumference for length, under any parameterisation.
#[test]
fn curvature_and_length_of_what_is_known() {
    // The latitude circle at colatitude 1 on SO(3)'s unit speed: a rotation about one axis is straight.
    let spin = Geodesic::leaving(So3, UnitQuaternion::identity(), Vector3::new(0.0, 0.0, 2.0));
    assert_eq!(curvature(&So3, &spin.derivatives(0.4)), Some(0.0));
    // A circle through many points, with uneven knots.
    let count = 400;
    let knots: Vec<_> =
        (0..=count).map(|i| f64::from(i) / f64::from(count)).map(|u| u + 0.1 * (TAU * u).sin()).collect();
    let points: Vec<_> = (0..count)
        .map(|i| TAU * f64::from(i) / f64::from(count))
        .map(|a| Vector2::new(a.cos(), a.sin()) * 2.0)
        .collect();
    let circle = CubicSpline::through(&points, &knots, CubicEnds::Periodic).unwrap();
    // Fourth order in 2π/400 for the length, second for the curvature: 6e-8·small and 2.5e-4·small.
    assert!((arc_length(&circle, &R2::default()).unwrap() - 2.0 * TAU).abs() < 1e-8);
    for k in 0..50 {
        let kappa = curvature(&R2::default(), &circle.derivatives(f64::from(k) / 50.0)).unwrap();
        assert!((kappa - 0.5).abs() < 1e-4, "{kappa}");
    }
    // The helix of a screw: κ of the origin's curve and of the pose's curve, by the weights of the metric.
    let screw = Screw::leaving(Pose::identity(), Twist::new(Vector3::new(3.0, 0.0, 4.0), Vector3::z()));
    for (alpha, beta) in [(1.0, 1.0), (4.0, 0.5)] {
        let metric = Se3::with_weights(alpha, beta).unwrap();
        // ‖a‖ = √β·‖ω×v‖, across v already; ‖v‖² = α + 25β.
        let exact = beta.sqrt() * 3.0 / (alpha + 25.0 * beta);
        assert!((curvature(&metric, &screw.derivatives(0.7)).unwrap() - exact).abs() < 1e-15);
    }
    let still = Geodesic::leaving(R3::default(), Vector3::zeros(), Vector3::zeros());
    assert_eq!(curvature(&R3::default(), &still.derivatives(0.5)), None);
}

/// By arc length: unit speed everywhere, the curve's own points, no acceleration along the curve, and κ = ‖acceleration‖.
#[test]
fn arc_length_is_a_parameter() {
    let poses = sample_poses();
    let metric = Se3::with_weights(0.5, 2.0).unwrap();
    let knots = Parameterisation::ChordLength.knots(&metric, &poses);
    let spline = PoseSpline::through(&poses, &knots, Ends::Natural).unwrap();
    let by_length = ByArcLength::new(&spline, metric).unwrap();
    let (first, length) = by_length.domain();
    assert_eq!(first, 0.0);
    assert!((length - arc_length(&spline, &metric).unwrap()).abs() < 1e-13 * length);
    // A chain of very many chords is shorter by a part of (length/count)²·κ²/24.
    let chain: f64 = (0..20_000)
        .map(|k| knots[0] + (knots[6] - knots[0]) * f64::from(k) / 20_000.0)
        .map(|t| (spline.pose(t), spline.pose(t + (knots[6] - knots[0]) / 20_000.0)))
        .map(|(a, b)| metric.distance(&a, &b))
        .sum();
    assert!((0.0..1e-6).contains(&(length - chain)), "{length} {chain}");
    for k in 0..=40 {
        let s = length * f64::from(k) / 40.0;
        let t = by_length.parameter_at(s);
        let (d, own) = (by_length.derivatives(s), spline.at(t));
        assert_eq!(d.point, own.pose);
        assert!((metric.norm(&d.point, d.velocity) - 1.0).abs() < 1e-14);
        assert!(metric.inner(&d.point, d.velocity, d.acceleration).abs() < 1e-12);
        let kappa = curvature(&metric, &Curve::derivatives(&spline, t)).unwrap();
        assert!((metric.norm(&d.point, d.acceleration) - kappa).abs() < 1e-12 * (1.0 + kappa));
    }
    // Half the length by parameter and half by measuring the part.
    let half = by_length.parameter_at(0.5 * length);
    assert!(half > knots[0] && half < knots[6]);
}

#[test]
fn standstill_is_refused_and_cusps_are_measured() {
    let still = Geodesic::leaving(R3::default(), Vector3::zeros(), Vector3::zeros());
    assert!(matches!(ByArcLength::new(still, R3::default()), Err(ArcLengthError::Standstill { .. })));
    // There and back: length 2·1 with a turning point at t = 1, where the speed vanishes.
    let points = [0.0, 1.0, 0.0].map(Vector1::new);
    let slopes = CubicEnds::Clamped { start: Vector1::new(2.0), end: Vector1::new(-2.0) };
    let there_and_back = CubicSpline::through(&points, &[0.0, 1.0, 2.0], slopes).unwrap();
    assert!((arc_length(&there_and_back, &Euclidean::<1>).unwrap() - 2.0).abs() < 1e-14);
    let refused = ByArcLength::new(&there_and_back, Euclidean::<1>);
    assert!(matches!(refused, Err(ArcLengthError::Standstill { parameter, .. }) if (parameter - 1.0).abs() < 1e-6));
}
