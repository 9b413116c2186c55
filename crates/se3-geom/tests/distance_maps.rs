//! Distance maps by front propagation (thesis §4.2.1) against exact distances and against geodesics by shooting.
#![allow(clippy::unwrap_used)]

mod surfaces;

use nalgebra::{Vector2, Vector3};
use se3_geom::{DistanceMap, FrontError, Manifold, SurfaceGrid, SurfaceGridError, nalgebra};
use surfaces::{egg_box, hill, six_bumps};

fn v(x: f64, y: f64) -> Vector2<f64> {
    Vector2::new(x, y)
}

/// Points spread over a rectangle, none of them a node.
fn spread(low: f64, high: f64) -> impl Iterator<Item = Vector2<f64>> {
    (1..60)
        .map(move |k| [0.7548776662466927, 0.5698402909980532].map(|a| low + (high - low) * (a * f64::from(k)).fract()))
        .map(Vector2::from)
}

fn length(grid: &SurfaceGrid, path: &[Vector2<f64>]) -> f64 {
    let points: Vec<Vector3<f64>> = path.iter().map(|place| grid.embed(place).unwrap()).collect();
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

/// Distances on a tilted plane are those of space, and shortest paths straight, on a grid with cells three times as long as wide.
#[test]
fn a_plane_is_exact() {
    let height = |x: f64, y: f64| 0.3 + 1.7 * x - 0.9 * y;
    let grid = SurfaceGrid::sample(v(-1.0, -1.0), v(1.0, 1.0), [41, 15], height).unwrap();
    for source in [v(0.0, 0.0), v(-1.0, 1.0), v(0.313, -0.677), v(0.05, 0.222)] {
        let map = DistanceMap::from_source(&grid, source).unwrap();
        assert_eq!(map.at(&source).unwrap(), 0.0);
        for point in spread(-1.0, 1.0) {
            let exact = (grid.embed(&point).unwrap() - grid.embed(&source).unwrap()).norm();
            // Rounding, squared and divided by an edge over which the front comes: 2e-16 · (u/h) a step, 40 steps.
            assert!((map.at(&point).unwrap() - exact).abs() < 1e-11, "{point} {exact}");
            let path = map.path_from(&point).unwrap();
            assert_eq!((path[0], *path.last().unwrap()), (point, source));
            assert!((length(&grid, &path) - exact).abs() < 1e-11);
        }
    }
}

/// The greatest error of the map and of its paths' lengths at points between the nodes.
fn errors(grid: &SurfaceGrid, source: Vector2<f64>, side: f64, exact: impl Fn(&Vector2<f64>) -> f64) -> [f64; 2] {
    let map = DistanceMap::from_source(grid, source).unwrap();
    spread(-side, side).fold([0.0, 0.0], |[worst, worst_path]: [f64; 2], point| {
        let exact = exact(&point);
        let path = length(grid, &map.path_from(&point).unwrap());
        [worst.max((map.at(&point).unwrap() - exact).abs()), worst_path.max((path - exact).abs())]
    })
}

/// A circular cylinder of radius 2 m, oblique to the grid, rolled out. Fronts on it are circles, so what is left is the
/// surface's own error: heights between nodes miss h²·(z_xx + z_yy)/8 ≤ 0.17·h², at the source and at the goal, of which the
/// slope, below 1, lets its sine (0.7) pass: 0.24·h² in all.
#[test]
fn a_cylinder_is_of_second_order() {
    let height = |x: f64, y: f64| (4.0 - (0.6 * x + 0.8 * y).powi(2)).sqrt();
    let rolled_out = |p: &Vector2<f64>| v(2.0 * (0.3 * p.x + 0.4 * p.y).asin(), 0.8 * p.x - 0.6 * p.y);
    let source = v(-0.4, -0.53);
    for nodes in [21, 41, 81] {
        let spacing = 2.0 / (nodes - 1) as f64;
        let grid = SurfaceGrid::sample(v(-1.0, -1.0), v(1.0, 1.0), [nodes, nodes], height).unwrap();
        let worst = errors(&grid, source, 1.0, |p| (rolled_out(p) - rolled_out(&source)).norm());
        assert!(worst.iter().all(|&error| error < 0.24 * spacing * spacing), "{nodes} {worst:?}");
    }
}

/// Egg box (Example 4.3) and hill against geodesics by shooting, which share nothing with the front but the height. A step of
/// h meets a front of curvature k where the update draws 1/u: h²/8·|k − 1/u| a step, h/8·|k − 1/u| a metre, so first order.
/// Beyond the cut locus too: over half of the points are.
#[test]
fn errors_halve_with_the_spacing() {
    let (box_of_eggs, hill) = (egg_box(), hill());
    let egg_height = |x: f64, y: f64| box_of_eggs.embed(&v(x, y)).z;
    let hill_height = |x: f64, y: f64| hill.embed(&v(x, y)).z;
    let both = |nodes: usize| {
        let sampled = |height: &dyn Fn(f64, f64) -> f64| {
            SurfaceGrid::sample(v(-3.0, -3.0), v(3.0, 3.0), [nodes, nodes], height).unwrap()
        };
        let (on_eggs, on_hill) = (v(-3.0, -3.0), v(-2.0, 0.1));
        let egg_errors = errors(&sampled(&egg_height), on_eggs, 3.0, |p| box_of_eggs.distance(&on_eggs, p));
        let hill_errors = errors(&sampled(&hill_height), on_hill, 3.0, |p| hill.distance(&on_hill, p));
        [egg_errors, hill_errors]
    };
    let [coarse, middle, fine] = [41, 81, 161].map(both);
    for surface in 0..2 {
        let order = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| (a[surface][0] / b[surface][0]).log2();
        let orders = [order(coarse, middle), order(middle, fine)];
        assert!(orders.iter().all(|order| (0.75..1.25).contains(order)), "{surface}: {orders:?} {fine:?}");
        assert!(order(middle, fine) > 0.9, "{surface}: {orders:?}");
        // |k − 1/u| of about 1/m on average over 9 m: 9·h/8 at h = 6/160 m would be 0.04. A tenth of it is seen.
        assert!(fine[surface][0] < 0.005, "{surface}: {fine:?}");
        // Lengths of paths depend on their errors squared, but are chords of the grid's surface.
        assert!(fine[surface][1] < fine[surface][0], "{surface}: {fine:?}");
    }
}

/// Example 4.3 once more, by its end points on fine grid lines.
#[test]
fn example_4_3_by_propagation() {
    let patch = egg_box();
    let grid = SurfaceGrid::sample(v(-3.0, -3.0), v(3.0, 3.0), [201, 201], |x, y| patch.embed(&v(x, y)).z).unwrap();
    let [there, back] = [(v(-3.0, -3.0), v(3.0, 3.0)), (v(3.0, 3.0), v(-3.0, -3.0))].map(|(source, goal)| {
        let map = DistanceMap::from_source(&grid, source).unwrap();
        assert_eq!(map.at(&goal).unwrap(), map.at_node(if goal.x > 0.0 { [200, 200] } else { [0, 0] }).unwrap());
        (map.at(&goal).unwrap(), map.path_from(&goal).unwrap())
    });
    let exact = patch.distance(&v(-3.0, -3.0), &v(3.0, 3.0));
    // h/8·|k − 1/u| a metre as above: 0.034 m at most, a tenth of it as a rule.
    assert!((there.0 - exact).abs() < 3.4e-3 && (back.0 - exact).abs() < 3.4e-3, "{} {} {exact}", there.0, back.0);
    // x → −x, y → −y turns the surface about the x axis of space: the two maps are mirror images.
    assert!((there.0 - back.0).abs() < 1e-12 * exact);
    assert!((length(&grid, &there.1) - length(&grid, &back.1)).abs() < 1e-9 * exact);
    // The geodesic itself, sampled: the path stays within the square root of the relative error in length times the length.
    let near = (2.0 * 3.4e-3 * exact).sqrt();
    for k in 1..10 {
        let on_way = patch.geodesic(&v(-3.0, -3.0), &v(3.0, 3.0), f64::from(k) / 10.0).unwrap();
        let closest = there.1.iter().map(|place| (place - on_way).norm()).fold(f64::INFINITY, f64::min);
        assert!(closest < near, "{k}: {closest}");
    }
}

/// Round the hill, not over it: over the top the way is longer by more than half a metre.
#[test]
fn the_shortest_path_goes_round_the_hill() {
    let patch = hill();
    let grid = SurfaceGrid::sample(v(-3.0, -3.0), v(3.0, 3.0), [121, 121], |x, y| patch.embed(&v(x, y)).z).unwrap();
    let (source, goal) = (v(-2.0, 0.0), v(2.0, 0.1));
    let map = DistanceMap::from_source(&grid, source).unwrap();
    let path = map.path_from(&goal).unwrap();
    let highest = path.iter().map(|place| grid.embed(place).unwrap().z).fold(0.0, f64::max);
    let farthest = path.iter().map(|place| place.y).fold(0.0, f64::max);
    let exact = patch.distance(&source, &goal);
    // First order: 5 m · h/8 at h = 0.05 m.
    assert!((map.at(&goal).unwrap() - exact).abs() < 0.03);
    assert!((length(&grid, &path) - exact).abs() < 0.03);
    // exp(−1) of the height is passed at a metre from the top.
    assert!(highest < 2.0 * (-1.0_f64).exp() && farthest > 1.0, "{highest} {farthest}");
}

/// A plane with a slit from below: paths bend about its two upper corners. Around each the front is a circle about the corner,
/// joined to one about the source: h/8·(1/r − 1/u) a metre at r from a corner, so h/8·ln(r/h) or 0.012 m a corner at most.
#[test]
fn paths_lead_around_holes() {
    let height = |x: f64, y: f64| if (x - 0.5).abs() < 0.01 && y < 0.69 { f64::NAN } else { 0.5 * x };
    let grid = SurfaceGrid::sample(v(0.0, 0.0), v(1.0, 1.0), [41, 41], height).unwrap();
    // The cells around the nodes at x = 0.5, y ≤ 0.675 are missing.
    let corners = [v(0.475, 0.7), v(0.525, 0.7)];
    let (source, goal) = (v(0.11, 0.2), v(0.93, 0.13));
    let point = |p: &Vector2<f64>| Vector3::new(p.x, p.y, 0.5 * p.x);
    let stops = [source, corners[0], corners[1], goal].map(|p| point(&p));
    let exact: f64 = stops.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let map = DistanceMap::from_source(&grid, source).unwrap();
    let (found, path) = (map.at(&goal).unwrap(), map.path_from(&goal).unwrap());
    assert!((found - exact).abs() < 0.012, "{found} {exact}");
    let along = length(&grid, &path);
    assert!(along > exact - 1e-9 && along < exact + 0.012, "{along} {exact}");
    assert!(corners.iter().all(|corner| path.iter().any(|place| (place - corner).norm() < 1e-12)));
    let in_the_slit = v(0.51, 0.3);
    assert!(matches!(map.at(&in_the_slit), Err(FrontError::OffSurface { x: 0.51, y: 0.3 })));
    assert!(matches!(DistanceMap::from_source(&grid, in_the_slit), Err(FrontError::OffSurface { .. })));
    assert!(matches!(map.path_from(&v(0.2, 1.01)), Err(FrontError::OffSurface { .. })));
    assert!(matches!(map.at(&v(f64::NAN, 0.0)), Err(FrontError::OffSurface { .. })));
    // A wall right across.
    let cut =
        SurfaceGrid::sample(
            v(0.0, 0.0),
            v(1.0, 1.0),
            [41, 41],
            |x, _| if (x - 0.5).abs() < 0.01 { f64::NAN } else { 0.0 },
        );
    let cut = cut.unwrap();
    let map = DistanceMap::from_source(&cut, source).unwrap();
    assert!(matches!(map.at(&goal), Err(FrontError::Unreached { .. })));
    assert!(matches!(map.path_from(&goal), Err(FrontError::Unreached { .. })));
    assert_eq!((map.at_node([40, 0]), map.at_node([41, 0])), (Some(f64::INFINITY), None));
}

/// What holds of any distance, on surfaces as rough as a heap of stones: steps of up to 0.6 m between nodes
/// 0.1 m apart.
#[test]
fn rough_surfaces_have_distances_too() {
    for seed in 0..20_u32 {
        let height = |x: f64, y: f64| 0.3 * ((x * 127.1 + y * 311.7 + f64::from(seed)).sin() * 43758.5453).fract();
        let grid = SurfaceGrid::sample(v(0.0, 0.0), v(2.4, 1.9), [25, 20], height).unwrap();
        let source = v(0.1 + 0.1 * f64::from(seed), 1.02);
        let map = DistanceMap::from_source(&grid, source).unwrap();
        let at = |column: usize, row: usize| (map.at_node([column, row]).unwrap(), grid.node_place([column, row]));
        let apart = |p: &Vector2<f64>, q: &Vector2<f64>| (grid.embed(p).unwrap() - grid.embed(q).unwrap()).norm();
        for column in 0..25 {
            for row in 0..20 {
                let (time, place) = at(column, row);
                // Not shorter than in the plane below, but for the dips of circles between nodes; and 1-Lipschitz along edges.
                assert!(time > 0.8 * (place - source).norm(), "{seed} {place}");
                for (beside, next) in [at((column + 1).min(24), row), at(column, (row + 1).min(19))] {
                    assert!((time - beside).abs() <= apart(&place, &next) * (1.0 + 1e-12));
                }
            }
        }
        for point in spread(0.1, 1.8) {
            assert_eq!(*map.path_from(&point).unwrap().last().unwrap(), source);
        }
    }
}

/// 0.3 is the node in column 3 although 0.3/0.1 is less than 3 in numbers: the hole that ends there does not swallow it.
#[test]
fn a_point_meant_to_lie_on_a_line_lies_on_it() {
    let height = |x: f64, _: f64| if (x - 0.2).abs() < 0.01 { f64::NAN } else { x };
    let grid = SurfaceGrid::sample(v(0.0, 0.0), v(0.4, 1.0), [5, 3], height).unwrap();
    assert!((grid.embed(&v(0.3, 0.7)).unwrap() - Vector3::new(0.3, 0.7, 0.3)).norm() < 1e-15);
    assert_eq!(grid.embed(&v(0.299, 0.7)), None);
}

/// Six bumps and no radius stated, so that the logarithm is only the best geodesic found: never longer than a path that the
/// distance map knows, whose length on the smooth surface bounds the distance from above. And as long one way as the other.
#[test]
fn shooting_finds_no_longer_way_than_propagation() {
    let patch = six_bumps();
    let grid = SurfaceGrid::sample(v(-3.0, -3.0), v(3.0, 3.0), [121, 121], |x, y| patch.embed(&v(x, y)).z).unwrap();
    // Chords of a hundredth of a piece of path: 1e-6 of it short at most, at curvatures below 10 and pieces of 0.05.
    let smooth_length = |path: &[Vector2<f64>]| -> f64 {
        let at = |pair: &[Vector2<f64>], k: u32| patch.embed(&pair[0].lerp(&pair[1], f64::from(k) / 100.0));
        path.windows(2).map(|pair| (0..100).map(|k| (at(pair, k + 1) - at(pair, k)).norm()).sum::<f64>()).sum()
    };
    for source in [v(-2.5, -0.4), v(-2.3, 2.2), v(0.3, -2.6)] {
        let map = DistanceMap::from_source(&grid, source).unwrap();
        for goal in [v(2.4, 0.2), v(2.2, 2.3), v(0.4, 2.4), v(2.3, -2.1), v(-2.0, -2.4)] {
            let bound = smooth_length(&map.path_from(&goal).unwrap()) * (1.0 + 1e-6);
            let (there, back) = (patch.log(&source, &goal).unwrap(), patch.log(&goal, &source).unwrap());
            let (there, back) = (patch.norm(&source, there), patch.norm(&goal, back));
            assert!(there <= bound, "{source} {goal}: {there} {bound}");
            assert!((there - back).abs() < 1e-9 * there, "{source} {goal}: {there} {back}");
            assert!((patch.distance(&source, &goal) - there).abs() < 1e-9 * there);
        }
    }
}

/// The same length from both ends, on the egg box at up to ten times the radius that is claimed.
#[test]
fn geodesics_are_as_long_there_as_back() {
    let patch = egg_box();
    for (p, q) in [
        (v(-10.0, -7.0), v(10.0, 9.0)),
        (v(-6.0, 2.0), v(5.0, -3.0)),
        // Found from one end only, and longer from the other.
        (v(17.63393977, -22.28624286), v(-7.64685, -27.636456)),
        (v(2.926599748, 11.904174599), v(-18.4965, 12.62616)),
        (v(-13.0, -8.0), v(12.0, 9.0)),
    ] {
        let (there, back) = (patch.log(&p, &q).unwrap(), patch.log(&q, &p).unwrap());
        let (there, back) = (patch.norm(&p, there), patch.norm(&q, back));
        assert!((there - back).abs() < 1e-9 * there, "{p} {q}: {there} {back}");
        assert!(there > (q - p).norm());
    }
}

/// Grids that are none.
#[test]
fn refuses_what_is_no_grid() {
    let (zero, one) = (v(0.0, 0.0), v(1.0, 1.0));
    let few = SurfaceGrid::new(zero, one, [1, 5], vec![0.0; 5]).unwrap_err();
    assert_eq!(few, SurfaceGridError::TooFewNodes { columns: 1, rows: 5 });
    let short = SurfaceGrid::new(zero, one, [3, 5], vec![0.0; 14]).unwrap_err();
    assert_eq!(short, SurfaceGridError::HeightCount { columns: 3, rows: 5, given: 14 });
    let [most, root] = [usize::MAX, 1 << 40];
    for (columns, rows) in [(2, most), (most, 2), (root, root), (1 << 20, 1 << 40)] {
        let refused = SurfaceGrid::sample(zero, one, [columns, rows], |_, _| 0.0);
        assert_eq!(refused, Err(SurfaceGridError::TooManyNodes { columns, rows }));
    }
    let few = SurfaceGrid::sample(zero, one, [1, most], |_, _| 0.0);
    assert_eq!(few, Err(SurfaceGridError::TooFewNodes { columns: 1, rows: most }));
    for opposite in [v(1.0, 0.0), v(-1.0, 1.0), v(f64::NAN, 1.0), v(f64::INFINITY, 1.0)] {
        let refused = SurfaceGrid::new(zero, opposite, [2, 2], vec![0.0; 4]);
        assert!(matches!(refused, Err(SurfaceGridError::Corners { .. })), "{opposite}");
    }
}
