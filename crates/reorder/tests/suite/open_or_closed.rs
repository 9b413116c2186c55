//! Whether a curve returns to its start, and when that is in doubt.
#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::{Options, Topology, TopologyChoice, Verdict, order};
use se3_geom::R2;
use se3_geom::nalgebra::Vector2;

use crate::support::Random;
use crate::support::plane::{doubted, in_plane, reasons};

#[test]
fn ends_that_come_near_leave_the_topology_in_doubt() {
    let ring = |missing: f64| {
        let step = (TAU - missing * 0.1) / 56.0;
        in_plane(&(0..57).map(|k| (step * f64::from(k)).sin_cos()).collect::<Vec<_>>())
    };
    assert_eq!((ring(1.0).topology, ring(1.0).verdict > Verdict::Ambiguous), (Topology::Closed, true));
    assert_eq!(ring(2.5).topology, Topology::Open);
    assert!(doubted(&ring(2.5), [0, 56], "may be closed"), "{}", reasons(&ring(2.5)));
    assert_eq!(
        (ring(4.0).topology, ring(4.0).verdict > Verdict::Ambiguous),
        (Topology::Open, true),
        "{}",
        reasons(&ring(4.0))
    );
}

/// An even arc is open as long as its ends are visibly farther apart than its points, and closed when they are not.
#[test]
fn an_even_arc_with_a_small_opening_is_not_called_closed() {
    for n in [12, 30, 100] {
        let circle = |opening: f64| -> Vec<(f64, f64)> {
            let step = std::f64::consts::TAU / (f64::from(n) - 1.0 + opening);
            (0..n).map(|k| (step * f64::from(k)).sin_cos()).collect()
        };
        for opening in [1.2, 1.4, 1.49] {
            let found = in_plane(&circle(opening));
            assert!(found.topology == Topology::Open && found.verdict == Verdict::Ambiguous, "{n} {opening}");
        }
        let closed = in_plane(&circle(1.05));
        assert_eq!(
            (closed.topology, closed.verdict > Verdict::Ambiguous),
            (Topology::Closed, true),
            "{n}: {}",
            reasons(&closed)
        );
        let open = in_plane(&circle(6.0));
        assert_eq!(
            (open.topology, open.verdict > Verdict::Ambiguous),
            (Topology::Open, true),
            "{n}: {}",
            reasons(&open)
        );
    }
}

/// Independent samples of a circle, one stretch of which is left out: the loop's longest gap exceeds the next by more than 3.5 mean gaps once
/// in 33 times only.
#[test]
fn a_loop_with_one_gap_that_stands_out_may_be_open() {
    let ring = |excess: f64, topology| {
        let mut random = Random::seeded(25);
        let mut gaps: Vec<f64> = (0..200).map(|_| -(0.5 - 0.5 * random.signed()).max(1e-9).ln()).collect();
        let mean = gaps.iter().sum::<f64>() / 200.0;
        gaps.push(gaps.iter().copied().fold(0.0, f64::max) + excess * mean);
        let around: f64 = gaps.iter().sum();
        let mut along = 0.0;
        let points: Vec<_> = gaps
            .iter()
            .map(|gap| {
                along += gap;
                let (s, c) = (TAU * along / around).sin_cos();
                Vector2::new(s, c)
            })
            .collect();
        order(&R2::default(), &points, &Options { topology, ..Options::default() }).unwrap()
    };
    let usual = ring(1.5, TopologyChoice::Auto);
    assert_eq!((usual.topology, usual.verdict), (Topology::Closed, Verdict::Certified), "{}", reasons(&usual));
    let wide = ring(4.5, TopologyChoice::Auto);
    assert!(doubted(&wide, [199, 200], "may be open here"), "{:?} {}", wide.topology, reasons(&wide));
    let asked = ring(4.5, TopologyChoice::Closed);
    assert_eq!((asked.topology, asked.verdict), (Topology::Closed, Verdict::Plausible), "{}", reasons(&asked));
    // Row 0 comes first, and the gap is elsewhere.
    let ratio = wide.certificate.opening.unwrap();
    assert!(ratio > 1.5 && ratio < 2.0, "{ratio}");
}
