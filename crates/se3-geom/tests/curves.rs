//! What every curve promises, and what each promises by itself.
#![allow(missing_docs, clippy::unwrap_used)]

use std::f64::consts::{FRAC_PI_2, PI};

use se3_geom::nalgebra::{DMatrix, DVector, UnitQuaternion, Vector1, Vector2, Vector3};
use se3_geom::{
    Bezier, ByArcLength, CubicEnds, CubicSpline, Curve, Derivatives, Ends, Euclidean, Geodesic, LieGroup, LogError,
    Manifold, Parameterisation, PartialGeodesic, Pose, PoseSpline, Screw, Se3, Se3Group, So3, So3Group, Sphere, Twist,
    arc_length,
};

fn pose(p: [f64; 3], rotation_vector: [f64; 3]) -> Pose {
    Pose::from_parts(Vector3::from(p).into(), So3Group::exp(rotation_vector.into()))
}

/// Thesis Fig. 6.1: two frames, and the velocities (ω, v) there.
fn figure_6_1() -> ([Pose; 2], [Twist; 2]) {
    let frames = [pose([-5.0, 0.0, 0.0], [0.0; 3]), pose([5.0, 0.0, 0.0], [FRAC_PI_2, 0.0, 0.0])];
    let first = Twist::new(Vector3::new(3.0, 1.0, 1.0), Vector3::zeros());
    let last = Twist::new(Vector3::new(-1.0, -3.0, -1.0), Vector3::new(FRAC_PI_2, 0.0, 0.0));
    (frames, [first, last])
}

fn sample_poses() -> Vec<Pose> {
    (0..7)
        .map(|i| f64::from(i) * 0.8)
        .map(|t| pose([t.cos(), (1.3 * t).sin(), 0.2 * t], [0.4 * t, (0.9 * t).sin(), 0.5 * (0.7 * t).cos()]))
        .collect()
}

/// One step of the derivative chain: `slope` is the derivative of `value` at t. Differences of fourth order at a step where
/// truncation (h⁴ of a fifth derivative) and rounding (1e-16/h) are both far below `tolerance`.
fn assert_slope(name: &str, t: f64, value: impl Fn(f64) -> Vec<f64>, slope: &[f64], scale: f64) {
    const H: f64 = 2e-3;
    let (a, b, c, d) = (value(t - 2.0 * H), value(t - H), value(t + H), value(t + 2.0 * H));
    for k in 0..slope.len() {
        let difference = (a[k] - d[k] + (c[k] - b[k]) * 8.0) / (12.0 * H);
        assert!((difference - slope[k]).abs() < 1e-8 * scale, "{name} at {t}, place {k}: {difference} {}", slope[k]);
    }
}

/// Velocity, acceleration and jerk of a pose curve are what its poses, twists and accelerations change by.
fn assert_pose_derivatives(name: &str, curve: &impl Curve<Point = Pose, Tangent = Twist>, at: &[f64]) {
    for &t in at {
        let d = curve.derivatives(t);
        let body = d.point.rotation.inverse();
        let scale =
            1.0 + [d.velocity, d.acceleration, d.jerk].map(|x| x.to_vector().norm()).into_iter().fold(0.0, f64::max);
        let chart = |s: f64| {
            let there = curve.point(s);
            let turn = So3Group::log(&(body * there.rotation)).unwrap();
            Twist::new(body * there.translation.vector, turn).to_vector().as_slice().to_vec()
        };
        // Linear parts are Rᵀp″: differentiated in the frame at t, angular parts as they are.
        let in_frame = |s: f64, of: &dyn Fn(&Derivatives<Pose, Twist>) -> Twist| {
            let there = curve.derivatives(s);
            let x = of(&there);
            Twist::new(body * (there.point.rotation * x.linear), x.angular).to_vector().as_slice().to_vec()
        };
        assert_slope(&format!("{name}: velocity"), t, chart, d.velocity.to_vector().as_slice(), scale);
        assert_slope(
            &format!("{name}: acceleration"),
            t,
            |s| in_frame(s, &|d| d.velocity),
            d.acceleration.to_vector().as_slice(),
            scale,
        );
        assert_slope(
            &format!("{name}: jerk"),
            t,
            |s| in_frame(s, &|d| d.acceleration),
            d.jerk.to_vector().as_slice(),
            scale,
        );
    }
}

/// Every curve answers beyond its domain, knows its knots, and gives the same point with and without derivatives.
fn assert_is_a_curve<C: Curve>(name: &str, curve: &C, distance: impl Fn(&C::Point, &C::Point) -> f64) {
    let (first, last) = curve.domain();
    let knots = curve.knots();
    assert!(first < last, "{name}");
    assert_eq!((knots[0], knots[knots.len() - 1]), (first, last), "{name}");
    assert!(knots.windows(2).all(|k| k[0] < k[1]), "{name}");
    for k in -3..=13 {
        let t = first + (last - first) * f64::from(k) / 10.0;
        // Two ways of rounding one point of size 10.
        assert!(distance(&curve.point(t), &curve.derivatives(t).point) < 1e-13, "{name} at {t}");
        // A curve by reference is that curve.
        assert!(distance(&(&curve).point(t), &curve.point(t)) == 0.0, "{name} at {t}");
    }
    // Open ones, as all here, stay at their ends.
    assert!(distance(&curve.point(last), &curve.point(last + 1.0)) == 0.0, "{name}");
    assert!(distance(&curve.point(first), &curve.point(first - 1.0)) == 0.0, "{name}");
}

#[test]
fn every_curve_is_one() {
    let ([start, end], velocities) = figure_6_1();
    let metric = Se3::default();
    let on_poses = |a: &Pose, b: &Pose| metric.distance(a, b);
    let poses = sample_poses();
    let knots = Parameterisation::Centripetal.knots(&metric, &poses);
    let inside: Vec<_> = knots.windows(2).map(|k| 0.6 * k[0] + 0.4 * k[1]).collect();
    let unit = [0.05, 0.3, 0.5, 0.77, 0.95];

    // Of generic poses: between those of the figure a tangent is carried without change.
    let geodesic = Geodesic::between(metric, poses[1], poses[4]).unwrap();
    assert!((geodesic.derivatives(1.0).velocity - geodesic.derivatives(0.0).velocity).to_vector().norm() > 0.5);
    assert_is_a_curve("geodesic", &geodesic, on_poses);
    assert_pose_derivatives("geodesic", &geodesic, &unit);
    let screw = Screw::between(start, poses[3]).unwrap();
    assert_is_a_curve("screw", &screw, on_poses);
    assert_pose_derivatives("screw", &screw, &unit);
    let product = Bezier::from_end_velocities(metric, [start, end], velocities).unwrap();
    assert_is_a_curve("Bézier, product", &product, on_poses);
    assert_pose_derivatives("Bézier, product", &product, &unit);
    let group = Bezier::from_end_velocities(Se3Group, [start, end], velocities).unwrap();
    assert_is_a_curve("Bézier, group", &group, on_poses);
    assert_pose_derivatives("Bézier, group", &group, &unit);
    let partial = PartialGeodesic::through(&poses, &knots, CubicEnds::Natural).unwrap();
    assert_is_a_curve("partial geodesic", &partial, on_poses);
    assert_pose_derivatives("partial geodesic", &partial, &inside);
    let spline = PoseSpline::through(&poses, &knots, Ends::Natural).unwrap();
    assert_is_a_curve("spline", &spline, on_poses);
    assert_pose_derivatives("spline", &spline, &inside);
    let by_length = ByArcLength::new(&spline, metric).unwrap();
    assert_is_a_curve("spline by length", &by_length, on_poses);
    let lengths: Vec<_> = by_length.knots().windows(2).map(|k| 0.6 * k[0] + 0.4 * k[1]).collect();
    assert_eq!(lengths.len(), inside.len());
    assert_pose_derivatives("spline by length", &by_length, &lengths);

    let points: Vec<_> = poses.iter().map(|p| p.translation.vector).collect();
    let cubic = CubicSpline::through(&points, &knots, CubicEnds::NotAKnot).unwrap();
    assert_is_a_curve("cubic", &cubic, |a, b| (a - b).norm());
    let arc = Geodesic::between(Sphere, Vector3::x(), Vector3::new(0.0, 0.6, 0.8)).unwrap();
    assert_is_a_curve("great circle", &arc, |a, b| Sphere.distance(a, b));
    for t in unit {
        let coordinates = |s: f64| arc.point(s).as_slice().to_vec();
        assert_slope("great circle: velocity", t, coordinates, arc.derivatives(t).velocity.as_slice(), 1.0);
    }
}

/// A geodesic reaches its end, at constant speed equal to the distance, on spaces of different kinds.
#[test]
fn geodesics_are_straight() {
    fn check<M: Manifold + Clone>(manifold: &M, start: M::Point, end: M::Point) {
        let line = Geodesic::between(manifold.clone(), start.clone(), end.clone()).unwrap();
        let distance = manifold.distance(&start, &end);
        for k in 0..=10 {
            let t = f64::from(k) / 10.0;
            let d = line.derivatives(t);
            assert!((manifold.norm(&d.point, d.velocity) - distance).abs() < 1e-14 * (1.0 + distance));
            assert!((manifold.distance(&start, &d.point) - t * distance).abs() < 1e-14 * (1.0 + distance));
            assert!(manifold.norm(&d.point, d.acceleration) == 0.0);
        }
        assert!(manifold.distance(&line.point(1.0), &end) < 1e-14);
        assert!((arc_length(&line, manifold).unwrap() - distance).abs() < 1e-13 * (1.0 + distance));
    }
    check(&Sphere, Vector3::x(), Vector3::new(-0.6, 0.0, 0.8));
    check(&So3, So3Group::exp(Vector3::new(0.3, -1.0, 0.2)), So3Group::exp(Vector3::new(-0.7, 0.1, 1.4)));
    check(&Se3::with_weights(0.3, 2.0).unwrap(), sample_poses()[1], sample_poses()[4]);
    check(&Euclidean::<1>, Vector1::new(-2.0), Vector1::new(3.0));
    let half_turn = Geodesic::between(So3, UnitQuaternion::identity(), So3Group::exp(Vector3::new(PI, 0.0, 0.0)));
    assert!(matches!(half_turn, Err(LogError::CutLocus { .. })));
}

/// The screw keeps its axis and pitch: every point of the tool runs on a helix about one axis.
#[test]
fn screws_turn_about_one_axis() {
    // A quarter turn about the vertical through (1, 0, 0), rising by 0.5: the origin goes from (0, 0, 0) to (1, −1, 0.5).
    let screw = Screw::between(pose([0.0; 3], [0.0; 3]), pose([1.0, -1.0, 0.5], [0.0, 0.0, FRAC_PI_2])).unwrap();
    for k in 0..=8 {
        let t = f64::from(k) / 8.0;
        let p = screw.point(t).translation.vector;
        assert!(((p.xy() - Vector2::new(1.0, 0.0)).norm() - 1.0).abs() < 1e-15);
        assert!((p.z - 0.5 * t).abs() < 1e-15);
    }
    // So it is longer than the geodesic, which is straight.
    let metric = Se3::default();
    let helix = arc_length(&screw, &metric).unwrap();
    let exact = (2.0 * FRAC_PI_2 * FRAC_PI_2 + 0.25).sqrt();
    assert!((helix - exact).abs() < 1e-14 && helix > metric.distance(&screw.point(0.0), &screw.point(1.0)) + 0.1);
    let d = screw.derivatives(0.3);
    assert!((d.acceleration.linear.norm() - FRAC_PI_2 * FRAC_PI_2).abs() < 1e-14);
}

/// The group's Bézier curve by its definition: de Casteljau with plain screws, no jets.
#[test]
fn bezier_is_repeated_straight_lines() {
    let poses = sample_poses();
    let controls = [poses[0], poses[2], poses[3], poses[5]];
    let group = Bezier::new(Se3Group, controls).unwrap();
    let product = Bezier::new(Se3::default(), controls).unwrap();
    for k in 0..=10 {
        let t = f64::from(k) / 10.0;
        let (mut screws, mut lines) = (controls.to_vec(), controls.to_vec());
        while screws.len() > 1 {
            screws = screws.windows(2).map(|p| Screw::between(p[0], p[1]).unwrap().point(t)).collect();
            lines = lines.windows(2).map(|p| Se3::default().geodesic(&p[0], &p[1], t).unwrap()).collect();
        }
        // Six exponentials and logarithms of points of size 3.
        assert!(Se3::default().distance(&group.point(t), &screws[0]) < 2e-14);
        assert!(Se3::default().distance(&product.point(t), &lines[0]) < 2e-14);
    }
    // Also near half a turn between control points, where a badly differentiated logarithm would lose its digits.
    let turns = [0.0, 3.1, 6.1, 9.2].map(|angle| So3Group::exp(Vector3::new(0.48, -0.6, 0.64) * angle));
    let steep = Bezier::new(So3, turns).unwrap();
    let d = steep.derivatives(0.5);
    let exact = [
        (3.0 * 3.1 + 3.0 * 6.1 + 9.2) / 8.0,
        0.75 * (9.2 + 6.1 - 3.1),
        3.0 * (9.2 - 6.1 - 3.1),
        6.0 * (9.2 - 3.0 * 6.1 + 3.0 * 3.1),
    ];
    let axis = Vector3::new(0.48, -0.6, 0.64);
    assert!(So3.distance(&d.point, &So3Group::exp(axis * exact[0])) < 1e-14);
    for (found, exact) in [d.velocity, d.acceleration, d.jerk].into_iter().zip(&exact[1..]) {
        assert!((found - axis * *exact).norm() < 1e-12, "{found} {exact}");
    }
}

/// The thesis' own systems, (6.9) for given end tangents and (6.10) for a closed curve, written as matrices and solved as such,
/// give the velocities of the position spline on uniform knots. Rotations run on geodesics.
#[test]
fn partial_geodesic_solves_the_thesis_equations() {
    let poses = sample_poses();
    let n = poses.len();
    let p: Vec<_> = poses.iter().map(|x| x.translation.vector).collect();
    let uniform = |count| Parameterisation::Uniform.knots(&Se3::default(), &vec![poses[0]; count]);
    let (start, end) = (Vector3::new(0.3, -1.0, 0.2), Vector3::new(0.0, 0.5, -0.7));

    let (mut open, mut cyclic) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    let (mut open_right, mut cyclic_right) = (DMatrix::zeros(n, 3), DMatrix::zeros(n, 3));
    for i in 0..n {
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        for (column, factor) in [(before, 1.0), (i, 4.0), (after, 1.0)] {
            cyclic[(i, column)] += factor;
        }
        cyclic_right.set_row(i, &((p[after] - p[before]) * 3.0).transpose());
        if i == 0 || i == n - 1 {
            open[(i, i)] = 1.0;
            open_right.set_row(i, &if i == 0 { start } else { end }.transpose());
        } else {
            open.set_row(i, &cyclic.row(i));
            open_right.set_row(i, &cyclic_right.row(i));
        }
    }
    let clamped = PartialGeodesic::through(&poses, &uniform(n), CubicEnds::Clamped { start, end }).unwrap();
    let closed = PartialGeodesic::through(&poses, &uniform(n + 1), CubicEnds::Periodic).unwrap();
    for (curve, tangents) in
        [(&clamped, open.lu().solve(&open_right).unwrap()), (&closed, cyclic.lu().solve(&cyclic_right).unwrap())]
    {
        for (i, pose) in poses.iter().enumerate() {
            let d = curve.derivatives(i as f64);
            assert!(Se3::default().distance(&d.point, pose) < 1e-14);
            let world = d.point.rotation * d.velocity.linear;
            assert!((world.transpose() - tangents.row(i)).norm() < 1e-13, "{i}: {world} {}", tangents.row(i));
        }
        let between = So3.geodesic(&poses[2].rotation, &poses[3].rotation, 0.25).unwrap();
        assert!(So3.distance(&curve.point(2.25).rotation, &between) < 1e-14);
    }
    assert!(Se3::default().distance(&closed.point(n as f64), &poses[0]) < 1e-14);
}

/// The rules for knots, by their definitions.
#[test]
fn parameterisations_follow_their_rules() {
    let poses = sample_poses();
    let metric = Se3::default();
    let gaps =
        |rule: Parameterisation| -> Vec<f64> { rule.knots(&metric, &poses).windows(2).map(|k| k[1] - k[0]).collect() };
    let distances = DVector::from_vec(poses.windows(2).map(|p| metric.distance(&p[0], &p[1])).collect());
    let equal = |found: Vec<f64>, exact: DVector<f64>| assert!((DVector::from_vec(found) - exact).norm() < 1e-14);
    equal(gaps(Parameterisation::ChordLength), distances.clone());
    equal(gaps(Parameterisation::Centripetal), distances.map(f64::sqrt));
    equal(gaps(Parameterisation::Uniform), distances.map(|_| 1.0));
    let stamps: Vec<f64> = (0..7).map(|i| f64::from(i * i)).collect();
    assert_eq!(Parameterisation::Given(stamps.clone()).knots(&metric, &poses), stamps);
    assert!(Parameterisation::Centripetal.knots(&metric, &[]).is_empty());
}
