//! A stroke drawn back over, between or beside its own points.
#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::Verdict;

use crate::support::Random;
use crate::support::plane::{in_plane, line, reasons};

/// A pen that draws back over its own line with other steps: every tree edge leads to the next point on the line, and yet the
/// order is wrong. Steps in the golden ratio fall at all fractions of the first steps, however the second pass starts.
#[test]
fn a_stroke_drawn_back_over_itself_is_not_plausible() {
    let mut random = Random::seeded(21);
    let step = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..50 {
        let offset = random.signed();
        let back = (0..30).map(|k| 37.0 + offset - step * f64::from(k));
        let found = in_plane(&line((0..40).map(f64::from).chain(back)));
        assert_eq!(found.verdict, Verdict::Ambiguous, "offset {offset}");
    }
}

/// A line drawn back over itself with the points of the way back between those of the way there: an interleaved order is the
/// shortest tree, no branch shows, and it is wholly wrong. Only the alternating gaps give it away.
#[test]
fn a_stroke_drawn_back_between_its_own_points_is_doubted() {
    for shift in [0.3, 0.4, 0.42, 0.58, 0.7] {
        for aside in [0.0, 0.05] {
            let there = (0..15).map(|k| (f64::from(k), 0.0));
            let back = (0..15).rev().map(|k| (f64::from(k) + shift, aside));
            let found = in_plane(&there.chain(back).collect::<Vec<_>>());
            assert_eq!(found.verdict, Verdict::Ambiguous, "shift {shift}");
            assert!(reasons(&found).contains("run back beside itself"), "{}", reasons(&found));
        }
    }
    // Jitter of a tenth of a step makes gaps uneven too, but in no such pattern.
    let jittered = line((0..60).map(|k| f64::from(k) + 0.1 * (f64::from(k * k) * 1.7).sin()));
    assert_ne!(in_plane(&jittered).verdict, Verdict::Ambiguous);
}

/// An arc drawn back a little beside itself, with the points of the way back in the gaps of the way there: the order from one to the other
/// is shorter, no gap alternates, and the bend of the arc hides the turns back.
#[test]
fn a_stroke_drawn_back_beside_itself_is_doubted() {
    const RADIUS: f64 = 20.0;
    let at = |way: f64, aside: f64| {
        let (sine, cosine) = (way / RADIUS).sin_cos();
        ((RADIUS + aside) * cosine, (RADIUS + aside) * sine)
    };
    let jitter = |k: u32| 0.2 * (f64::from(k * k) * 1.7).sin();
    for aside in [1e-3, 0.02, 0.05, 0.1] {
        for uneven in [0.0, 1.0] {
            let there = (0..15).map(|k| at(f64::from(2 * k) + uneven * jitter(k), 0.0));
            let back = (0..15).rev().map(|k| at(f64::from(2 * k + 1) + uneven * jitter(k + 15), aside));
            let found = in_plane(&there.chain(back).collect::<Vec<_>>());
            assert_eq!(found.verdict, Verdict::Ambiguous, "{aside} {uneven}");
        }
    }
    // The same arc once, with the same jitter, and with noise that cannot have swapped two points.
    let once = |noise: f64| {
        let points = (0..30).map(|k| at(f64::from(k) + jitter(k), noise * (f64::from(k) * 2.3).sin()));
        in_plane(&points.collect::<Vec<_>>())
    };
    assert_eq!(once(0.0).verdict, Verdict::Certified, "{}", reasons(&once(0.0)));
    assert_ne!(once(0.05).verdict, Verdict::Ambiguous, "{}", reasons(&once(0.05)));
}
