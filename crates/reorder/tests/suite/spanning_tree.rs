//! The minimum spanning tree against Kruskal on the complete graph.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::petgraph::algo::min_spanning_tree;
use reorder::petgraph::data::Element;
use reorder::petgraph::graph::UnGraph;
use reorder::petgraph::visit::EdgeRef;
use reorder::{OrderError, Tree, minimum_spanning_tree};
use se3_geom::nalgebra::{Isometry2, Similarity2, UnitQuaternion, Vector3};
use se3_geom::{Manifold, Pose, R3, Se2, Se3, Sim2, So3, Sphere};

use crate::support::{Random, shuffled};

fn kruskal_weight<M: Manifold>(manifold: &M, points: &[M::Point]) -> f64 {
    let mut complete = UnGraph::<usize, f64>::default();
    let nodes: Vec<_> = (0..points.len()).map(|row| complete.add_node(row)).collect();
    for j in 0..points.len() {
        for i in 0..j {
            complete.add_edge(nodes[i], nodes[j], manifold.distance(&points[i], &points[j]));
        }
    }
    let lengths = min_spanning_tree(&complete).filter_map(|element| match element {
        Element::Edge { weight, .. } => Some(weight),
        Element::Node { .. } => None,
    });
    lengths.sum()
}

fn edges(tree: &Tree) -> Vec<(usize, usize)> {
    let mut edges: Vec<_> = tree.edge_references().map(|e| (tree[e.source()], tree[e.target()])).collect();
    edges.sort_unstable();
    edges
}

/// Sums of n ≤ 1000 positive terms in two orders differ by at most n ε = 2.2e-13 relative; 1e-12 leaves room for ties that
/// rounding decides, and an exchanged edge shows far above it.
fn assert_minimal<M: Manifold>(manifold: &M, points: &[M::Point]) {
    let tree = minimum_spanning_tree(manifold, points).unwrap();
    let weight: f64 = tree.edge_weights().sum();
    let expected = kruskal_weight(manifold, points);
    assert_eq!(tree.edge_count(), points.len() - 1);
    assert_eq!(reorder::petgraph::algo::connected_components(&tree), 1);
    assert!((weight - expected).abs() <= 1e-12 * expected, "{weight} against {expected}");
    for edge in tree.edge_references() {
        let [i, j] = [tree[edge.source()], tree[edge.target()]];
        assert_eq!(*edge.weight(), manifold.distance(&points[i], &points[j]));
    }
}

/// Coordinates from which every space takes what it has: position, rotation vector, logarithm of a scale.
#[derive(Clone, Copy)]
struct Place {
    position: Vector3<f64>,
    turn: Vector3<f64>,
    growth: f64,
    /// Which of the two unit quaternions stands for the rotation.
    negative: bool,
}

impl Place {
    fn random(random: &mut Random) -> Self {
        let (position, turn, growth) = (random.vector(), random.vector() * 3.0, random.signed());
        Self { position, turn, growth, negative: random.signed() < 0.0 }
    }
    /// At this share of a line: straight in flat spaces, a geodesic of less than a full turn in round ones.
    fn on_line(share: f64) -> Self {
        let position = Vector3::new(1.0, 2.0, 3.0) * share;
        Self { position, turn: Vector3::z() * (6.0 * share - 3.0), growth: share, negative: false }
    }
    fn rotation(&self) -> UnitQuaternion<f64> {
        let q = UnitQuaternion::from_scaled_axis(self.turn);
        if self.negative { UnitQuaternion::new_unchecked(-q.into_inner()) } else { q }
    }
    fn plane(&self) -> Isometry2<f64> {
        Isometry2::new(self.position.xy(), self.turn.z)
    }
}

/// In few points, around the number where another algorithm takes over, and in a thousand.
fn assert_minimal_in_every_space(places: impl Fn(usize, &mut Random) -> Vec<Place>, seed: u64) {
    let mut random = Random::seeded(seed);
    for n in [1, 2, 3, 5, 20, 64, 65, 1000] {
        let rows = random.permutation(n);
        let places = shuffled(&places(n, &mut random), &rows);
        let each = || places.iter();
        assert_minimal(&R3::default(), &each().map(|p| p.position).collect::<Vec<_>>());
        assert_minimal(&Sphere, &each().map(|p| p.rotation() * Vector3::x()).collect::<Vec<_>>());
        assert_minimal(&So3, &each().map(Place::rotation).collect::<Vec<_>>());
        let poses: Vec<_> = each().map(|p| Pose::from_parts(p.position.into(), p.rotation())).collect();
        let planar: Vec<_> = each().map(Place::plane).collect();
        let similar: Vec<_> = each().map(|p| Similarity2::from_isometry(p.plane(), p.growth.exp())).collect();
        let lengths: &[f64] = if n < 1000 { &[0.01, 1.0, 30.0] } else { &[0.3] };
        for length in lengths {
            assert_minimal(&Se3::with_metres_per_radian(*length).unwrap(), &poses);
            assert_minimal(&Se2::with_weights(length * length, 1.0).unwrap(), &planar);
            assert_minimal(&Sim2::with_weights(length * length, 1.0).unwrap(), &similar);
        }
    }
}

#[test]
fn weight_equals_kruskal_on_scattered_points() {
    assert_minimal_in_every_space(|n, random| (0..n).map(|_| Place::random(random)).collect(), 1);
}

#[test]
fn weight_equals_kruskal_on_lines() {
    let line = |n: usize, _: &mut Random| (0..n).map(|k| Place::on_line(k as f64 / n as f64)).collect();
    assert_minimal_in_every_space(line, 2);
    assert_minimal_in_every_space(|n, random| (0..n).map(|_| Place::on_line(random.signed())).collect(), 3);
}

#[test]
fn weight_equals_kruskal_around_several_full_turns_on_either_sign_of_the_quaternion() {
    let turns = |n: usize, random: &mut Random| -> Vec<Place> {
        let angles = (0..n).map(|k| 3.0 * TAU * k as f64 / n as f64);
        angles
            .map(|a| Place { turn: Vector3::z() * a, negative: random.signed() < 0.0, ..Place::on_line(0.02 * a) })
            .collect()
    };
    assert_minimal_in_every_space(turns, 4);
    let turn: Vec<_> =
        (0..40).map(|k| UnitQuaternion::from_scaled_axis(Vector3::z() * (0.16 * f64::from(k)))).collect();
    // 39 steps of 0.16 rad close to within 0.043 rad of a full turn: the longest edge, not the closing one, is left out.
    let weight: f64 = minimum_spanning_tree(&So3, &turn).unwrap().edge_weights().sum();
    assert!((weight - (38.0 * 0.16 + (TAU - 39.0 * 0.16))).abs() < 1e-12);
}

#[test]
fn weight_equals_kruskal_with_ties() {
    let grid = |n: usize, _: &mut Random| {
        let at = |k: usize| Vector3::new((k % 10) as f64, (k / 10 % 10) as f64, (k / 100) as f64) * 0.1;
        (0..n).map(|k| Place { position: at(k), turn: at(k), ..Place::on_line((k % 3) as f64) }).collect()
    };
    assert_minimal_in_every_space(grid, 5);
}

#[test]
fn weight_equals_kruskal_with_duplicates() {
    let dwelling = |n: usize, random: &mut Random| {
        let places: Vec<_> = (0..n.div_ceil(4)).map(|_| Place::random(random)).collect();
        (0..n).map(|k| Place { negative: k % 3 == 0, ..places[k % places.len()] }).collect()
    };
    assert_minimal_in_every_space(dwelling, 6);
    assert_minimal_in_every_space(|n, _| vec![Place::on_line(0.3); n], 7);
}

#[test]
fn weight_equals_kruskal_on_clusters() {
    let clusters = |n: usize, random: &mut Random| {
        let centres: Vec<_> = (0..7).map(|_| Place::random(random)).collect();
        let near = |centre: &Place, by: Place| Place {
            position: centre.position + by.position * 1e-3,
            turn: centre.turn + by.turn * 1e-3,
            growth: centre.growth + by.growth * 1e-3,
            negative: by.negative,
        };
        (0..n).map(|k| near(&centres[k % 7], Place::random(random))).collect()
    };
    assert_minimal_in_every_space(clusters, 8);
}

#[test]
fn without_ties_the_edges_do_not_depend_on_the_order_of_the_input() {
    let mut random = Random::seeded(4);
    let poses: Vec<_> = (0..60).map(|_| random.pose()).collect();
    let expected = edges(&minimum_spanning_tree(&Se3::default(), &poses).unwrap());
    for _ in 0..20 {
        let rows = random.permutation(60);
        let tree = minimum_spanning_tree(&Se3::default(), &shuffled(&poses, &rows)).unwrap();
        let mut renamed: Vec<_> =
            edges(&tree).into_iter().map(|(a, b)| (rows[a].min(rows[b]), rows[a].max(rows[b]))).collect();
        renamed.sort_unstable();
        assert_eq!(renamed, expected);
    }
}

#[test]
fn equal_lengths_are_decided_by_the_smaller_rows() {
    // The four sides of a square tie; (2, 3) is the last of (0,1), (0,3), (1,2), (2,3).
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let tree = minimum_spanning_tree(&R3::default(), &square).unwrap();
    assert_eq!(edges(&tree), [(0, 1), (0, 3), (1, 2)]);
}

#[test]
fn bad_points_are_named() {
    let far = Vector3::x() * 1e200;
    let r3 = R3::default();
    let refusal = |points: &[Vector3<f64>]| minimum_spanning_tree(&r3, points).unwrap_err();
    assert_eq!(refusal(&[]), OrderError::TooFewPoints { count: 0, needed: 1 });
    assert_eq!(refusal(&[far, far * f64::NAN]), OrderError::NonFinite { index: 1 });
    assert_eq!(refusal(&[far, -far, Vector3::zeros()]), OrderError::DistanceOverflow { at: [0, 1] });
}

#[test]
fn the_oracle_itself_builds_the_tree_it_weighs() {
    // Guards against an oracle that weighs nothing: a unit path has weight n − 1.
    let line: Vec<_> = (0..5).map(|k| Vector3::x() * f64::from(k)).collect();
    assert_eq!(kruskal_weight(&R3::default(), &line), 4.0);
}
