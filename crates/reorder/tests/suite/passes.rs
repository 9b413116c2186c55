//! Curves that run exactly over themselves: no distance tells one pass from another, but the gaps do.
#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::Verdict;

use crate::support::Random;
use crate::support::plane::{in_plane, line, reasons};

/// `count` points of an ellipse from `phase` on, `turns` times around.
fn laps(count: u32, turns: f64, phase: f64) -> Vec<(f64, f64)> {
    let at = |k: u32| TAU * (phase + turns * f64::from(k) / f64::from(count)).rem_euclid(1.0);
    (0..count).map(|k| (3.0 * at(k).cos(), 2.0 * at(k).sin())).collect()
}

#[test]
fn three_laps_of_one_loop_are_doubted_for_the_strides() {
    // 200 points in three laps fall 200/3 apart: by thirds, and a little off so that the three are not even.
    let found = in_plane(&laps(200, 3.011, 0.0));
    assert_eq!(found.verdict, Verdict::Ambiguous);
    assert!(reasons(&found).contains("every third point alone"), "{}", reasons(&found));
    assert_eq!(in_plane(&laps(67, 1.0, 0.3)).verdict, Verdict::Certified, "one lap of them");
}

/// A lap and a third: where the second pass begins, its points fall a half of a gap from those of the first.
#[test]
fn a_second_pass_that_begins_within_even_gaps_is_doubted_for_the_pace() {
    for count in [121, 122] {
        let found = in_plane(&laps(count, 1.35, 0.0));
        assert_eq!(found.verdict, Verdict::Ambiguous, "{count}");
        let why = reasons(&found);
        assert!(why.contains("as long two by two") || why.contains("every second point alone"), "{why}");
    }
}

/// On a rail at any times: the gaps are those of independent points, as where it goes along once. Once up smoothly is fine, and so are even steps.
#[test]
fn a_motion_to_and_fro_along_a_rail_is_doubted() {
    let mut random = Random::seeded(61);
    let found = in_plane(&line((0..60).map(|_| random.signed())));
    assert_eq!(found.verdict, Verdict::Ambiguous);
    assert!(reasons(&found).contains("to and fro along it"), "{}", reasons(&found));
    let up = in_plane(&line((0..40).map(|k| (0.07 * f64::from(k) - 1.4).sin())));
    assert_ne!(up.verdict, Verdict::Ambiguous, "{}", reasons(&up));
    assert_eq!(in_plane(&line((0..40).map(f64::from))).verdict, Verdict::Certified);
}

/// Two strokes of a line with a gap between them of twice the others: they may have been drawn from either end each.
#[test]
fn a_line_with_a_step_left_out_is_not_certified() {
    let found = in_plane(&line((0..20).map(f64::from).chain((0..20).map(|k| f64::from(k) + 21.0))));
    assert_eq!(found.verdict, Verdict::Plausible, "{}", reasons(&found));
}

/// A pen that sets out the wrong way and turns back over its own line, on a curve that bends.
#[test]
fn a_short_turn_back_over_the_line_is_doubted_for_the_jerks() {
    // Slow at first, then along at steps that grow.
    let way = |k: u32| 0.012 * (f64::from(k) - 4.3).powi(2) * (f64::from(k) - 4.3).signum();
    let bent = |s: f64| (10.0 * (0.1 * s).sin(), 10.0 * (1.0 - (0.1 * s).cos()));
    let turned: Vec<(f64, f64)> = (0..40).map(|k| bent(if k < 4 { -0.77 * way(k) } else { way(k) })).collect();
    let found = in_plane(&turned);
    assert_eq!(found.verdict, Verdict::Ambiguous);
    assert!(reasons(&found).contains("jump between long and short"), "{}", reasons(&found));
    let along: Vec<(f64, f64)> = (0..40).map(|k| bent(way(k + 5))).collect();
    assert_ne!(in_plane(&along).verdict, Verdict::Ambiguous, "{}", reasons(&in_plane(&along)));
}
