//! The gallery's figures of curves: the numbers that they show, and that they show them.
#![allow(clippy::unwrap_used)]
// Every figure brings the drawing module.
#![allow(clippy::duplicate_mod)]

#[allow(dead_code)]
#[path = "../examples/figure_4_11.rs"]
mod figure_4_11;
#[allow(dead_code)]
#[path = "../examples/figure_4_13.rs"]
mod figure_4_13;
#[allow(dead_code)]
#[path = "../examples/figure_4_14.rs"]
mod figure_4_14;
#[allow(dead_code)]
#[path = "../examples/figure_6_1.rs"]
mod figure_6_1;
#[allow(dead_code)]
#[path = "../examples/figure_6_3.rs"]
mod figure_6_3;
#[allow(dead_code)]
#[path = "../examples/figure_c_1.rs"]
mod figure_c_1;
#[allow(dead_code)]
#[path = "../examples/figures_4_8_to_4_10.rs"]
mod figures_4_8_to_4_10;

mod drawn;

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, LN_2, PI, SQRT_2};

use drawn::assert_drawn;
use se3_geom::nalgebra::{Matrix2, Matrix3, Vector2, Vector3, Vector4};
use se3_geom::{Bezier, Curve, LieGroup, Manifold, Se3, So3, So3Group};

/// Example 4.4: two translations and a turn about the middle, by their closed forms.
#[test]
fn unit_segments_move_as_in_figures_4_8_to_4_10() {
    let numbers = figures_4_8_to_4_10::compute();
    let [along_x, along_y, turn] = &numbers.motions;
    let start = Vector4::new(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    for (motion, length) in numbers.motions.iter().zip([SQRT_2, SQRT_2, 2.0]) {
        // The gradient's entries are ±√2 to the last digit, and so cancel.
        assert!(motion.normal_part.abs() < 1e-15, "{} leaves the tangent space", motion.direction);
        assert!((motion.length - length).abs() < 1e-15);
        assert_eq!(motion.segments.len(), 21);
        // The thesis's unit length; the projection after each step of the flow keeps it to rounding.
        let lengths = motion.segments.iter().map(|s| (s[2] - s[0]).powi(2) + (s[3] - s[1]).powi(2) - 1.0);
        let violation = lengths.map(f64::abs).fold(0.0, f64::max);
        assert!(violation < 1e-10 && violation == motion.violation, "{violation:e}");
    }
    for k in 0..=20 {
        let t = k as f64 / 20.0;
        // The flow's 1e-13 a step, some three steps a radian, over at most 2√2 rad.
        for (motion, step) in [(along_x, Vector4::new(t, 0.0, t, 0.0)), (along_y, Vector4::new(0.0, t, 0.0, t))] {
            assert!((motion.segments[k] - (start + step)).norm() < 1e-12);
        }
        // The ends part with relative velocity (−2, 2): 2√2 across a unit length, thus 2√2 rad a unit of t.
        let (sine, cosine) = (PI / 4.0 + 2.0 * SQRT_2 * t).sin_cos();
        let (middle, half) = (Vector2::repeat(0.5 * FRAC_1_SQRT_2), Vector2::new(cosine, sine) * 0.5);
        let (a, b) = (middle - half, middle + half);
        assert!((turn.segments[k] - Vector4::new(a.x, a.y, b.x, b.y)).norm() < 1e-12);
    }
    assert_drawn(3 * 21, 3 * 21 * 2, |path| figures_4_8_to_4_10::draw(&numbers, path));
}

/// The curve is an arc with the chord of the geodesic: its length has a closed form, and is greater.
#[test]
fn the_geodesic_of_figure_4_11_is_the_shorter() {
    let numbers = figure_4_11::compute().unwrap();
    let (angle, chord) = (2.0_f64, 5.0_f64);
    let distance = angle.hypot(chord);
    assert!((numbers.distance - distance).abs() < 1e-14);
    // 100 terms, each of a difference of positions of size 5 with a rounding of 1e-15.
    assert!((numbers.geodesic_length - distance).abs() < 100.0 * 2e-15);
    let arc = chord * (0.5 * angle) / (0.5 * angle).sin();
    let curve_length = angle.hypot(arc);
    // A chord is shorter than its arc by δ²/24 of it, δ = angle/100; the length by (arc/length)² times that part.
    let step = angle / f64::from(figure_4_11::PIECES);
    let missing = arc * arc / curve_length * step * step / 24.0;
    assert!((curve_length - numbers.curve_length - missing).abs() < 1e-3 * missing, "{}", numbers.curve_length);
    assert!(numbers.curve_length > numbers.geodesic_length + 0.7);
    // The arc stays at its radius from the centre of the turn; the geodesic on the chord.
    let [from, to] = numbers.ends.map(|pose| pose.translation.vector);
    let across = Vector2::new(from.y - to.y, to.x - from.x) / chord;
    let centre = (from + to) * 0.5 + across * (0.5 * chord / (0.5 * angle).tan());
    for (k, (curve, geodesic)) in numbers.curve.iter().zip(&numbers.geodesic).enumerate() {
        let turned = angle * k as f64 / f64::from(figure_4_11::PIECES);
        let radius = (curve.translation.vector - centre).norm();
        assert!((radius - 0.5 * chord / (0.5 * angle).sin()).abs() < 1e-14);
        assert!(geodesic.translation.vector.dot(&across).abs() < 1e-14);
        assert!((curve.rotation.angle() - turned).abs() < 1e-14 && (geodesic.rotation.angle() - turned).abs() < 1e-14);
    }
    for poses in [&numbers.curve, &numbers.geodesic] {
        assert_eq!((poses[0], poses.len()), (numbers.ends[0], 101));
        assert!((poses[100].to_homogeneous() - numbers.ends[1].to_homogeneous()).norm() < 1e-14);
    }
    assert_drawn(2 + 2 + 2 * 11 * 2, 2, |path| figure_4_11::draw(&numbers, path));
}

/// Rodrigues' formula (D.1) as it is printed, for a vector that does not vanish.
fn rotation(w: Vector3<f64>) -> Matrix3<f64> {
    let (angle, hat) = (w.norm(), w.cross_matrix());
    Matrix3::identity() + hat * (angle.sin() / angle) + hat * hat * ((1.0 - angle.cos()) / (angle * angle))
}

/// Example 4.5 by the thesis's matrices: (4.15), (4.16), and (4.17) with the angle from the trace.
#[test]
fn the_geodesic_of_figure_4_13_is_that_of_equations_4_15_to_4_17() {
    let numbers = figure_4_13::compute().unwrap();
    let [first, second] = [Vector3::new(PI / 4.0, 0.0, 0.0), Vector3::new(FRAC_PI_2, FRAC_PI_2, 0.0)].map(rotation);
    let between = first.transpose() * second;
    let angle = (0.5 * (between.trace() - 1.0)).acos();
    // Half an angle of about a right one has a cosine with as many digits as the matrices, some 1e-15.
    assert!((numbers.angle_rad - angle).abs() < 1e-14, "{} {angle}", numbers.angle_rad);
    let distance = (angle * angle + 76.0).sqrt();
    assert!((numbers.distance - distance).abs() < 1e-14);
    // Quadrature of a constant speed; and the sum over the drawn frames.
    assert!((numbers.length - distance).abs() < 1e-13);
    let drawn: f64 = numbers.poses.windows(2).map(|p| Se3::default().distance(&p[0], &p[1])).sum();
    assert!((drawn - distance).abs() < 1e-13, "{drawn}");
    // log(R₁ᵀR₂) from the skew part, (R − Rᵀ)/2 = sin θ·[axis].
    let skew = (between - between.transpose()) * 0.5;
    let log = Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)]) * (angle / angle.sin());
    assert_eq!(numbers.poses.len(), 13);
    for (k, pose) in numbers.poses.iter().enumerate().skip(1) {
        let t = k as f64 / f64::from(figure_4_13::STEPS);
        let turned = pose.rotation.to_rotation_matrix().into_inner();
        assert!((turned - first * rotation(log * t)).norm() < 1e-14);
        assert!((pose.translation.vector - Vector3::new(6.0 * t - 6.0, 6.0 * t, 2.0 * t)).norm() < 1e-14);
    }
    assert!((numbers.poses[0].rotation.to_rotation_matrix().into_inner() - first).norm() < 1e-14);
    assert_drawn(1 + 1 + 3 * 13, 2, |path| figure_4_13::draw(&numbers, path));
}

/// The object of Figure 4.14 stays a circle, of radius 2ᵗ, and its centre runs on a logarithmic spiral about the fixed point.
#[test]
fn the_circle_of_figure_4_14_stays_one() {
    let numbers = figure_4_14::compute().unwrap();
    let (linear, rate) = (Vector2::from(figure_4_14::TWIST.0), Matrix2::new(LN_2, -1.5 * PI, 1.5 * PI, LN_2));
    // What stays: linear + rate·x = 0.
    let fixed = rate.try_inverse().unwrap() * -linear;
    let (sine, cosine) = (1.5 * PI / 8.0).sin_cos();
    // One step of an eighth, by (4.20).
    let step = Matrix2::new(cosine, -sine, sine, cosine) * (LN_2 / 8.0).exp();
    assert_eq!((numbers.circles.len(), numbers.path.len(), numbers.distances.len()), (9, 201, 8));
    let mut arm = -fixed;
    for (k, circle) in numbers.circles.iter().enumerate() {
        let centre = fixed + arm;
        let radius = (LN_2 * k as f64 / 8.0).exp();
        // Points of size 4, eight steps of 3e-16 relative each.
        assert!(circle.iter().all(|p| ((p - centre).norm() - radius).abs() < 1e-14), "instance {k}");
        assert!((numbers.path[25 * k] - centre).norm() < 1e-14);
        // The mark on it has turned with it, a quarter and a half of a quarter every two steps.
        let (sine, cosine) = (1.5 * PI * k as f64 / 8.0).sin_cos();
        assert!((circle[0] - centre - Vector2::new(cosine, sine) * radius).norm() < 1e-14);
        if k < 8 {
            let moved = (step * arm - arm).norm_squared();
            let exact = (10.0 * ((LN_2 / 8.0).powi(2) + (1.5 * PI / 8.0).powi(2)) + moved).sqrt();
            assert!((numbers.distances[k] - exact).abs() < 1e-14);
        }
        arm = step * arm;
    }
    assert_drawn(1 + 1 + 2 * 9, 0, |path| figure_4_14::draw(&numbers, path));
}

/// Figure 6.1: the curves leave and arrive as told. On the product metric the origin runs on the ordinary Bézier curve of the
/// origins, by Bernstein's polynomials (6.13).
#[test]
fn the_curves_of_figure_6_1_keep_the_given_velocities() {
    let numbers = figure_6_1::compute().unwrap();
    let (frames, given) = (numbers.frames, numbers.given_twists);
    assert_eq!(
        given.map(|t| (t.angular.x, t.linear.as_slice().to_vec())),
        [(0.0, vec![3.0, 1.0, 1.0]), (FRAC_PI_2, vec![-1.0, -3.0, -1.0])]
    );
    let metric = Se3::default();
    for curve in [&numbers.geodesic, &numbers.product, &numbers.group] {
        assert_eq!(curve.poses.len(), 61);
        assert!(metric.distance(&curve.poses[0], &frames[0]) < 1e-14);
        assert!(metric.distance(&curve.poses[60], &frames[1]) < 1e-14);
    }
    for curve in [&numbers.product, &numbers.group] {
        for (twist, given) in curve.end_twists.iter().zip(given) {
            // A third of the velocity is a difference of positions of size 5, three roundings of 1e-15 each, tripled.
            assert!((*twist - given).to_vector().norm() < 1e-14, "{twist:?}");
        }
    }
    let distance = 10f64.hypot(FRAC_PI_2);
    assert!((numbers.distance - distance).abs() < 1e-14 && (numbers.geodesic.length - distance).abs() < 1e-13);
    let controls = Bezier::from_end_velocities(metric, frames, given).unwrap();
    // Q₁ … Q₄ by (6.15) in the world: the last frame is turned a quarter about x, so that (−1, −3, −1) is (−1, 1, −3) there.
    let expected =
        [[-5.0, 0.0, 0.0], [-4.0, 1.0 / 3.0, 1.0 / 3.0], [5.0 + 1.0 / 3.0, -1.0 / 3.0, 1.0], [5.0, 0.0, 0.0]];
    let expected = expected.map(Vector3::from);
    for (found, expected) in controls.control_points().iter().zip(expected) {
        assert!((found.translation.vector - expected).norm() < 1e-14);
    }
    for k in 0..=60 {
        let t = k as f64 / 60.0;
        let u = 1.0 - t;
        let weights = [u * u * u, 3.0 * t * u * u, 3.0 * t * t * u, t * t * t];
        let origin: Vector3<f64> = expected.iter().zip(weights).map(|(p, w)| p * w).sum();
        assert!((numbers.product.poses[k].translation.vector - origin).norm() < 1e-14);
        // All four rotations are about one axis, with angles 0, 0, π/3, π/2: a Bézier curve of angles.
        let angle = weights[2] * PI / 3.0 + weights[3] * FRAC_PI_2;
        for curve in [&numbers.product, &numbers.group] {
            let exact = So3Group::exp(Vector3::new(angle, 0.0, 0.0));
            assert!(So3.distance(&curve.poses[k].rotation, &exact) < 1e-14);
        }
        let line = Vector3::new(10.0 * t - 5.0, 0.0, 0.0);
        assert!((numbers.geodesic.poses[k].translation.vector - line).norm() < 1e-14);
    }
    // The two structures give different curves, and both are longer than the geodesic, which is the shortest.
    assert!(metric.distance(&numbers.product.poses[30], &numbers.group.poses[30]) > 0.1);
    // The drawn polygon of 60 pieces is shorter than the curve, by (δ²/24)·∫κ² of it and no more.
    for curve in [&numbers.product, &numbers.group] {
        assert!(curve.length > distance + 0.1);
        let polygon: f64 = curve.poses.windows(2).map(|p| metric.distance(&p[0], &p[1])).sum();
        assert!(polygon < curve.length && polygon > 0.999 * curve.length, "{polygon} {}", curve.length);
    }
    assert_drawn(3 + 3 + 3 * 11 * 3, 2, |path| figure_6_1::draw(&numbers, path));
}

/// Figure 6.3: through the points, twice differentiable at each, the closing one too, and with the tangents of (6.10).
#[test]
fn the_spline_of_figure_6_3_is_closed_and_c2() {
    let numbers = figure_6_3::compute().unwrap();
    // (6.11), row by row as it is printed.
    let x = [2.0, 3.0, 4.0, 3.0, 2.0, 2.0, 3.0, 4.0, 2.0, 1.0, 1.0];
    let y = [0.0, 0.0, 1.0, 2.0, 1.5, 2.0, 2.5, 4.0, 4.0, 2.0, 1.0];
    let points: Vec<_> = x.into_iter().zip(y).map(|(x, y)| Vector2::new(x, y)).collect();
    let n = points.len();
    assert_eq!((numbers.arriving.len(), numbers.leaving.len(), numbers.curve.len()), (n, n, 20 * n + 1));
    for i in 0..n {
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        // Values below 4, velocities below 3, accelerations below 12, each the sum of four Taylor terms.
        for ends in [&numbers.arriving, &numbers.leaving] {
            assert!((ends[i][0] - points[i]).norm() < 1e-14, "P{}", i + 1);
        }
        assert!((numbers.arriving[i][1] - numbers.leaving[i][1]).norm() < 4e-14);
        assert!((numbers.arriving[i][2] - numbers.leaving[i][2]).norm() < 1e-13);
        assert!(numbers.leaving[i][2].norm() > 0.1, "a spline that does not bend is C² and nothing");
        let [p, m, q] = [before, i, after].map(|k| numbers.leaving[k][1]);
        let row = p + m * 4.0 + q - (points[after] - points[before]) * 3.0;
        assert!(row.norm() < 1e-13, "row {i} of (6.10)");
        assert!((numbers.curve[20 * i] - points[i]).norm() < 1e-14);
    }
    assert!((numbers.curve[20 * n] - points[0]).norm() < 1e-14);
    let spline = figure_6_3::closed_spline().unwrap();
    assert!(spline.is_closed());
    assert!((spline.point(-1.0) - points[n - 1]).norm() < 1e-14, "it goes round");
    // The drawn polygon: shorter, by a part (turn of a piece)²/24 on average; the sharpest bend turns by 0.6 in one.
    let polygon: f64 = numbers.curve.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    assert!(polygon < numbers.length && polygon > 0.998 * numbers.length, "{polygon} {}", numbers.length);
    assert_drawn(1 + 1, n, |path| figure_6_3::draw(&numbers, path));
}

/// Figure C.1: after a round the vector has turned by the area enclosed; on the way it solves (C.1).
#[test]
fn the_vector_of_figure_c_1_turns_by_the_area_enclosed() {
    let numbers = figure_c_1::compute().unwrap();
    let area = (2.0 - SQRT_2) * PI;
    let errors = numbers.turns_rad.map(|turned| (turned - area).abs());
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.98..2.02).contains(&order), "order {order}");
    }
    // Richardson leaves the fourth order, (2π/128)⁴ ≈ 6e-6 times a small constant.
    assert!((numbers.limit_rad - area).abs() < 1e-6, "{}", numbers.limit_rad);
    // (C.1) from (1, 0): v¹ = cos(t/√2), v² = −√2·sin(t/√2). Up to the k-th point the polygon misses k/256 of the area.
    assert_eq!(numbers.field.len(), 257);
    for (k, [point, vector]) in numbers.field.iter().enumerate() {
        let t = 2.0 * PI * k as f64 / 256.0;
        let (sine, cosine) = (t * FRAC_1_SQRT_2).sin_cos();
        let along_v = Vector3::new(-t.sin(), t.cos(), 0.0) * FRAC_1_SQRT_2;
        let exact = figure_c_1::along_u(figure_c_1::U, t) * cosine - along_v * (SQRT_2 * sine);
        assert!((vector.norm() - 1.0).abs() < 1e-13 && vector.dot(point).abs() < 1e-13);
        let missed = errors[3] * k as f64 / 256.0;
        assert!(
            ((vector - exact).norm() - missed).abs() < 1e-8 * missed + 1e-13,
            "{} {missed}",
            (vector - exact).norm()
        );
    }
    let net = figure_c_1::net(&figure_c_1::view()).len();
    assert_drawn(net + 1 + 1 + 17, 1, |path| figure_c_1::draw(&numbers, path));
}
