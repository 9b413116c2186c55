//! Half turns, numbers that are no rotation, and the rotation nearest to a matrix.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use nalgebra::{Matrix3, Quaternion, Similarity2, UnitComplex, UnitQuaternion, Vector2, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use se3_geom::{
    LieGroup, LogError, Manifold, NearestRotationError, Pose, Se2, Se2Group, Se3, Se3Group, Sim2, Sim2Group,
    SimilarityTwist, So2, So2Group, So3, So3Group, Sphere, nalgebra, nearest_rotation,
};

/// The directions to the faces, edges and corners of a cube, and some in between.
fn every_direction() -> impl Iterator<Item = Vector3<f64>> {
    let signs = [-1.0, 0.0, 1.0];
    let grid = signs.into_iter().flat_map(move |x| signs.into_iter().flat_map(move |y| signs.map(|z| [x, y, z])));
    let cube = grid.filter(|direction| *direction != [0.0; 3]);
    cube.chain([[1.0, -2.0, 3.0], [-0.6, 0.0, -0.8], [1e-9, 1.0, -1e-170]]).map(|v| Vector3::from(v).normalize())
}

/// At exactly half a turn both logarithms are valid, and one of them comes back: length π, and exp leads to the element.
#[test]
fn half_turns_have_a_group_logarithm() {
    for axis in every_direction() {
        for w in [0.0, -0.0] {
            let half_turn = UnitQuaternion::new_unchecked(Quaternion::from_parts(w, axis));
            let log = So3Group::log(&half_turn).unwrap();
            assert!((log.norm() - PI).abs() <= 4e-15 * PI);
            assert!((log.normalize().dot(&axis).abs() - 1.0).abs() < 4e-15);
            let pose = Pose::from_parts(Vector3::new(0.3, 4.0, -1.0).into(), half_turn);
            let screw = Se3Group::log(&pose).unwrap();
            assert_eq!(screw.angular, log);
            // exp(log) = a up to the roundings of a half turn, 4 m away.
            assert!((Se3Group::exp(screw).to_homogeneous() - pose.to_homogeneous()).norm() < 16.0 * f64::EPSILON * 4.0);
            // The manifold, whose logarithm must be continuous, refuses the same half turn.
            let refused = So3.log(&UnitQuaternion::identity(), &half_turn);
            assert_eq!(refused, Err(LogError::CutLocus { distance: PI, angle_rad: Some(PI) }), "{axis}");
        }
    }
    for sine in [0.0, -0.0] {
        let half_turn = UnitComplex::new_unchecked(nalgebra::Complex::new(-1.0, sine));
        assert_eq!(So2Group::log(&half_turn).unwrap().abs(), PI);
    }
}

/// Where the shortest geodesic is not unique, the logarithm of a manifold says so and how far the two points are apart.
#[test]
fn on_the_cut_locus_the_error_names_distance_and_angle() {
    let named = |error: LogError, distance: f64| {
        let LogError::CutLocus { distance: said, angle_rad: Some(angle) } = error else { panic!("{error}") };
        // The root of a sum of squares is off by a rounding or two.
        assert!((said - distance).abs() <= 2.0 * f64::EPSILON * distance, "{said} {distance}");
        assert!((angle - PI).abs() <= 2.0 * f64::EPSILON, "{angle}");
        assert!(error.to_string().contains(&format!("(distance {said}, angle {angle} rad)")), "{error}");
    };
    let start = So3Group::exp(Vector3::new(0.3, -1.2, 0.5));
    let offset = Vector3::new(2.0, -1.0, 2.0);
    for axis in every_direction() {
        let half_turn = UnitQuaternion::new_unchecked(Quaternion::from_parts(0.0, axis));
        named(So3.log(&start, &(start * half_turn)).unwrap_err(), PI);
        // Three metres weigh 2·3, half a turn 0.5·π.
        let metric = Se3::with_weights(0.25, 4.0).unwrap();
        let (p, q) = (Pose::identity(), Pose::from_parts(offset.into(), half_turn));
        named(metric.log(&p, &q).unwrap_err(), (0.5 * PI).hypot(6.0));
        named(Sphere.log(&axis, &-axis).unwrap_err(), PI);
    }
    let back = UnitComplex::new_unchecked(nalgebra::Complex::new(-1.0, 0.0));
    named(So2.log(&UnitComplex::identity(), &back).unwrap_err(), PI);
    let moved = nalgebra::Isometry2::from_parts(Vector2::new(3.0, 4.0).into(), back);
    let planar = Se2::default();
    let error = planar.log(&nalgebra::Isometry2::identity(), &moved).unwrap_err();
    named(error, planar.distance(&nalgebra::Isometry2::identity(), &moved));
    named(error, PI.hypot(5.0));
    let scaled = Similarity2::from_isometry(moved, 1.0);
    assert_eq!(Sim2::default().log(&Similarity2::identity(), &scaled).unwrap_err(), error);
}

/// A hair's breadth before half a turn there is one, and it leads to the other point; beyond, it comes round the other side.
#[test]
fn next_to_the_cut_locus_the_logarithm_is_the_shorter_way() {
    for axis in every_direction() {
        for gap in [1e-3, 1e-9, 1e-13] {
            let before = So3.log(&UnitQuaternion::identity(), &So3Group::exp(axis * (PI - gap))).unwrap();
            let beyond = So3.log(&UnitQuaternion::identity(), &So3Group::exp(axis * (PI + gap))).unwrap();
            // The rounding of the angle given, and the logarithm's own.
            assert!((before - axis * (PI - gap)).norm() <= 4e-15 * PI, "{axis} {gap}");
            assert!((beyond + axis * (PI - gap)).norm() <= 4e-15 * PI, "{axis} {gap}");
        }
    }
}

#[test]
fn what_is_no_element_has_no_logarithm_and_the_error_names_the_angle() {
    let no_rotation = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 1.0, 0.0, 0.0));
    assert!(So3Group::log(&no_rotation).unwrap_err().to_string().contains("NaN rad"));
    assert!(So3.log(&no_rotation, &UnitQuaternion::identity()).is_err());
    for (w, x) in [(0.0, 0.0), (1.0, f64::INFINITY), (f64::INFINITY, 0.0)] {
        assert!(So3Group::log(&UnitQuaternion::new_unchecked(Quaternion::new(w, x, 0.0, 0.0))).is_err());
    }
    let quarter = UnitQuaternion::from_scaled_axis(Vector3::x() * (PI / 2.0));
    let nowhere = Pose::from_parts(Vector3::new(0.0, f64::INFINITY, 0.0).into(), quarter);
    let error = Se3Group::log(&nowhere).unwrap_err();
    assert!((error.angle_rad - PI / 2.0).abs() < 1e-15 && error.to_string().contains("1.57"));
    assert!(Se2Group::log(&nalgebra::Isometry2::new(Vector2::new(f64::NAN, 0.0), 1.0)).is_err());
    let mirrored = Similarity2::new(Vector2::zeros(), 0.5, -2.0);
    let error = Sim2Group::log(&mirrored).unwrap_err();
    assert_eq!((error.angle_rad, error.scale), (0.5, -2.0));
    assert!(So2Group::log(&UnitComplex::new(f64::NAN)).is_err());
}

/// e^−800 is no number, but a similarity has a positive scale: the smallest.
#[test]
fn a_similarity_shrinks_to_the_smallest_scale_and_no_further() {
    let shrunk = Sim2Group::exp(SimilarityTwist::new(Vector2::new(0.5, -1.0), 0.3, -800.0));
    assert_eq!(shrunk.scaling(), f64::MIN_POSITIVE);
    assert!((Sim2Group::log(&shrunk).unwrap().scaling - f64::MIN_POSITIVE.ln()).abs() < 1e-12);
}

/// At 3 ε from half a turn there is a logarithm in the plane, in space and on the sphere; at ε there is none in any of them.
#[test]
fn one_bound_decides_what_half_a_turn_is() {
    let ends = |gap: f64| {
        // sin and cos of π − gap and of half of it, to first order in the gap.
        let flat = UnitComplex::new_unchecked(nalgebra::Complex::new(-1.0, gap));
        let spatial = UnitQuaternion::new_unchecked(Quaternion::new(0.5 * gap, 0.0, 0.0, 1.0));
        let planar = So2.log(&UnitComplex::identity(), &flat).map(|angle| angle - PI);
        let solid = So3.log(&UnitQuaternion::identity(), &spatial).map(|turn| turn.norm() - PI);
        let round = Sphere.log(&Vector3::x(), &Vector3::new(-1.0, gap, 0.0)).map(|arc| arc.norm() - PI);
        [planar, solid, round]
    };
    assert!(ends(3.0 * f64::EPSILON).iter().all(|gap| gap.is_ok_and(|gap| gap.abs() <= 4.0 * f64::EPSILON)));
    for refused in ends(f64::EPSILON) {
        assert!(matches!(refused, Err(LogError::CutLocus { angle_rad: Some(_), .. })), "{refused:?}");
    }
}

#[test]
fn distance_and_log_keep_their_digits_between_near_rotations() {
    let p = So3Group::exp(Vector3::new(0.3, -1.2, 0.5));
    let near = Quaternion::new(p.w + 1e-13, p.i, p.j - 2e-13, p.k);
    let q = UnitQuaternion::new_unchecked(near);
    // dq is exact (multiples of an ulp), and to first order the rotation vector is 2·imag(p*·dq): relative error |dq| ≈ 2e-13.
    let expected = (p.conjugate().into_inner() * (near - p.into_inner())).imag() * 2.0;
    assert!((So3.log(&p, &q).unwrap() - expected).norm() < 1e-12 * expected.norm());
    assert!((So3.distance(&p, &q) - expected.norm()).abs() < 1e-12 * expected.norm());
    let tiny = So3Group::exp(Vector3::new(0.0, 3e-300, -4e-300));
    assert!((So3.distance(&UnitQuaternion::identity(), &tiny) - 5e-300).abs() < 1e-314);
}

fn entries() -> impl Strategy<Value = Matrix3<f64>> {
    prop::array::uniform9(-1.0..1.0_f64).prop_map(|m| Matrix3::from_column_slice(&m))
}

/// The nearest rotation by definition: RᵀM is symmetric and tr(RᵀM)·I − RᵀM, the second derivative of the distance along rotations,
/// is positive semidefinite. A reflection would fail the first assertion, R⁻¹ or a wrong eigenvector the others.
#[test]
fn nearest_rotation_is_the_nearest() {
    let config = Config { cases: 2000, rng_seed: RngSeed::Fixed(5), failure_persistence: None, ..Config::default() };
    let reflected = std::cell::Cell::new(0);
    TestRunner::new(config)
        .run(&(entries(), -200.0..200.0_f64), |(m, exponent)| {
            let singular = m.svd_unordered(false, false).singular_values;
            let (smallest, sum) = (singular.min(), singular.sum());
            let sign = m.determinant().signum();
            let gap = sum - singular.max() - smallest + sign * smallest;
            prop_assume!(gap > 1e-3);
            reflected.set(reflected.get() + u32::from(sign < 0.0));
            let r = nearest_rotation(&(m * 10f64.powf(exponent))).unwrap().to_rotation_matrix().into_inner();
            assert!((r.determinant() - 1.0).abs() < 1e-14);
            let s = r.transpose() * m;
            // The eigenvector turns by the solver's error over the gap: tens of ε/1e-3.
            assert!((s - s.transpose()).norm() < 1e-12 / gap.min(1.0) * 1e-1, "{s}");
            assert!((Matrix3::from_diagonal_element(s.trace()) - s).symmetric_eigenvalues().min() > 0.0);
            assert!((s.trace() - (sum - smallest + sign * smallest)).abs() < 1e-13);
            Ok(())
        })
        .unwrap();
    assert!(reflected.get() > 500, "the determinant matters in half of the cases");
}

#[test]
fn nearest_rotation_of_a_rotation_is_itself_and_ties_are_refused() {
    let r = So3Group::exp(Vector3::new(0.4, -2.0, 1.3));
    let found = nearest_rotation(&r.to_rotation_matrix().into_inner()).unwrap();
    assert!(So3.distance(&r, &found) < 16.0 * f64::EPSILON);
    // U·Vᵀ of a mirror in z is the mirror itself: the corrected formula gives the rotation 1 (or a half turn where σ's tie).
    let flattened = Matrix3::from_diagonal(&Vector3::new(3.0, 2.0, -1.0));
    assert!(nearest_rotation(&flattened).unwrap().angle() < 1e-15);
    // Rank two is enough, whatever the sign of the vanishing singular value.
    let plane = Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, 0.0));
    assert!(nearest_rotation(&plane).unwrap().angle() < 1e-15);

    let mirrored = -Matrix3::identity();
    assert!(matches!(nearest_rotation(&mirrored), Err(NearestRotationError::NotUnique { .. })));
    let rotated_tie = r.to_rotation_matrix().into_inner() * Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, -1.0));
    assert!(matches!(nearest_rotation(&rotated_tie), Err(NearestRotationError::NotUnique { .. })));
    let line = Vector3::new(1.0, 2.0, 3.0) * Vector3::new(-1.0, 0.5, 2.0).transpose();
    assert!(matches!(nearest_rotation(&line), Err(NearestRotationError::NotUnique { .. })));
    assert_eq!(nearest_rotation(&Matrix3::zeros()), Err(NearestRotationError::NotUnique { gap: 0.0, size: 0.0 }));
    let mut broken = Matrix3::identity();
    broken[(2, 1)] = f64::NAN;
    assert_eq!(nearest_rotation(&broken), Err(NearestRotationError::NonFinite { row: 2, column: 1 }));
}
