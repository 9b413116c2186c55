//! The figures of curves and surfaces: their numbers, and that they are drawn. `data/geodesics_bvp.json` holds scipy's lengths.
#![allow(clippy::unwrap_used, clippy::duplicate_mod)]

#[allow(dead_code)]
#[path = "../examples/figure_4_1.rs"]
mod figure_4_1;
#[allow(dead_code)]
#[path = "../examples/figure_4_2.rs"]
mod figure_4_2;
#[allow(dead_code)]
#[path = "../examples/figure_4_5.rs"]
mod figure_4_5;
#[allow(dead_code)]
#[path = "../examples/figure_5_5.rs"]
mod figure_5_5;

use std::error::Error;
use std::path::Path;

use nalgebra::Vector2;
use se3_geom::nalgebra;

fn scipy(name: &str) -> f64 {
    let table: serde_json::Value = serde_json::from_str(include_str!("data/geodesics_bvp.json")).unwrap();
    table[name].as_f64().unwrap()
}

/// The numbers of points of the polylines that a drawing writes, all of whose numbers must be numbers.
fn drawn(draw: impl Fn(&Path) -> Result<(), Box<dyn Error>>) -> Vec<usize> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figure.svg");
    draw(&path).unwrap();
    let svg = std::fs::read_to_string(&path).unwrap();
    assert!(svg.contains("</svg>") && svg.contains("<text") && !svg.contains("NaN") && !svg.contains("inf"));
    let lines = svg.split("<polyline").skip(1).map(|line| {
        let points = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        points.split_whitespace().inspect(|pair| assert!(pair.split(',').all(|x| x.parse::<f64>().is_ok()))).count()
    });
    lines.collect()
}

fn count(lines: &[usize], points: usize) -> usize {
    lines.iter().filter(|&&n| n == points).count()
}

#[test]
fn figure_4_1_straightens_the_curve() {
    let numbers = figure_4_1::compute().unwrap();
    assert!(numbers.lengths.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-15)));
    assert_eq!(numbers.stages.len(), 6);
    let (first, last) = (&numbers.stages[0], &numbers.stages[5]);
    // A curve far from straight, and after t = 2 L² of the decay exp(−π²t/L²), L² = 2: 1e-4 of an amplitude of 0.3, squared.
    assert!(first.length > 1.3 * 2f64.sqrt());
    assert!((last.length - 2f64.sqrt()).abs() < 1e-6 && last.time > 1.99, "{}", last.length);
    for stage in &numbers.stages {
        assert_eq!((stage.points[0], stage.points[figure_4_1::EDGES]), (Vector2::zeros(), Vector2::new(1.0, 1.0)));
    }
    let lines = drawn(|path| figure_4_1::draw(&numbers, path));
    assert_eq!(count(&lines, figure_4_1::EDGES + 1), 6);
}

/// scipy's tolerance is 1e-10 on the relative residual; its starts agree to 3e-14 in the length.
#[test]
fn figure_4_2_has_the_lengths_of_scipy() {
    let numbers = figure_4_2::compute().unwrap();
    for (case, name) in [(&numbers.saddle, "example_4_2"), (&numbers.egg_box, "example_4_3")] {
        assert!((case.geodesic_length - scipy(name)).abs() < 1e-11, "{name} {}", case.geodesic_length);
        assert!(case.guess_length > case.geodesic_length + 0.05, "{name} {}", case.guess_length);
        let [start, end] = [0, figure_4_2::PIECES].map(|i| (case.guess[i] - case.geodesic[i]).norm());
        assert!(start < 1e-14 && end < 1e-9, "{name}: {start} {end}");
        // A polygon of n chords of a curve with curvature ≤ κ is short by L³κ²/(24n²) at most; κ ≤ 1 on both.
        let polygon: f64 = case.geodesic.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let most = case.geodesic_length.powi(3) / (24.0 * (figure_4_2::PIECES as f64).powi(2));
        assert!((0.0..most).contains(&(case.geodesic_length - polygon)), "{name} {polygon}");
    }
    let lines = drawn(|path| figure_4_2::draw(&numbers, path));
    // Twice 50 grid lines of 61 points; a guess and a geodesic each.
    assert_eq!((count(&lines, 61), count(&lines, figure_4_2::PIECES + 1)), (100, 4));
}

/// The hill of `data/monge_bvp.json`: two shortest paths, mirror images. First order at h = 6/160 m: 5 m · h/8.
#[test]
fn figure_4_5_has_two_shortest_paths() {
    let table: serde_json::Value = serde_json::from_str(include_str!("data/monge_bvp.json")).unwrap();
    let exact = table["cases"][5]["length"].as_f64().unwrap();
    assert_eq!((&table["cases"][5]["from"][0], &table["cases"][5]["from"][1]), (&(-2).into(), &0.into()));
    let numbers = figure_4_5::compute().unwrap();
    let error = 5.0 * 6.0 / 160.0 / 8.0;
    assert!((numbers.distance - exact).abs() < error, "{} {exact}", numbers.distance);
    for (path, length) in numbers.paths.iter().zip(numbers.lengths) {
        assert!((length - exact).abs() < error, "{length} {exact}");
        let (first, last) = (path[0].xy(), path[path.len() - 1].xy());
        assert_eq!([first, last], figure_4_5::ENDS);
    }
    assert!((numbers.lengths[0] - numbers.lengths[1]).abs() < 1e-9);
    let farthest = |side: usize| {
        numbers.paths[side].iter().map(|point| point.y).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
    };
    assert!(farthest(0) < -1.0 && farthest(1) > 1.0);
    // A front at time t is longer than the circle of the plane only if it has climbed; each piece is one cell long at most.
    for (time, pieces) in &numbers.fronts {
        assert!(pieces.len() > 50 && pieces.iter().all(|[a, b]| (b - a).xy().norm() < 0.054), "{time}");
    }
    let lines = drawn(|path| figure_4_5::draw(&numbers, path));
    for path in &numbers.paths {
        assert!(count(&lines, path.len()) >= 2);
    }
    let pieces: usize = numbers.fronts.iter().map(|(_, pieces)| pieces.len()).sum();
    // The axes have lines of two points too.
    assert!(count(&lines, 2) > pieces && count(&lines, 61) == 62, "{} {pieces}", count(&lines, 2));
}

/// Farther from the medial axis than the curve is long: 2π.
#[test]
fn figure_5_5_has_its_medial_axis_out_of_reach() {
    let numbers = figure_5_5::compute().unwrap();
    assert!((numbers.start - nalgebra::Vector3::new(1.0, 0.0, 1.0629)).norm() < 1e-15);
    // The chords of 200 pieces are short by π²/(6·200²) of the circle, 4.2e-5.
    let polygon: f64 = numbers.circle.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    assert!((0.0..4.2e-5).contains(&(1.0 - polygon / numbers.circle_length)));
    assert!((numbers.normal_length - scipy("figure_5_5")).abs() < 1e-10, "{}", numbers.normal_length);
    assert!((numbers.normal_length - scipy("figure_5_5_by_quadrature")).abs() < 1e-10);
    assert!(numbers.normal_length > numbers.circle_length);
    // The flow's 1e-13 a step, grown along 7 m of a surface of curvature 50.
    assert!(numbers.worst_miss < 1e-9, "{:e}", numbers.worst_miss);
    assert!(
        numbers.normal.iter().all(|point| point.y.abs() < 1e-12) && numbers.normal[figure_5_5::PIECES].norm() < 1e-9
    );
    // No other way is shorter. The grid's error is of first order: 7 m · h/8·|k − 1/u|, at h = 0.01 m and k up to 1/0.2 m.
    let by_front = numbers.least_distance_by_front;
    assert!((by_front - numbers.normal_length).abs() < 0.04 && by_front > numbers.circle_length, "{by_front}");
    let lines = drawn(|path| figure_5_5::draw(&numbers, path));
    assert_eq!((count(&lines, 61), count(&lines, figure_5_5::PIECES + 1)), (62, 2));
}
