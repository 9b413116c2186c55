//! Every refusal, with its sentence.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::{Options, OrderError, TopologyChoice, Weight, automatic_weight, order, order_poses, order_weighted};
use se3_geom::nalgebra::{
    Isometry2, Matrix2, Quaternion, SVector, Similarity2, UnitComplex, UnitQuaternion, Vector2, Vector3, Vector4,
};
use se3_geom::{Euclidean, HeightJet, Manifold, MongePatch, Pose, R2, R3, Se2, Se3, Sim2, So2, So3, Sphere};

use crate::support::helix_pose;

fn refusal(points: &[Vector3<f64>], topology: TopologyChoice, start: Option<usize>) -> OrderError {
    order(&R3::default(), points, &Options { topology, start, ..Options::default() }).unwrap_err()
}

fn line(n: u32) -> Vec<Vector3<f64>> {
    (0..n).map(|k| Vector3::x() * f64::from(k)).collect()
}

fn assert_refused(error: &OrderError, expected: &OrderError, sentence: &str) {
    assert_eq!(error, expected);
    assert_eq!(error.to_string(), sentence);
}

#[test]
fn too_few_points() {
    for n in [0, 1] {
        let error = refusal(&line(n), TopologyChoice::Auto, None);
        let there = if n == 1 { "there is 1 point" } else { "there are 0 points" };
        let sentence = format!("{there} to order, but at least 2 are needed");
        assert_refused(&error, &OrderError::TooFewPoints { count: n as usize, needed: 2 }, &sentence);
    }
    let error = refusal(&line(2), TopologyChoice::Closed, None);
    assert_eq!(error, OrderError::TooFewPoints { count: 2, needed: 3 });
}

#[test]
fn too_few_distinct_points() {
    let error = refusal(&[line(2), line(2)].concat(), TopologyChoice::Closed, None);
    let sentence = "the 4 points hold only 2 distinct ones, but at least 3 are needed";
    assert_refused(&error, &OrderError::TooFewDistinct { count: 4, distinct: 2, needed: 3 }, sentence);
}

#[test]
fn all_points_equal() {
    let error = refusal(&[Vector3::y(); 5], TopologyChoice::Auto, None);
    assert_refused(
        &error,
        &OrderError::AllEqual { count: 5 },
        "all 5 points are equal up to rounding, so there is nothing to order",
    );
}

#[test]
fn coordinates_that_are_not_finite() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut points = line(6);
        points[4].z = bad;
        let error = refusal(&points, TopologyChoice::Auto, None);
        let sentence = "point 4 has a coordinate that is not a finite number";
        assert_refused(&error, &OrderError::NonFinite { index: 4 }, sentence);
    }
}

#[test]
fn distances_that_overflow() {
    let mut points = line(4);
    points[2].x = 1e200;
    let error = refusal(&points, TopologyChoice::Auto, None);
    assert_refused(
        &error,
        &OrderError::DistanceOverflow { at: [0, 2] },
        "the distance between points 0 and 2 overflows",
    );
}

#[test]
fn starts_that_are_none() {
    let error = refusal(&line(6), TopologyChoice::Auto, Some(6));
    let sentence = "the start 6 is out of range: there are 6 points, counted from 0";
    assert_refused(&error, &OrderError::StartOutOfRange { start: 6, count: 6 }, sentence);
    let error = refusal(&line(6), TopologyChoice::Auto, Some(2));
    let sentence = "the start 2 is not an end of the open curve, whose ends are points 0 and 5";
    let OrderError::StartNotAnEnd { start: 2, mut ends } = error else { panic!("{error}") };
    ends.sort_unstable();
    assert_refused(
        &OrderError::StartNotAnEnd { start: 2, ends },
        &OrderError::StartNotAnEnd { start: 2, ends: [0, 5] },
        sentence,
    );
}

#[test]
fn length_scales_that_are_none() {
    let poses: Vec<Pose> = (0..4).map(|k| helix_pose(0.1 * f64::from(k))).collect();
    for bad in [0.0, -1.0, f64::INFINITY, 1e200] {
        let error = order_poses(&poses, bad, &Options::default()).unwrap_err();
        assert_eq!(error, OrderError::InvalidLengthScale { value: bad });
        assert!(error.to_string().starts_with("metres_per_radian is "), "{error}");
    }
    assert!(matches!(order_poses(&poses, f64::NAN, &Options::default()), Err(OrderError::InvalidLengthScale { .. })));
}

/// Of every space: too few points, equal ones, two, and points that are none, as few and as many.
fn assert_refuses<M: Manifold>(
    manifold: &M,
    point: impl Fn(f64) -> M::Point,
    not_finite: &[M::Point],
    no_points: &[M::Point],
) {
    for denoise in [false, true] {
        let given = |points: &[M::Point], topology| {
            order(manifold, points, &Options { topology, denoise, ..Options::default() })
        };
        let refusal = |points: &[M::Point]| given(points, TopologyChoice::Auto).unwrap_err();
        let curve = |n: u32| (0..n).map(|k| point(0.01 * f64::from(k))).collect::<Vec<_>>();
        for n in [0, 1] {
            assert_eq!(refusal(&curve(n)), OrderError::TooFewPoints { count: n as usize, needed: 2 });
        }
        let two = given(&curve(2), TopologyChoice::Auto).unwrap();
        assert_eq!((two.order, two.topology), (vec![0, 1], reorder::Topology::Open));
        let loop_of_two = given(&curve(2), TopologyChoice::Closed).unwrap_err();
        assert_eq!(loop_of_two, OrderError::TooFewPoints { count: 2, needed: 3 });
        for count in [2, 5, 100] {
            assert_eq!(refusal(&vec![point(0.3); count]), OrderError::AllEqual { count });
        }
        for n in [6, 100] {
            let with = |bad: &M::Point| {
                let mut points = curve(n);
                points[4] = bad.clone();
                points
            };
            for bad in not_finite {
                assert_eq!(refusal(&with(bad)), OrderError::NonFinite { index: 4 }, "{bad:?}");
            }
            for bad in no_points {
                assert_eq!(refusal(&with(bad)), OrderError::NotAPoint { index: 4 }, "{bad:?}");
            }
        }
    }
}

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

#[test]
fn flat_spaces_refuse_what_is_no_point() {
    fn flat<const N: usize>() {
        let bad: Vec<_> = NOT_FINITE
            .iter()
            .map(|&x| SVector::<f64, N>::zeros().map_with_location(|i, _, _| if i + 1 == N { x } else { 1.0 }))
            .collect();
        assert_refuses(&Euclidean::<N>, SVector::repeat, &bad, &[]);
    }
    flat::<1>();
    flat::<2>();
    flat::<3>();
    flat::<8>();
}

#[test]
fn spaces_of_unit_vectors_refuse_what_is_no_point() {
    let bad = NOT_FINITE.map(|x| Vector3::new(0.6, x, 0.8));
    let none = [Vector3::zeros(), Vector3::x() * 1.001, Vector3::x() * 1e200];
    assert_refuses(&Sphere, |t| Vector3::new(t.cos(), t.sin(), 0.0), &bad, &none);
    let complex = |re, im| UnitComplex::new_unchecked(se3_geom::nalgebra::Complex::new(re, im));
    let bad = NOT_FINITE.map(|x| complex(x, 0.0));
    assert_refuses(&So2, UnitComplex::new, &bad, &[complex(0.0, 0.0), complex(0.0, 2.0)]);
    let quaternion = |x: Vector4<f64>| UnitQuaternion::new_unchecked(Quaternion::from_vector(x));
    let bad = NOT_FINITE.map(|x| quaternion(Vector4::new(0.0, x, 0.0, 1.0)));
    let none = [0.0, 0.999, 1e200].map(|norm| quaternion(Vector4::y() * norm));
    assert_refuses(&So3, |t| UnitQuaternion::from_scaled_axis(Vector3::x() * t), &bad, &none);
}

#[test]
fn spaces_of_poses_refuse_what_is_no_point() {
    let flat = Isometry2::new(Vector2::new(1.0, 2.0), 0.3);
    let turned = |re, im| {
        let rotation = UnitComplex::new_unchecked(se3_geom::nalgebra::Complex::new(re, im));
        Isometry2::from_parts(flat.translation, rotation)
    };
    let planar = |t: f64| Isometry2::new(Vector2::new(t, 0.0), t);
    let bad = NOT_FINITE.map(|x| Isometry2::new(Vector2::new(0.0, x), 0.0));
    assert_refuses(&Se2::default(), planar, &[bad[0], bad[1], bad[2], turned(f64::NAN, 0.0)], &[turned(0.0, 0.0)]);

    let similar = |t: f64| Similarity2::from_isometry(planar(t), t.exp());
    let mut bad =
        NOT_FINITE.map(|x| Similarity2::from_isometry(Isometry2::new(Vector2::new(0.0, x), 0.0), 1.0)).to_vec();
    // A scale that is not positive has no finite logarithm; nalgebra refuses to build one of zero.
    bad.push(Similarity2::from_isometry(flat, -1.0));
    bad.push(Similarity2::from_isometry(flat, f64::INFINITY));
    assert_refuses(&Sim2::default(), similar, &bad, &[Similarity2::from_isometry(turned(0.5, 0.0), 1.0)]);

    let place = |x: f64| Pose::translation(0.0, x, 0.0);
    let with = |norm: f64| {
        Pose::from_parts(place(1.0).translation, UnitQuaternion::new_unchecked(Quaternion::new(norm, 0.0, 0.0, 0.0)))
    };
    let mut bad = NOT_FINITE.map(place).to_vec();
    bad.push(with(f64::NAN));
    let none = [with(0.0), with(1.01)];
    assert_refuses(&Se3::default(), helix_pose, &bad, &none);
    // The weight is told first.
    for (bad, zero) in [(&bad, false), (&none.to_vec(), true)] {
        for pose in bad {
            let mut poses: Vec<Pose> = (0..9).map(|k| helix_pose(0.1 * f64::from(k))).collect();
            poses[4] = *pose;
            let expected = if zero { OrderError::NotAPoint { index: 4 } } else { OrderError::NonFinite { index: 4 } };
            for weight in [Weight::Auto, Weight::MetresPerRadian(0.3)] {
                assert_eq!(order_weighted::<Se3>(&poses, weight, &Options::default()).unwrap_err(), expected);
            }
            assert_eq!(automatic_weight::<Se3>(&poses).unwrap_err(), expected);
        }
    }
    assert_eq!(
        OrderError::NotAPoint { index: 4 }.to_string(),
        "point 4 is not on the manifold: a quaternion or a direction must have norm 1"
    );
}

#[test]
fn surfaces_refuse_what_is_no_point() {
    let saddle = MongePatch::new(
        |x, y| HeightJet { height: x * y, gradient: Vector2::new(y, x), hessian: Matrix2::new(0.0, 1.0, 1.0, 0.0) },
        f64::INFINITY,
    );
    assert_refuses(&saddle, |t| Vector2::new(t, 0.5 * t), &NOT_FINITE.map(|x| Vector2::new(0.1, x)), &[]);
}

#[test]
fn too_many_points_to_denoise() {
    let points: Vec<Vector2<f64>> = (0..30_001).map(|k| Vector2::new(f64::from(k), 0.0)).collect();
    let error = order(&R2::default(), &points, &Options { denoise: true, ..Options::default() }).unwrap_err();
    let sentence = "30001 points are too many to denoise, which takes time with their square: 30000 at most";
    assert_refused(&error, &OrderError::TooManyToDenoise { count: 30_001, most: reorder::MOST_DENOISED }, sentence);
}
