//! The thesis's examples of chapter 4, with numbers.
//!
//! `data/monge_bvp.json` holds scipy's solutions of the boundary-value problems (`data/make_monge_bvp.py`); its tolerance on
//! the relative residual is 1e-10, and its starts agree to 3e-14 in the lengths, 1e-12 in the velocities.
#![allow(clippy::unwrap_used)]

mod surfaces;

use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

use nalgebra::{Matrix2, SMatrix, Vector2, Vector3, Vector4};
use se3_geom::{Constraint, HeightJet, LevelSet, LogError, Manifold, MongePatch, Sphere, UnitSegments, nalgebra};
use surfaces::{egg_box, hill, round_sphere, saddle};

struct Solved {
    surface: String,
    from: [f64; 2],
    to: [f64; 2],
    length: f64,
    velocity: [f64; 2],
    middle: [f64; 2],
}

fn solved_by_scipy() -> Vec<Solved> {
    let table: serde_json::Value = serde_json::from_str(include_str!("data/monge_bvp.json")).unwrap();
    let pair = |value: &serde_json::Value| [0, 1].map(|i| value[i].as_f64().unwrap());
    let solved = |case: &serde_json::Value| Solved {
        surface: case["surface"].as_str().unwrap().into(),
        from: pair(&case["from"]),
        to: pair(&case["to"]),
        length: case["length"].as_f64().unwrap(),
        velocity: pair(&case["velocity"]),
        middle: pair(&case["middle"]),
    };
    table["cases"].as_array().unwrap().iter().map(solved).collect()
}

fn agrees<M: Manifold<Point = Vector2<f64>, Tangent = Vector2<f64>>>(space: &M, solved: &Solved) {
    let (p, q) = (Vector2::from(solved.from), Vector2::from(solved.to));
    let v = space.log(&p, &q).unwrap();
    assert!((space.distance(&p, &q) - solved.length).abs() < 1e-11, "{} {v:?}", solved.surface);
    assert!((v - Vector2::from(solved.velocity)).norm() < 1e-9, "{} {v:?}", solved.surface);
    // exp carries the arrival error of the shot, 1e-11 of some 10 m, and scipy's in the middle.
    assert!((space.exp(&p, v) - q).norm() < 1e-10);
    assert!((space.exp(&p, v * 0.5) - Vector2::from(solved.middle)).norm() < 1e-9);
}

/// Examples 4.2 and 4.3, and the hill: the same geodesics as a solver that shares no method with this one. The egg box's is
/// three times as long as the injectivity radius; scipy's other starts on the hill end on the longer side of it.
#[test]
fn geodesics_of_monge_patches_are_those_of_scipy() {
    let cases = solved_by_scipy();
    assert_eq!(cases.len(), 6);
    for solved in &cases {
        match solved.surface.as_str() {
            "saddle" => agrees(&saddle(), solved),
            "egg_box" => agrees(&egg_box(), solved),
            _ if solved.from[1] != 0.0 => agrees(&hill(), solved),
            // Straight across: both ways round the hill are equally long.
            _ => {
                let (p, q) = (Vector2::from(solved.from), Vector2::from(solved.to));
                let refused = hill().log(&p, &q).unwrap_err();
                let LogError::CutLocus { distance: length, angle_rad: None } = refused else { panic!("{refused}") };
                assert!((length - solved.length).abs() < 1e-11, "{length}");
                assert_eq!(hill().distance(&p, &q), length);
            }
        }
    }
}

/// Example 4.2 in closed form: by symmetry its geodesic is the diagonal, a parabola z = s²/2 over |s| ≤ √2.
#[test]
fn the_saddle_geodesic_of_example_4_2_is_a_parabola() {
    let (p, q) = (Vector2::new(1.0, 1.0), Vector2::new(-1.0, -1.0));
    let exact = 6f64.sqrt() + SQRT_2.asinh();
    assert!((saddle().distance(&p, &q) - exact).abs() < 1e-12);
    for t in [0.2, 0.5, 0.9] {
        let on_way = saddle().geodesic(&p, &q, t).unwrap();
        assert!((on_way.x - on_way.y).abs() < 1e-12);
    }
    assert!((saddle().embed(&q) - Vector3::new(-1.0, -1.0, 1.0)).norm() < 1e-15);
}

/// The equations 4.5 and 4.6 as printed: second differences along a geodesic, whose error falls with the square of the step.
#[test]
fn saddle_geodesics_obey_equations_4_5_and_4_6() {
    let (p, v) = (Vector2::new(0.4, -0.7), Vector2::new(0.9, 1.1));
    let residual = |h: f64| {
        let [before, after] = [-h, h].map(|t| saddle().exp(&p, v * t));
        let acceleration = (before + after - p * 2.0) / (h * h);
        let factor = 2.0 * v.x * v.y / (1.0 + p.norm_squared());
        (acceleration + Vector2::new(p.y, p.x) * factor).norm()
    };
    let order = (residual(0.02) / residual(0.01)).log2();
    assert!((1.9..2.1).contains(&order), "order {order}");
}

/// The unit sphere's upper half as a Monge patch against the sphere itself, which has closed forms for everything.
#[test]
fn a_spherical_cap_is_the_sphere() {
    let jet = |x: f64, y: f64| {
        let height = (1.0 - x * x - y * y).sqrt();
        let p = Vector2::new(x, y);
        HeightJet {
            height,
            gradient: -p / height,
            hessian: -(Matrix2::identity() + p * p.transpose() / (height * height)) / height,
        }
    };
    let cap = MongePatch::new(jet, PI);
    let (p, along, w) = (Vector2::new(0.3, -0.2), Vector2::new(-0.5, 0.6), Vector2::new(0.7, 0.4));
    let q = cap.exp(&p, along);
    let on_sphere = Sphere.exp(&cap.embed(&p), cap.embed_tangent(&p, along));
    assert!((cap.embed(&q) - on_sphere).norm() < 1e-12);
    assert!((cap.distance(&p, &q) - Sphere.distance(&cap.embed(&p), &on_sphere)).abs() < 1e-12);
    let carried = Sphere.transport(&cap.embed(&p), cap.embed_tangent(&p, along), cap.embed_tangent(&p, w));
    assert!((cap.embed_tangent(&q, cap.transport(&p, along, w)) - carried).norm() < 1e-12);
    // Over the rim there is no surface: a point that is none, not a wrong one.
    assert!(!cap.is_finite(&cap.exp(&p, along * 5.0)));
    assert_eq!(cap.log(&p, &Vector2::new(1.2, 0.0)), Err(LogError::NotAPoint));
    assert!(cap.distance(&p, &Vector2::new(1.2, 0.0)).is_nan());
}

/// Example 4.4: a long way, turning and moving at once. The middle runs on a line, the angle grows evenly.
#[test]
fn unit_segments_turn_about_their_moving_middle() {
    let segments = LevelSet::unit_segments();
    let p = Vector4::new(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    let velocity = Vector4::new(1.3, -2.0, -0.7, 0.0);
    for step in 0..=40 {
        let t = 0.25 * f64::from(step);
        // The ends part with relative velocity (−2, 2): 2√2 across a unit length, thus 2√2 rad a unit of t.
        let (sine, cosine) = (PI / 4.0 + 2.0 * SQRT_2 * t).sin_cos();
        let half = Vector2::new(cosine, sine) * 0.5;
        let middle = Vector2::repeat(0.5 * FRAC_1_SQRT_2) + Vector2::new(0.3, -1.0) * t;
        let (a, b) = (middle - half, middle + half);
        let moved = segments.exp(&p, velocity * t);
        // The flow's 1e-13 a step, some three steps a radian, over up to 28 rad.
        assert!((moved - Vector4::new(a.x, a.y, b.x, b.y)).norm() < 1e-11, "{t}");
        assert!(UnitSegments.value(&moved)[0].abs() < 1e-10, "constraint at {t}");
    }
}

/// Distance in closed form: 2‖Δmiddle‖² + ½Δθ². Half a turn is the cut locus.
#[test]
fn distances_of_unit_segments_are_those_of_their_motions() {
    let segments = LevelSet::unit_segments();
    let segment = |x: f64, y: f64, angle: f64| {
        let half = Vector2::new(angle.cos(), angle.sin()) * 0.5;
        Vector4::new(x - half.x, y - half.y, x + half.x, y + half.y)
    };
    let p = segment(0.3, -0.2, 0.5);
    for (x, y, angle) in [(0.3, -0.2, 1.0), (1.0, 2.0, -1.5), (40.0, -9.0, 3.4)] {
        let exact = (2.0 * ((x - 0.3_f64).powi(2) + (y + 0.2_f64).powi(2)) + 0.5 * (angle - 0.5_f64).powi(2)).sqrt();
        let distance = segments.distance(&p, &segment(x, y, angle));
        assert!((distance - exact).abs() < 1e-11 * (1.0 + exact), "{distance} {exact}");
    }
    let refused = segments.log(&p, &segment(0.3, -0.2, 0.5 + PI)).unwrap_err();
    let LogError::CutLocus { distance: length, angle_rad: None } = refused else { panic!("{refused}") };
    assert!((length - PI * FRAC_1_SQRT_2).abs() < 1e-10);
}

/// Two equations: the torus of pairs of unit circles in ℝ⁴ is flat, so everything on it is known.
#[test]
fn a_level_set_of_two_equations_is_the_flat_torus() {
    struct Circles;
    impl Constraint<4, 2> for Circles {
        fn value(&self, x: &Vector4<f64>) -> Vector2<f64> {
            Vector2::new(x[0] * x[0] + x[1] * x[1] - 1.0, x[2] * x[2] + x[3] * x[3] - 1.0)
        }
        fn jacobian(&self, x: &Vector4<f64>) -> SMatrix<f64, 2, 4> {
            SMatrix::<f64, 2, 4>::new(x[0], x[1], 0.0, 0.0, 0.0, 0.0, x[2], x[3]) * 2.0
        }
        fn second_derivative(&self, _: &Vector4<f64>, u: &Vector4<f64>, v: &Vector4<f64>) -> Vector2<f64> {
            Vector2::new(u[0] * v[0] + u[1] * v[1], u[2] * v[2] + u[3] * v[3]) * 2.0
        }
    }
    let torus = LevelSet::new(Circles, PI);
    let at = |a: f64, b: f64| Vector4::new(a.cos(), a.sin(), b.cos(), b.sin());
    let velocity =
        |a: f64, b: f64, da: f64, db: f64| Vector4::new(-a.sin() * da, a.cos() * da, -b.sin() * db, b.cos() * db);
    let p = at(0.4, 2.0);
    let along = velocity(0.4, 2.0, 1.1, -0.6);
    assert!((torus.exp(&p, along) - at(1.5, 1.4)).norm() < 1e-12);
    assert!((torus.log(&p, &at(1.5, 1.4)).unwrap() - along).norm() < 1e-11);
    let carried = torus.transport(&p, along, velocity(0.4, 2.0, 0.5, 0.8));
    assert!((carried - velocity(1.5, 1.4, 0.5, 0.8)).norm() < 1e-12);
    assert!(torus.project(&Vector4::zeros()).is_none(), "DF has no rank there");
}

/// The sphere as a level set, x·x = 1, against its closed forms; and a long way round it.
#[test]
fn the_sphere_as_a_level_set_is_the_sphere() {
    let level_set = round_sphere();
    let p = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    let along = level_set.project_tangent(&p, &Vector3::new(0.4, 1.9, 0.3));
    let w = level_set.project_tangent(&p, &Vector3::new(-0.8, 0.1, 1.0));
    let q = Sphere.exp(&p, along);
    assert!((level_set.exp(&p, along) - q).norm() < 1e-12);
    assert!((level_set.log(&p, &q).unwrap() - along).norm() < 1e-11);
    assert!((level_set.transport(&p, along, w) - Sphere.transport(&p, along, w)).norm() < 1e-12);
    // Tangents stay so to their last digits, however long they are carried; the flow alone would let them drift by 1e-13.
    let carried = level_set.transport(&p, along * 20.0, w);
    let wound = level_set.exp(&p, along * 20.0);
    assert!(carried.dot(&wound).abs() < 4.0 * f64::EPSILON * carried.norm(), "{:e}", carried.dot(&wound));
    assert!((wound - Sphere.exp(&p, along * 20.0)).norm() < 1e-11 && (wound.norm() - 1.0).abs() < 1e-15);
}

/// Straight across the hill is a geodesic too, over its top, and the first that shooting finds. The search must not stop there.
#[test]
fn the_search_leaves_the_geodesic_over_the_top() {
    let (p, q) = (Vector2::new(-2.0, 0.0), Vector2::new(2.0, 1e-3));
    let v = hill().log(&p, &q).unwrap();
    assert!(v.y > 1.0, "round the side on which q lies: {v:?}");
    // The way over the top by the trapezoidal rule, whose error, h², is far below the difference.
    let slope = |x: f64| -4.0 * x * (-x * x).exp();
    let over_the_top: f64 = (0..4000).map(|i| 1e-3 * slope(-2.0 + 1e-3 * (f64::from(i) + 0.5)).hypot(1.0)).sum();
    assert!(hill().distance(&p, &q) < over_the_top - 0.5, "{over_the_top}");
}
