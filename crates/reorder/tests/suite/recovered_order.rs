//! The order on curves whose true order is known.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::{Options, Ordering, Repair, Topology, TopologyChoice, Verdict, order, order_poses};
use se3_geom::nalgebra::{UnitQuaternion, Vector3};
use se3_geom::{Manifold, Pose, R3, Se3, So3};

use crate::support::permutations::permutations;
use crate::support::{Random, helix_pose, loop_pose, neighbours, shuffled, unshuffled};

fn helix(n: usize) -> Vec<Pose> {
    (0..n).map(|k| helix_pose(0.05 * k as f64)).collect()
}

fn closed_loop(n: usize, turns: f64) -> Vec<Pose> {
    (0..n).map(|k| loop_pose(std::f64::consts::TAU * k as f64 / n as f64, turns)).collect()
}

fn starting_at(start: usize) -> Options {
    Options { start: Some(start), ..Options::default() }
}

fn se3_order(poses: &[Pose], options: &Options) -> Ordering {
    order(&Se3::default(), poses, options).unwrap()
}

#[test]
fn a_thousand_poses_on_a_helix_come_back_exactly() {
    let mut random = Random::seeded(11);
    let rows = random.permutation(1000);
    let found = order_poses(&shuffled(&helix(1000), &rows), 0.3, &Options::default()).unwrap();
    let mut recovered = unshuffled(&found.order, &rows);
    if recovered[0] != 0 {
        recovered.reverse();
    }
    assert_eq!(recovered, (0..1000).collect::<Vec<_>>());
    assert_eq!((found.topology, found.verdict > Verdict::Ambiguous), (Topology::Open, true));
    assert_eq!(found.weight_stable, Some(true));
}

#[test]
fn an_open_curve_starts_at_its_end_with_the_smaller_row() {
    let poses = helix(30);
    let forward: Vec<usize> = (0..30).collect();
    assert_eq!(se3_order(&poses, &Options::default()).order, forward);
    let backward: Vec<Pose> = poses.iter().rev().copied().collect();
    assert_eq!(se3_order(&backward, &Options::default()).order, forward);
    // Ends of the curve in rows 4 and 2.
    let rows = [3, 1, 0, 2, 5, 4];
    assert_eq!(unshuffled(&se3_order(&shuffled(&poses, &rows), &Options::default()).order, &rows), [0, 1, 2, 3, 4, 5]);
}

#[test]
fn a_start_hint_gives_an_open_curve_its_direction() {
    let poses = helix(30);
    assert_eq!(se3_order(&poses, &starting_at(0)).order, (0..30).collect::<Vec<_>>());
    assert_eq!(se3_order(&poses, &starting_at(29)).order, (0..30).rev().collect::<Vec<_>>());
}

#[test]
fn a_closed_curve_starts_where_wanted_and_goes_toward_the_smaller_neighbour() {
    let poses = closed_loop(40, 1.0);
    let found = se3_order(&poses, &Options::default());
    assert_eq!((found.topology, found.verdict > Verdict::Ambiguous), (Topology::Closed, true));
    assert_eq!(found.order, (0..40).collect::<Vec<_>>());
    let from_seven: Vec<usize> = (0..40).map(|k| (47 - k) % 40).collect();
    assert_eq!(se3_order(&poses, &starting_at(7)).order, from_seven);
}

#[test]
fn loops_in_rotation_alone_are_closed_over_the_full_turn() {
    let mut random = Random::seeded(12);
    for n in [12_u32, 50, 200] {
        let step = std::f64::consts::TAU / f64::from(n);
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.8, 0.1));
        let turn: Vec<_> =
            (0..n).map(|k| tilt * UnitQuaternion::from_scaled_axis(Vector3::z() * (step * f64::from(k)))).collect();
        let rows = random.permutation(turn.len());
        let found = order(&So3, &shuffled(&turn, &rows), &Options::default()).unwrap();
        assert_eq!((found.topology, found.verdict > Verdict::Ambiguous), (Topology::Closed, true), "n = {n}");
        let expected = neighbours(&(0..turn.len()).collect::<Vec<_>>(), true);
        assert_eq!(neighbours(&unshuffled(&found.order, &rows), true), expected);
    }
}

#[test]
fn the_wanted_topology_wins() {
    let wanted = |topology| Options { topology, repair: Repair::Off, ..Options::default() };
    let ring = closed_loop(40, 0.0);
    assert_eq!(se3_order(&ring, &wanted(TopologyChoice::Open)).topology, Topology::Open);
    let arc = helix(20);
    let closed = se3_order(&arc, &wanted(TopologyChoice::Closed));
    assert_eq!(closed.topology, Topology::Closed);
    assert_eq!(closed.order, (0..20).collect::<Vec<_>>());
    assert_eq!(closed.verdict, Verdict::Ambiguous, "the closing gap is far too long");
}

/// On samples this dense, any other sequence replaces an edge by one that spans at least two, so the true order is the
/// shortest open path.
#[test]
fn the_order_is_the_shortest_of_all_permutations() {
    let mut random = Random::seeded(13);
    for n in 2..=8 {
        let poses: Vec<Pose> = (0..n).map(|k| helix_pose(0.4 * k as f64 + 0.1 * random.signed())).collect();
        let metric = Se3::with_metres_per_radian(0.3).unwrap();
        let mixed = shuffled(&poses, &random.permutation(n));
        let open = Options { topology: TopologyChoice::Open, ..Options::default() };
        let found = order(&metric, &mixed, &open).unwrap().order;
        let length = |rows: &[usize]| rows.windows(2).map(|w| metric.distance(&mixed[w[0]], &mixed[w[1]])).sum::<f64>();
        let shortest = permutations(n).iter().map(|rows| length(rows)).fold(f64::INFINITY, f64::min);
        // Eight summands in either direction: a few ε.
        assert!(length(&found) <= shortest * (1.0 + 1e-14), "n = {n}");
    }
}

#[test]
fn neighbourhoods_do_not_depend_on_the_order_of_the_input() {
    let mut random = Random::seeded(14);
    // Uneven steps, so that no two distances tie.
    let arc: Vec<Pose> = (0..80).map(|k| helix_pose(0.1 * f64::from(k) + 0.03 * random.signed())).collect();
    let ring: Vec<Pose> = (0..80).map(|k| loop_pose(0.0785 * f64::from(k) + 0.01 * random.signed(), 1.0)).collect();
    for (poses, topology) in [(arc, Topology::Open), (ring, Topology::Closed)] {
        let closed = topology == Topology::Closed;
        let expected = neighbours(&(0..80).collect::<Vec<_>>(), closed);
        for _ in 0..20 {
            let rows = random.permutation(80);
            let found = se3_order(&shuffled(&poses, &rows), &Options::default());
            assert_eq!((found.topology, found.verdict > Verdict::Ambiguous), (topology, true), "{:?}", found.doubts);
            assert_eq!(neighbours(&unshuffled(&found.order, &rows), closed), expected);
        }
    }
}

#[test]
fn moving_all_poses_by_one_motion_moves_nothing_in_the_order() {
    let mut random = Random::seeded(15);
    for _ in 0..20 {
        let arc: Vec<Pose> = (0..60).map(|k| helix_pose(0.1 * f64::from(k) + 0.03 * random.signed())).collect();
        let mixed = shuffled(&arc, &random.permutation(60));
        let g = random.pose();
        let moved: Vec<Pose> = mixed.iter().map(|pose| g * pose).collect();
        let (here, there) = (se3_order(&mixed, &Options::default()), se3_order(&moved, &Options::default()));
        assert_eq!(here.order, there.order);
        assert_eq!((here.verdict, here.topology), (there.verdict, there.topology));
        // Coordinates of about 3 rounded to ε/2 against gaps of 0.03: 1e-14 relative; the reach divides by the square of
        // a sagitta of 1e-3, so 1e-10.
        let (a, b) = (here.certificate, there.certificate);
        assert!((a.max_gap / b.max_gap - 1.0).abs() < 1e-12);
        assert!((a.reach.unwrap() / b.reach.unwrap() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn every_row_comes_once_even_where_the_tree_branches() {
    let mut random = Random::seeded(16);
    for n in [2, 3, 10, 100, 300] {
        let cloud: Vec<_> = (0..n).map(|_| random.vector()).collect();
        let found = order(&R3::default(), &cloud, &Options::default()).unwrap();
        let mut rows = found.order.clone();
        rows.sort_unstable();
        assert_eq!(rows, (0..n).collect::<Vec<_>>());
        assert_eq!((found.n, &found.components), (n, &vec![found.order.clone()]));
    }
}

#[test]
fn a_side_branch_is_walked_where_it_leaves() {
    // A line of 0..9 along x, and a spur of two points at x = 4, numbered 9 and 10.
    let mut points: Vec<_> = (0..9).map(|k| Vector3::x() * f64::from(k)).collect();
    points.extend([Vector3::new(4.0, 0.9, 0.0), Vector3::new(4.0, 1.8, 0.0)]);
    let unrepaired = Options { repair: Repair::Off, ..Options::default() };
    let found = order(&R3::default(), &points, &unrepaired).unwrap();
    assert_eq!(found.order, [0, 1, 2, 3, 4, 9, 10, 5, 6, 7, 8]);
    assert_eq!(found.verdict, Verdict::Ambiguous);
    assert_eq!(found.doubts.len(), 1);
    assert_eq!(found.doubts[0].at[0], 4);
}

#[test]
fn equal_points_stand_together_and_count_once() {
    // A dwell of three rows at the second point, and q beside −q at the last: the same rotation.
    let mut poses = helix(10);
    poses.push(poses[1]);
    let mut opposite = poses[9];
    opposite.rotation = UnitQuaternion::new_unchecked(-opposite.rotation.into_inner());
    poses.push(opposite);
    poses.push(poses[1]);
    let found = se3_order(&poses, &Options::default());
    assert_eq!(found.order, [0, 1, 10, 12, 2, 3, 4, 5, 6, 7, 8, 9, 11]);
    assert_eq!(found.duplicates, [vec![1, 10, 12], vec![9, 11]]);
    assert_eq!(found.distinct(), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert_ne!(found.verdict, Verdict::Ambiguous);
    assert_eq!(se3_order(&poses, &starting_at(11)).distinct(), [9, 8, 7, 6, 5, 4, 3, 2, 1, 0]);
    assert_eq!(se3_order(&poses, &starting_at(11)).order[..2], [9, 11]);
}

#[test]
fn points_that_differ_by_rounding_are_equal() {
    let mut points: Vec<_> = (0..6).map(|k| Vector3::new(0.1, 0.2, 0.3) * f64::from(k)).collect();
    points.push(points[3].map(f64::next_up));
    let found = order(&R3::default(), &points, &Options::default()).unwrap();
    assert_eq!((found.order, found.duplicates), (vec![0, 1, 2, 3, 6, 4, 5], vec![vec![3, 6]]));
    // 1e-12 is no rounding at this extent of 1.9.
    points[6] += Vector3::x() * 1e-12;
    assert!(order(&R3::default(), &points, &Options::default()).unwrap().duplicates.is_empty());
}
