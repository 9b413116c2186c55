//! NN-CRUST, CRUST and the nearest-neighbour chain, against the truth and against each other.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::{NoCurve, Options, crust, minimum_spanning_tree, nearest_chain, nn_crust, order};
use se3_geom::nalgebra::{Vector2, Vector3};
use se3_geom::{Manifold, R2, R3, Se3, So3, Sphere};

use crate::support::harmonics::*;
use crate::support::{Random, neighbours};

fn loop_edges(n: usize) -> Vec<[usize; 2]> {
    neighbours(&(0..n).collect::<Vec<_>>(), true).into_iter().map(|(a, b)| [a, b]).collect()
}

/// ε̂ ≤ 0.25 in the plane: every point of the curve is within about 0.25 of the reach of a sample, as CRUST's proof asks.
#[test]
fn all_methods_agree_on_dense_plane_curves() {
    let mut random = Random::seeded(51);
    for _ in 0..20 {
        let curve = Measured::closed(R2::default(), plane_curve(&mut random));
        let n = curve.count_for(0.2, Spacing::Jittered(0.4));
        let samples = curve.sample(&mut random, n, Spacing::Jittered(0.4));
        assert!(n > 15 && curve.epsilon(&samples) < 0.25);
        let truth = loop_edges(n);
        assert_eq!(nn_crust(&curve.manifold, &samples).edges(), truth);
        assert_eq!(crust(&samples).unwrap().edges(), truth);
        let strand = crust(&samples).unwrap().curve().unwrap();
        assert_eq!((strand.rows, strand.closed), ((0..n).collect(), true));
        let tree = minimum_spanning_tree(&curve.manifold, &samples).unwrap();
        assert!(tree.edge_indices().all(|e| {
            let (a, b) = tree.edge_endpoints(e).unwrap();
            truth.contains(&[a.index().min(b.index()), a.index().max(b.index())])
        }));
    }
}

fn nn_crust_is_right<M: Isotropic>(curve: &Measured<M>, random: &mut Random) {
    let n = curve.count_for(0.4, Spacing::Iid);
    let samples = curve.sample(random, n, Spacing::Iid);
    if curve.closed {
        assert_eq!(nn_crust(&curve.manifold, &samples).edges(), loop_edges(n));
    } else {
        let strand = nn_crust(&curve.manifold, &samples).curve().unwrap();
        assert_eq!((strand.rows, strand.closed), ((0..n).collect(), false));
    }
}

#[test]
fn nn_crust_draws_dense_loops_and_arcs_on_every_manifold() {
    let mut random = Random::seeded(52);
    for _ in 0..3 {
        let r = &mut random;
        nn_crust_is_right(&Measured::closed(Sphere, sphere_curve(r)), r);
        let (space, pose) = (space_curve(r), pose_curve(r));
        nn_crust_is_right(&Measured::open(R3::default(), space, 0.4 * TAU), r);
        nn_crust_is_right(&Measured::open(Se3::default(), pose, 0.4 * TAU), r);
    }
    // A full turn: the logarithm changes sides half a turn away, where no neighbour is.
    let n = 40;
    let turn: Vec<_> =
        (0..n).map(|k| So3.exp(&Default::default(), Vector3::z() * (TAU * k as f64 / n as f64))).collect();
    assert_eq!(nn_crust(&So3, &turn).edges(), loop_edges(n));
}

#[test]
fn a_drawing_that_is_no_curve_says_why() {
    // Two circles, then three arms from one point.
    let ring =
        |x: f64| (0..12).map(move |k| TAU * f64::from(k) / 12.0).map(move |t| Vector2::new(x + t.cos(), t.sin()));
    let rings: Vec<_> = ring(0.0).chain(ring(10.0)).collect();
    for drawing in [nn_crust(&R2::default(), &rings), crust(&rings).unwrap()] {
        let Err(NoCurve::Pieces { strands }) = drawing.curve() else { panic!("{drawing:?}") };
        let lengths: Vec<_> = strands.iter().map(|s| (s.rows[0], s.rows.len(), s.closed)).collect();
        assert_eq!(lengths, [(0, 12, true), (12, 12, true)]);
    }
    let arm = |turn: f64| (1..5).map(move |k| Vector2::new((TAU * turn).cos(), (TAU * turn).sin()) * f64::from(k));
    let star: Vec<_> = [Vector2::zeros()].into_iter().chain([0.0, 0.33, 0.66].into_iter().flat_map(arm)).collect();
    let drawing = crust(&star).unwrap();
    assert_eq!(drawing.curve(), Err(NoCurve::Branch { at: 0, edges: 3 }), "{drawing:?}");
    assert!(crust(&[Vector2::new(0.0, f64::NAN)]).is_err());
}

#[test]
fn nothing_breaks_on_few_or_collinear_points() {
    for n in 0..5 {
        let line: Vec<_> = (0..n).map(|k| Vector2::new(k as f64, 2.0 * k as f64)).collect();
        let path: Vec<[usize; 2]> = (1..n).map(|k| [k - 1, k]).collect();
        assert_eq!(crust(&line).unwrap().edges(), path);
        assert_eq!(nn_crust(&R2::default(), &line).edges(), path);
        assert_eq!(nearest_chain(&R2::default(), &line, 0), (0..n).collect::<Vec<_>>());
    }
    assert!(nearest_chain(&R2::default(), &[Vector2::zeros()], 1).is_empty());
}

#[test]
fn the_chain_is_right_from_an_end_and_jumps_from_within() {
    let line: Vec<_> = (0..10).map(|k| Vector2::new(f64::from(k), 0.0)).collect();
    assert_eq!(nearest_chain(&R2::default(), &line, 9), [9, 8, 7, 6, 5, 4, 3, 2, 1, 0]);
    assert_eq!(nearest_chain(&R2::default(), &line, 6), [6, 5, 4, 3, 2, 1, 0, 7, 8, 9]);
}

/// On a dense loop the shortest of all closed tours is the true one: any other replaces a gap by a longer chord.
#[test]
fn dense_loops_of_up_to_eight_points_are_the_shortest_tours() {
    let mut random = Random::seeded(53);
    for n in 5..=8 {
        for _ in 0..20 {
            let points: Vec<_> = (0..n)
                .map(|k| TAU * (k as f64 + 0.2 * random.signed()) / n as f64)
                .map(|t| Vector2::new(1.2 * t.cos(), t.sin()))
                .collect();
            let rows = random.permutation(n);
            let mixed = crate::support::shuffled(&points, &rows);
            let closed = Options { topology: reorder::TopologyChoice::Closed, ..Options::default() };
            let found = order(&R2::default(), &mixed, &closed).unwrap().order;
            let length =
                |tour: &[usize]| (0..n).map(|k| (mixed[tour[k]] - mixed[tour[(k + 1) % n]]).norm()).sum::<f64>();
            let mut shortest = f64::INFINITY;
            permute(&mut (0..n).collect::<Vec<_>>(), 1, &mut |tour| shortest = shortest.min(length(tour)));
            // Eight summands in either direction: a few ε.
            assert!(length(&found) <= shortest * (1.0 + 1e-14), "n = {n}");
            // The edges of fewer points may meet at less than 90°.
            assert!(n < 7 || nn_crust(&R2::default(), &points).edges() == loop_edges(n));
        }
    }
}

fn permute(rows: &mut Vec<usize>, from: usize, visit: &mut impl FnMut(&[usize])) {
    if from == rows.len() {
        return visit(rows);
    }
    for k in from..rows.len() {
        rows.swap(from, k);
        permute(rows, from + 1, visit);
        rows.swap(from, k);
    }
}
