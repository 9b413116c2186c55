//! The search against full recomputation and against all permutations.

use se3_geom::R2;
use se3_geom::nalgebra::Vector2;

#[path = "../../tests/support/permutations.rs"]
mod permutations;

use permutations::permutations;

use super::random::Random;
use super::search::Search;
use super::{Effort, Problem, closed_tour, open_path, starts};

const PLANE: R2 = se3_geom::Euclidean::<2>;

fn cloud(random: &mut Random, n: usize) -> Vec<Vector2<f64>> {
    (0..n).map(|_| Vector2::new(random.below(1000) as f64, random.below(1000) as f64)).collect()
}

/// Σ distance + λ Σ turning of a circle of nodes, from the definition.
fn cost(problem: &Problem<R2>, turning: f64, ring: &[usize]) -> f64 {
    let n = ring.len();
    let at = |k: usize| ring[k % n];
    let edges: f64 = (0..n).map(|k| problem.distance(at(k), at(k + 1))).sum();
    edges + turning * (0..n).map(|k| problem.turn(at(k), at(k + 1), at(k + 2))).sum::<f64>()
}

/// Random exchanges, swaps and trades on random circles, with and without an opening: the cost around a move changes by what the whole does.
#[test]
fn deltas_are_those_of_the_whole_tour() {
    let mut random = Random::seeded(31);
    for trial in 0..400 {
        let n = 5 + random.below(20);
        let points = cloud(&mut random, n);
        let problem = Problem::new(&PLANE, &points);
        let turning = [0.0, 1.0, 3.0][trial % 3];
        let mut ring: Vec<usize> = (0..n + trial % 2).collect();
        (1..ring.len()).for_each(|k| ring.swap(k, random.below(k + 1)));
        let mut search = Search::new(&problem, turning, ring);
        for _ in 0..20 {
            let chosen = search.random_move(&mut random);
            let before = cost(&problem, turning, search.nodes());
            let [around_before, around_after] = search.delta(chosen);
            search.apply(chosen, &mut Vec::new());
            let after = cost(&problem, turning, search.nodes());
            // Sums of up to 75 terms of up to 3·2·1414 each, rounded to ε/2 of the sum of at most 3e5: 1e-9.
            let error = (after - before) - (around_after - around_before);
            assert!(error.abs() < 1e-8, "trial {trial}: {chosen:?} is off by {error}");
        }
    }
}

#[test]
fn what_is_taken_back_is_as_it_was() {
    let mut random = Random::seeded(32);
    let points = cloud(&mut random, 40);
    let problem = Problem::new(&PLANE, &points);
    let mut search = Search::new(&problem, 3.0, (0..41).collect());
    for _ in 0..50 {
        let chosen = search.random_move(&mut random);
        search.apply(chosen, &mut Vec::new());
    }
    assert_ne!(search.nodes(), (0..41).collect::<Vec<_>>());
    search.take_back();
    assert_eq!(search.nodes(), (0..41).collect::<Vec<_>>());
}

/// On random points, where nothing is easy.
#[test]
fn the_search_finds_the_best_of_all_permutations() {
    let mut random = Random::seeded(33);
    for trial in 0..60 {
        let n = 3 + trial % 6;
        let points = cloud(&mut random, n);
        let problem = Problem::new(&PLANE, &points);
        for (turning, closed) in [(0.0, false), (3.0, false), (0.0, true), (3.0, true)] {
            let whole = |rows: &[usize]| {
                let ring = if closed { rows.to_vec() } else { [rows, &[problem.opening()]].concat() };
                cost(&problem, turning, &ring)
            };
            let best = permutations(n).iter().map(|rows| whole(rows)).fold(f64::INFINITY, f64::min);
            let starts = starts(&problem, turning, &[]);
            let found = if closed {
                closed_tour(&problem, turning, starts[0].clone(), Effort::Kicks)
            } else {
                open_path(&problem, turning, starts, Effort::Kicks)
            };
            let mut rows = found.clone();
            rows.sort_unstable();
            assert_eq!(rows, (0..n).collect::<Vec<_>>());
            assert!(whole(&found) <= best * (1.0 + 1e-12), "trial {trial}, n = {n}, {turning}, {closed}");
        }
    }
}
