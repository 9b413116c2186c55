//! The thesis's experiments: that each comes out, and that its picture is drawn.
#![allow(clippy::unwrap_used)]
// Every experiment brings the modules that draw and shuffle.
#![allow(clippy::duplicate_mod)]

#[allow(dead_code)]
#[path = "../../examples/figure_7_1.rs"]
mod figure_7_1;
#[allow(dead_code)]
#[path = "../../examples/figures_2_1_2_2_5_4.rs"]
mod figures_2_1_2_2_5_4;
#[allow(dead_code)]
#[path = "../../examples/figures_7_2_to_7_4.rs"]
mod figures_7_2_to_7_4;
#[allow(dead_code)]
#[path = "../../examples/figures_7_5_to_7_7.rs"]
mod figures_7_5_to_7_7;
#[allow(dead_code)]
#[path = "../../examples/figures_7_8_to_7_9.rs"]
mod figures_7_8_to_7_9;
#[allow(dead_code)]
#[path = "../../examples/success_by_epsilon.rs"]
mod success_by_epsilon;

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use reorder::Verdict;

/// Lines of two pixels, which are those of the experiment, and dots; every number is one.
fn drawn(draw: impl Fn(&Path) -> Result<(), Box<dyn Error>>) -> (usize, usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figure.svg");
    draw(&path).unwrap();
    let svg = std::fs::read_to_string(&path).unwrap();
    assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN") && !svg.contains("inf"));
    let lines = svg.lines().filter(|line| line.contains("<polyline") && line.contains("stroke-width=\"2\"")).count();
    (lines, svg.matches("<circle").count())
}

#[test]
fn curves_on_the_sphere_come_back_in_order() {
    let curves = [figure_7_1::compute(3.0, 60).unwrap(), figure_7_1::compute(10.0, 160).unwrap()];
    assert!(curves.iter().all(|curve| curve.recovered && curve.ordering.verdict != Verdict::Ambiguous));
    // The wavier curve needs the greater density: from as few samples its order is not told, and that is said.
    let sparse = figure_7_1::compute(10.0, 30).unwrap();
    assert!(!sparse.recovered && sparse.ordering.verdict == Verdict::Ambiguous);
    // A panel: twelve meridians, the order and its entry in the legend.
    assert_eq!(drawn(|path| figure_7_1::draw(&curves, path)), (2 * 14, 60 + 160));
}

/// A bright pixel on the rim is in or out by chance: of some 124 of them the area is uncertain by √124·0.3 ≈ 3. The overlap
/// changes by b²·cos θ/sin² θ ≥ 145 pixels a radian up to 67.5°, the greatest turn against the nearer of two known directions:
/// 1.2°, twice that with both of the areas that are compared.
#[test]
fn video_frames_are_read_and_ordered() {
    let numbers = figures_7_2_to_7_4::compute().unwrap();
    assert!(numbers.recovered);
    for (estimate, pose) in numbers.estimates.iter().zip(&numbers.truth) {
        let apart = (estimate.direction_rad - pose.rotation.angle()).abs() % PI;
        assert!(apart.min(PI - apart) < 2.4_f64.to_radians(), "{} {}", estimate.direction_rad, pose.rotation.angle());
        // A mean over 792 pixels, of which 124 are uncertain by a third of a pixel each.
        assert!((estimate.position - pose.translation.vector).norm() < 0.3);
    }
    // Thesis §7.2: b²/sin θ for θ large enough that each rectangle sticks out of the other's long sides.
    let (sides, angle) = ([44.0, 18.0], 1.2_f64);
    assert!((figures_7_2_to_7_4::overlap_area(sides, angle) - 18.0 * 18.0 / angle.sin()).abs() < 1e-10);
    assert!((figures_7_2_to_7_4::overlap_area(sides, 0.0) - 44.0 * 18.0).abs() < 1e-10);
    assert_eq!(drawn(|path| figures_7_2_to_7_4::draw(&numbers, path)), (16 + 16 + 2, 0));
}

#[test]
fn frames_in_space_are_ordered_and_interpolated() {
    let numbers = figures_7_5_to_7_7::compute().unwrap();
    assert!(numbers.recovered && numbers.ordering.verdict != Verdict::Ambiguous);
    // Roundings of positions of 2 m.
    assert!(numbers.miss < 8.0 * f64::EPSILON * 2.0, "{:e}", numbers.miss);
    assert_eq!(numbers.interpolated.each_ref().map(Vec::len), [91, 361]);
    // The curve stays on the loop of 2 m: a cubic through 30 poses misses a circle by (2π/30)⁴/384 of the radius.
    for pose in numbers.interpolated.iter().flatten() {
        assert!((pose.translation.vector.xy().norm() - 2.0).abs() < 1e-3);
    }
    assert_eq!(drawn(|path| figures_7_5_to_7_7::draw(&numbers, path)), (3 * (30 + 91 + 361) + 2, 0));
}

#[test]
fn instances_with_scaling_are_ordered() {
    let numbers = figures_7_8_to_7_9::compute().unwrap();
    assert!(numbers.recovered && numbers.max_gap < 10f64.sqrt() * PI);
    assert_eq!(drawn(|path| figures_7_8_to_7_9::draw(&numbers, path)), (2 * 24 + 2, 0));
}

#[test]
fn sparse_samples_are_wrong_and_doubted_dense_ones_right() {
    let numbers = figures_2_1_2_2_5_4::compute().unwrap();
    for (sample, dense) in numbers.samples.iter().zip([false, true, false, true]) {
        assert_eq!(sample.recovered, dense, "{}", sample.name);
        assert_eq!(sample.ordering.verdict != Verdict::Ambiguous, dense, "{}", sample.name);
        assert_eq!(sample.ordering.doubts.is_empty(), dense, "{}", sample.name);
    }
    // In space the circle's reach is its radius r: ε = gap/(2r) = sin(π/24) up to the bend between three samples, whatever r.
    let in_space = (PI / 24.0).sin();
    for (theta, space, sphere) in &numbers.circles {
        assert!((space.unwrap() / in_space - 1.0).abs() < 0.01, "{space:?}");
        // On the sphere it is the arc θ from the circle to its centre, its medial axis (thesis Figure 5.4): the same samples are
        // denser, the more so the more the sphere bends along. No such arc bounds a great circle, which is a geodesic.
        let gap = 2.0 * (theta.sin() * in_space).asin();
        let on_sphere = gap / (2.0 * theta);
        let great = *theta > 1.5;
        assert!(great || (sphere.unwrap() / on_sphere - 1.0).abs() < 0.01, "{sphere:?} {on_sphere}");
        assert!(sphere.unwrap() < space.unwrap());
    }
    let (lines, dots) = drawn(|path| figures_2_1_2_2_5_4::draw(&numbers, path));
    assert_eq!((lines, dots), (2 * 4, 8 + 80 + 12 + 240));
}

/// Dense samples (ε < 1) come out right, which is the theorem; sparse ones less often, and the chain less often still.
#[test]
fn success_falls_with_epsilon() {
    let numbers = success_by_epsilon::compute(25).unwrap();
    let all = |k: usize| {
        let right: f64 = (0..8).map(|class| numbers.shares[class][k] * numbers.cases[class] as f64).sum();
        right / numbers.cases.iter().sum::<usize>() as f64
    };
    assert!(numbers.cases.iter().sum::<usize>() >= 18);
    // Classes 0 to 2 end at 0.25·32^(3/8) = 0.92.
    assert!((0..3).all(|class| numbers.cases[class] == 0 || numbers.shares[class][0] == 1.0), "{:?}", numbers.shares);
    assert!(all(0) > all(2), "{} {}", all(0), all(2));
    assert_eq!(numbers.silently_wrong, 0);
    let (lines, _) = drawn(|path| success_by_epsilon::draw(&numbers, path));
    assert_eq!(lines, 8, "a line a method, and its entry in the legend");
}
