//! Length, curvature, and the parameter by length.
#![allow(missing_docs, clippy::unwrap_used)]

use std::f64::consts::TAU;

use se3_geom::nalgebra::{UnitQuaternion, Vector1, Vector2, Vector3};
use se3_geom::{
    ArcLengthError, Bezier, ByArcLength, CubicEnds, CubicSpline, Curve, Ends, Euclidean, Geodesic, LieGroup, Manifold,
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

/// x = (t − 0.3)³ on knots that miss 0.3 stands still there, within a piece and within every halving of it.
#[test]
fn an_inner_standstill_is_refused() {
    let cube = |t: f64| Vector1::new((t - 0.3_f64).powi(3));
    let knots = [0.0, 0.2, 0.55, 0.8, 1.0];
    let spline = CubicSpline::through(&knots.map(cube), &knots, CubicEnds::NotAKnot).unwrap();
    let stands_at_0_3 = |refused: ArcLengthError| {
        // The speed, 3(t − 0.3)², is below rounding for |t − 0.3| < 1e-8.
        matches!(refused, ArcLengthError::Standstill { parameter, speed } if (parameter - 0.3).abs() < 1e-7 && speed < 1e-12)
    };
    let refused = ByArcLength::new(&spline, Euclidean::<1>).unwrap_err();
    assert!(stands_at_0_3(refused), "{refused}");

    // A pose that slows down, stops and goes on: position and angle are both the cube, by its control points.
    let controls = [-0.027, 0.063, -0.147, 0.343].map(|x| pose([x, 2.0 * x, 0.0], [0.0, 0.0, x]));
    let stopping = Bezier::new(Se3::default(), controls).unwrap();
    assert!(stopping.derivatives(0.3).velocity.to_vector().norm() < 1e-15);
    let refused = ByArcLength::new(&stopping, Se3::default()).unwrap_err();
    assert!(stands_at_0_3(refused), "{refused}");

    // Slow is not still: a speed of 1e-4 of the mean has its parameter, and its derivatives the unit speed.
    let slow = |t: f64| Vector2::new((t - 0.3_f64).powi(3), 1e-4 * t);
    let slow = CubicSpline::through(&knots.map(slow), &knots, CubicEnds::NotAKnot).unwrap();
    let slow = ByArcLength::new(&slow, R2::default()).unwrap();
    assert!((slow.derivatives(0.027).velocity.norm() - 1.0).abs() < 1e-14);
}

/// x = t² − 0.6t turns at 0.3, which no halving meets: the kink of the speed is the hardest that quadrature has to do, and the
/// length 0.09 + 0.49 is exact. Two ways agree to 1e-13 of the length there, and elsewhere to roundings.
#[test]
fn lengths_are_exact_to_the_tolerance() {
    let knots = [0.0, 0.5, 1.0];
    let turning = knots.map(|t| Vector1::new(t * t - 0.6 * t));
    let turning = CubicSpline::through(&turning, &knots, CubicEnds::NotAKnot).unwrap();
    let length = arc_length(&turning, &Euclidean::<1>).unwrap();
    assert!((length - 0.58).abs() < 1e-13, "{length}");
}
