//! The order does not depend on how the points are written down: in which rows, in which frame, in which unit.
//!
//! Every threshold of a verdict is compared with a ratio of distances, an angle or a sign. Moving or scaling all points
//! changes each of those by its rounding, up to 1e-9 of itself for gaps of a hundredth of the extent, so a verdict can flip
//! only where such a number comes as near as that to its bound, or where two distances tie. Points on a line, on a grid or
//! at even steps of a symmetric curve do; the curves here have random harmonics and jittered steps, so that no such number
//! is special, and the seeds are fixed.
//!
//! Repairs are left out: they search from a start that depends on the rows, and promise no more than a good path. Where the tree
//! branches, the order is its depth-first walk, which depends on the direction; there only what is said about it is compared.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::cell::Cell;
use std::f64::consts::TAU;

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseError, TestRunner};
use reorder::{Options, Ordering, Repair, Topology, Verdict, Weight, order, order_weighted};
use se3_geom::nalgebra::{Isometry2, Isometry3, Similarity2, UnitQuaternion, Vector2, Vector3};
use se3_geom::{R3, Se2, Se3, Sim2, So3};

use crate::support::harmonics::{Harmonics, pose_curve, space_curve};
use crate::support::{Random, neighbours, shuffled, unshuffled};

const UNREPAIRED: Options = Options {
    topology: reorder::TopologyChoice::Auto,
    start: None,
    method: reorder::MethodChoice::Auto,
    repair: Repair::Off,
    denoise: false,
    components: reorder::ComponentsChoice::One,
};

/// A function drawn at random.
type Drawn<A, B> = fn(&mut Random) -> Box<dyn Fn(A) -> B>;

/// A space in which the same points can be written down in several ways.
struct Written<P> {
    /// A random curve over [0, 2π], closed.
    curve: Drawn<f64, P>,
    /// A random motion of all points that keeps their distances.
    #[expect(clippy::type_complexity, reason = "a name would say no more")]
    motion: fn(&mut Random) -> Box<dyn Fn(&P) -> P>,
    /// The same point in a unit of length that is so many times shorter; `None` where nothing is a length.
    in_unit: Option<fn(&P, f64) -> P>,
    /// The order in that unit.
    order: fn(&[P], f64) -> Ordering,
}

/// Half of the curves are open, at a random place; some are sampled densely and some far too sparsely, evenly or unevenly.
fn samples<P>(curve: &dyn Fn(f64) -> P, random: &mut Random, n: usize, closed: bool) -> Vec<P> {
    let (span, jitter) = (if closed { 1.0 } else { 0.5 + 0.2 * random.signed() }, 0.2 * (1.0 + random.signed()));
    (0..n).map(|k| curve(TAU * span * (k as f64 + jitter * random.signed()) / n as f64)).collect()
}

fn assert_same(here: &Ordering, there: &Ordering, rows: &[usize], unit: f64) -> Result<(), TestCaseError> {
    let told = |found: &Ordering| format!("{:?} {:?} {:?}", found.verdict, found.doubts, found.certificate);
    prop_assert_eq!(here.verdict, there.verdict, "{} and {}", told(here), told(there));
    let (a, b) = (here.certificate, there.certificate);
    prop_assert!((a.max_gap * unit / b.max_gap - 1.0).abs() < 1e-9, "{:?} {:?}", a, b);
    // The reach divides by a sagitta: at gaps of a hundredth of the extent 1e-4 of it, from coordinates rounded to 1e-15.
    match (a.reach, b.reach) {
        (Some(a), Some(b)) => prop_assert!((a * unit / b - 1.0).abs() < 1e-9, "{} {}", a * unit, b),
        (a, b) => prop_assert_eq!(a, b),
    }
    // A tree that branches draws no curve.
    if a.distinct > 0 {
        prop_assert_eq!(here.topology, there.topology);
        prop_assert_eq!(here.weight_stable, there.weight_stable);
        prop_assert_eq!(here.doubts.len(), there.doubts.len(), "{} and {}", told(here), told(there));
        let closed = here.topology == Topology::Closed;
        prop_assert_eq!(neighbours(&here.order, closed), neighbours(&unshuffled(&there.order, rows), closed));
    }
    Ok(())
}

fn assert_invariant<P: Clone>(written: &Written<P>, seed: u64) {
    let seen = [const { Cell::new(0) }; 3];
    let config =
        ProptestConfig { rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..ProptestConfig::with_cases(150) };
    let cases = (any::<u64>(), 20_usize..160, any::<bool>(), -3.0..6.0_f64);
    let result = TestRunner::new(config).run(&cases, |(seed, n, closed, exponent)| {
        let mut random = Random::seeded(seed);
        let (curve, motion) = ((written.curve)(&mut random), (written.motion)(&mut random));
        let unit = if written.in_unit.is_some() { 10_f64.powf(exponent) } else { 1.0 };
        let in_unit = |p: &P| written.in_unit.map_or_else(|| p.clone(), |in_unit| in_unit(p, unit));
        let points = samples(&*curve, &mut random, n, closed);
        let (same_rows, rows) = ((0..n).collect::<Vec<_>>(), random.permutation(n));
        let here = (written.order)(&points, 1.0);
        let tally = &seen[here.verdict as usize];
        tally.set(tally.get() + 1);

        let mixed = shuffled(&points, &rows);
        assert_same(&here, &(written.order)(&mixed, 1.0), &rows, 1.0)?;
        let moved: Vec<P> = points.iter().map(&motion).collect();
        assert_same(&here, &(written.order)(&moved, 1.0), &same_rows, 1.0)?;
        let scaled: Vec<P> = points.iter().map(in_unit).collect();
        assert_same(&here, &(written.order)(&scaled, unit), &same_rows, unit)?;
        let all: Vec<P> = mixed.iter().map(|p| in_unit(&motion(p))).collect();
        assert_same(&here, &(written.order)(&all, unit), &rows, unit)
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    let seen = seen.map(Cell::into_inner);
    println!("ambiguous, plausible, certified: {seen:?}");
    assert!(seen[Verdict::Ambiguous as usize] > 15 && seen[Verdict::Certified as usize] > 15, "{seen:?} say little");
}

#[test]
fn in_space() {
    let written = Written {
        curve: |random| Box::new(space_curve(random)),
        motion: |random| {
            let g = random.pose();
            Box::new(move |p| g.rotation * p + g.translation.vector)
        },
        in_unit: Some(|p, unit| p * unit),
        order: |points, _| order(&R3::default(), points, &UNREPAIRED).unwrap(),
    };
    assert_invariant::<Vector3<f64>>(&written, 1);
}

/// Half of the turned rotations are written with the other sign of their quaternion.
#[test]
fn of_rotations() {
    let written = Written {
        curve: |random| {
            let curve = space_curve(random);
            Box::new(move |t| UnitQuaternion::from_scaled_axis(curve(t)))
        },
        motion: |random| {
            let g = random.rotation();
            Box::new(move |q| {
                let turned = g * q;
                if turned.i < 0.0 { UnitQuaternion::new_unchecked(-turned.into_inner()) } else { turned }
            })
        },
        in_unit: None,
        order: |points, _| order(&So3, points, &UNREPAIRED).unwrap(),
    };
    assert_invariant::<UnitQuaternion<f64>>(&written, 2);
}

#[test]
fn of_poses() {
    let written = Written {
        curve: |random| Box::new(pose_curve(random)),
        motion: |random| {
            let g = random.pose();
            Box::new(move |p| g * p)
        },
        in_unit: Some(|p, unit| Isometry3::from_parts((p.translation.vector * unit).into(), p.rotation)),
        order: |points, unit| order_weighted::<Se3>(points, Weight::MetresPerRadian(unit), &UNREPAIRED).unwrap(),
    };
    assert_invariant::<Isometry3<f64>>(&written, 3);
}

/// Position and heading.
fn planar(random: &mut Random) -> impl Fn(f64) -> Isometry2<f64> + use<> {
    let h: [Harmonics; 3] = std::array::from_fn(|_| Harmonics::random(random));
    move |t| Isometry2::new(Vector2::new(h[0].at(t), h[1].at(t)), h[2].at(t))
}

#[test]
fn of_planar_poses() {
    let written = Written {
        curve: |random| Box::new(planar(random)),
        motion: |random| {
            let g = Isometry2::new(random.vector().xy(), 3.0 * random.signed());
            Box::new(move |p| g * p)
        },
        in_unit: Some(|p, unit| Isometry2::from_parts((p.translation.vector * unit).into(), p.rotation)),
        order: |points, unit| order_weighted::<Se2>(points, Weight::MetresPerRadian(unit), &UNREPAIRED).unwrap(),
    };
    assert_invariant::<Isometry2<f64>>(&written, 4);
}

/// The metric knows rigid motions from the left; a similarity from the left is such a motion in another unit.
#[test]
fn of_similarities() {
    let written = Written {
        curve: |random| {
            let (pose, size) = (planar(random), Harmonics::random(random));
            Box::new(move |t| Similarity2::from_isometry(pose(t), size.at(t).exp()))
        },
        motion: |random| {
            let g = Isometry2::new(random.vector().xy(), 3.0 * random.signed());
            Box::new(move |p| g * p)
        },
        in_unit: Some(|p, unit| Similarity2::from_scaling(unit) * p),
        order: |points, unit| order_weighted::<Sim2>(points, Weight::MetresPerRadian(unit), &UNREPAIRED).unwrap(),
    };
    assert_invariant::<Similarity2<f64>>(&written, 5);
}
