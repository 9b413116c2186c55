//! The laws themselves.

use std::cell::Cell;

use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use se3_geom::{LogError, Manifold};

pub(crate) const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// How many cases a space can afford, and what a number of size 1 may be off by.
pub(crate) struct Effort {
    cases: u32,
    tolerance: f64,
}
pub(crate) const CLOSED_FORM: Effort = Effort { cases: 2000, tolerance: ROUNDINGS };
pub(crate) const INTEGRATED: Effort = Effort { cases: 40, tolerance: 1e-11 };

fn run_cases<S: Strategy>(cases: u32, strategy: S, test: impl Fn(S::Value)) {
    let config = Config { cases, rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..Config::default() };
    TestRunner::new(config)
        .run(&strategy, |value| {
            test(value);
            Ok(())
        })
        .unwrap();
}

pub(crate) fn run<S: Strategy>(strategy: S, test: impl Fn(S::Value)) {
    run_cases(CLOSED_FORM.cases, strategy, test);
}

/// Laws of a Riemannian manifold. `size` bounds the numbers a point is made of, `gap` measures how far two points are apart
/// independently of the metric under test.
pub(crate) fn manifold_laws<M: Manifold, S: Strategy<Value = (M::Point, [M::Tangent; 3])>>(
    Effort { cases, tolerance }: Effort,
    m: &M,
    sample: impl Fn() -> S,
    size: impl Fn(&M::Point) -> f64,
    gap: impl Fn(&M::Point, &M::Point) -> f64,
) {
    run_cases(cases, sample(), |(p, [v, ..])| {
        let q = m.exp(&p, v);
        let scale = 1.0 + size(&p) + size(&q);
        // exp and log are inverse, and the distance is the length of the logarithm. Half a turn less 1e-9 loses no digits.
        let back = m.log(&p, &q).unwrap();
        assert!(m.norm(&p, back - v) < tolerance * scale, "log(exp) {p:?} {v:?} {back:?}");
        assert!((m.distance(&p, &q) - m.norm(&p, v)).abs() < tolerance * scale, "distance {p:?} {v:?}");
        assert!(gap(&m.exp(&p, back), &q) < tolerance * scale, "exp(log) {p:?} {v:?}");
        // The geodesic starts at p, ends at q, and its middle is half way: a wrong sign of v would fail here.
        assert!(gap(&m.geodesic(&p, &q, 0.0).unwrap(), &p) < tolerance * scale);
        assert!(gap(&m.geodesic(&p, &q, 1.0).unwrap(), &q) < tolerance * scale);
        let middle = m.geodesic(&p, &q, 0.5).unwrap();
        let half = 0.5 * m.norm(&p, v);
        assert!((m.distance(&p, &middle) - half).abs() < tolerance * scale);
        assert!((m.distance(&middle, &q) - half).abs() < tolerance * scale);
        // Bilinear and positive.
        let k = 0.37;
        assert!((m.inner(&p, v * k, v) - k * m.inner(&p, v, v)).abs() <= ROUNDINGS * m.inner(&p, v, v));
        assert!(m.inner(&p, v, -v) <= 0.0);
    });
    run_cases(cases, sample(), |(p, [v, ..])| {
        // What is no point has no logarithm, from either side.
        let nowhere = m.exp(&p, v * f64::NAN);
        assert!(!m.is_finite(&nowhere) && m.is_finite(&p), "{nowhere:?}");
        for (from, into) in [(&p, &nowhere), (&nowhere, &p), (&nowhere, &nowhere)] {
            assert_eq!(m.log(from, into).err(), Some(LogError::NotAPoint), "{from:?} {into:?}");
        }
    });
    run_cases(cases, (sample(), sample(), sample()), |((a, _), (b, _), (c, _))| {
        let scale = 1.0 + size(&a) + size(&b) + size(&c);
        assert_eq!(
            m.distance(&a, &b),
            m.distance(&b, &a),
            "symmetric to the last bit, so that edge weights do not depend on direction"
        );
        assert_eq!(m.distance(&a, &a), 0.0);
        assert!(m.distance(&a, &c) <= m.distance(&a, &b) + m.distance(&b, &c) + tolerance * scale, "triangle");
        if let Some(embedding) = m.embedding() {
            let coordinates = [&a, &b].map(|p| {
                let mut coordinates = vec![f64::NAN; embedding.dimension()];
                m.embed(p, &mut coordinates);
                coordinates
            });
            let embedded = embedding.squared_distance(&coordinates[0], &coordinates[1]).sqrt();
            assert!((embedded - m.distance(&a, &b)).abs() < tolerance * scale, "embedding {a:?} {b:?}");
        }
    });
    transport_laws(Effort { cases, tolerance }, m, sample, size, gap);
}

fn transport_laws<M: Manifold, S: Strategy<Value = (M::Point, [M::Tangent; 3])>>(
    Effort { cases, tolerance }: Effort,
    m: &M,
    sample: impl Fn() -> S,
    size: impl Fn(&M::Point) -> f64,
    gap: impl Fn(&M::Point, &M::Point) -> f64,
) {
    run_cases(cases, sample(), |(p, [along, u, v])| {
        let q = m.exp(&p, along);
        let carry = |v| m.transport(&p, along, v);
        let sizes = m.norm(&p, u) + m.norm(&p, v);
        let scale = 1.0 + size(&p) + size(&q);
        let isometry_gap = (m.inner(&q, carry(u), carry(v)) - m.inner(&p, u, v)).abs();
        assert!(isometry_gap <= tolerance * scale * sizes * sizes, "isometry {p:?} {along:?}");
        let linear_gap = m.norm(&q, carry(u * 0.7 - v * 1.3) - (carry(u) * 0.7 - carry(v) * 1.3));
        assert!(linear_gap <= tolerance * scale * sizes, "linear {p:?} {along:?}");
        let returned = m.transport(&q, -carry(along), carry(v));
        assert!(m.norm(&p, returned - v) <= tolerance * scale * sizes, "inverse {p:?} {along:?}");
        // What is carried along itself is the velocity on arrival: from there the geodesic goes on.
        let onward = m.exp(&q, carry(along) * 0.25);
        assert!(gap(&onward, &m.exp(&p, along * 1.25)) < 2.0 * tolerance * scale, "arrival {p:?} {along:?}");
    });
    // No torsion. The pole ladder, built of exp and log alone, is parallel transport up to fourth order in the size of its rungs
    // (exactly on symmetric spaces): reflect exp(p, v) in the middle of the geodesic, and its mirror image lies at −v carried
    // over. A transport that twists about the direction of travel, such as leaving body coordinates as they are on SO(3),
    // obeys all laws above but is off by second order here.
    let rung = 0.3 * m.injectivity_radius().min(1.0);
    let (coarse, fine, allowed) = (Cell::new(0.0), Cell::new(0.0), Cell::new(0.0));
    run_cases(cases, sample(), |(p, [along, v, _])| {
        if m.norm(&p, along) == 0.0 || m.norm(&p, v) == 0.0 {
            return;
        }
        let (along, v) = (along * (rung / m.norm(&p, along)), v * (rung / m.norm(&p, v)));
        let ladder_gap = |h: f64| {
            let (along, v) = (along * h, v * h);
            let (middle, q) = (m.exp(&p, along * 0.5), m.exp(&p, along));
            let mirrored = m.exp(&middle, -m.log(&middle, &m.exp(&p, v)).unwrap());
            m.norm(&q, -m.log(&q, &mirrored).unwrap() - m.transport(&p, along, v))
        };
        coarse.set(coarse.get() + ladder_gap(1.0));
        fine.set(fine.get() + ladder_gap(0.5));
        allowed.set(allowed.get() + 4.0 * tolerance * (1.0 + size(&p)));
    });
    let (coarse, fine, allowed) = (coarse.get(), fine.get(), allowed.get());
    assert!(fine < coarse / 12.0 + allowed, "pole ladder {coarse:e}, half of it {fine:e}, roundings {allowed:e}");
}
