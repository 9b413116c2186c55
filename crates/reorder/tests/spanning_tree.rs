//! Prim against Kruskal on the complete graph.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

mod support;

use reorder::petgraph::algo::min_spanning_tree;
use reorder::petgraph::data::Element;
use reorder::petgraph::graph::UnGraph;
use reorder::petgraph::visit::EdgeRef;
use reorder::{OrderError, Tree, minimum_spanning_tree};
use se3_geom::nalgebra::{UnitQuaternion, Vector3};
use se3_geom::{Manifold, R3, Se3, So3};
use support::{Random, shuffled};

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

/// Sums of n ≤ 60 positive terms in two orders differ by at most n ε = 1.4e-14 relative; 1e-12 leaves room, and an
/// exchanged edge shows far above it.
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

#[test]
fn weight_equals_kruskal_on_scattered_points() {
    let mut random = Random::seeded(1);
    for n in [1, 2, 3, 5, 20, 60] {
        let positions: Vec<_> = (0..n).map(|_| random.vector()).collect();
        let rotations: Vec<_> = (0..n).map(|_| random.rotation()).collect();
        let poses: Vec<_> = (0..n).map(|_| random.pose()).collect();
        assert_minimal(&R3::default(), &positions);
        assert_minimal(&So3, &rotations);
        for length in [0.01, 1.0, 30.0] {
            assert_minimal(&Se3::with_metres_per_radian(length).unwrap(), &poses);
        }
    }
}

#[test]
fn weight_equals_kruskal_around_a_full_turn_and_on_either_sign_of_the_quaternion() {
    let mut random = Random::seeded(2);
    let turn: Vec<_> =
        (0..40).map(|k| UnitQuaternion::from_scaled_axis(Vector3::z() * (0.16 * f64::from(k)))).collect();
    let turn: Vec<_> = turn
        .into_iter()
        .map(|q| if random.signed() < 0.0 { UnitQuaternion::new_unchecked(-q.into_inner()) } else { q })
        .collect();
    assert_minimal(&So3, &turn);
    // 39 steps of 0.16 rad close to within 0.043 rad of a full turn: the longest edge, not the closing one, is left out.
    let weight: f64 = minimum_spanning_tree(&So3, &turn).unwrap().edge_weights().sum();
    assert!((weight - (38.0 * 0.16 + (std::f64::consts::TAU - 39.0 * 0.16))).abs() < 1e-12);
}

#[test]
fn weight_equals_kruskal_with_ties_duplicates_collinear_points_and_clusters() {
    let mut random = Random::seeded(3);
    let grid: Vec<_> = (0..49).map(|k| Vector3::new(f64::from(k % 7), f64::from(k / 7), 0.0)).collect();
    assert_minimal(&R3::default(), &shuffled(&grid, &random.permutation(49)));
    let line: Vec<_> = (0..50).map(|k| Vector3::new(1.0, 2.0, 3.0) * f64::from(k)).collect();
    assert_minimal(&R3::default(), &shuffled(&line, &random.permutation(50)));
    let repeated: Vec<_> = (0..48).map(|k| grid[k / 3]).collect();
    assert_minimal(&R3::default(), &shuffled(&repeated, &random.permutation(48)));
    let clusters: Vec<_> = (0..60).map(|k| Vector3::x() * f64::from(k / 20) + random.vector() * 1e-3).collect();
    assert_minimal(&R3::default(), &shuffled(&clusters, &random.permutation(60)));
    let poses: Vec<_> = (0..15).map(|_| random.pose()).collect();
    let dwelling: Vec<_> = (0..60).map(|k| poses[k % 15]).collect();
    assert_minimal(&Se3::default(), &dwelling);
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
