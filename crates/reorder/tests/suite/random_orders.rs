//! Random smooth curves, sampled, some of them noisy, shuffled: how often each method finds the true order, and whether a verdict
//! ever vouches for a wrong one. `cargo xtask soak orders` runs thousands, the tests a seeded sample.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::{MethodChoice, Options, Verdict, nearest_chain, nn_crust, order};
use se3_geom::{Pose, Se3};

use crate::support::harmonics::*;
use crate::support::trials::{
    MOST_POINTS, Mix, Trial, any_trial, between, cases, print_by_kind, retraced, share, tried,
};
use crate::support::{Random, neighbours, shuffled, unshuffled};

/// Upper ends of the classes of ε̂.
const CLASSES: [f64; 5] = [0.4, 1.25, 2.0, 4.0, f64::INFINITY];

/// Independent samples of a closed curve. Half of them are even in the logarithm of ε̂ from 0.2 to 1.25, half in that of n from 50 to
/// 400, so that of sparse ones the spanning tree alone gets 0.97, 0.92 and 0.77 right: of eight points on such a curve nobody can tell
/// the order. `None` where there would be too many.
fn sample_by_density(random: &mut Random, index: usize) -> Option<(Measured<Se3>, Vec<Pose>)> {
    let curve = Measured::closed(Se3::default(), pose_curve(random));
    let n = if index.is_multiple_of(2) {
        curve.count_for(between(random, 0.2, 1.25), Spacing::Iid)
    } else {
        between(random, 50.0, 400.0) as usize
    };
    (n <= MOST_POINTS).then(|| {
        let samples = curve.sample(random, n, Spacing::Iid);
        (curve, samples)
    })
}

/// The 657th sample of the long run below, of epsilon 0.94: its tree is right, and a path through it that turns less costs less.
#[test]
fn a_tree_that_nowhere_branches_is_kept() {
    let mut random = Random::seeded(41);
    let mut index = 0;
    let samples = loop {
        let Some((_, samples)) = sample_by_density(&mut random, index) else { continue };
        if index == 656 {
            break samples;
        }
        // As much chance as the long run takes.
        random.permutation(samples.len());
        random.below(samples.len());
        index += 1;
    };
    let trial = tried(&Se3::default(), &mut random, &samples, true, 0.94);
    assert!(trial.exact && trial.found.verdict == Verdict::Ambiguous);
}

#[test]
fn success_by_density() {
    let mut random = Random::seeded(41);
    let mut trials = Vec::new();
    while trials.len() < cases(25) {
        if let Some((curve, samples)) = sample_by_density(&mut random, trials.len()) {
            let n = samples.len();
            let trial = tried(&curve.manifold, &mut random, &samples, true, curve.epsilon(&samples));
            let truth = neighbours(&(0..n).collect::<Vec<_>>(), true);
            let tree = Options { method: MethodChoice::Mst, ..Options::default() };
            let tree = order(&curve.manifold, &samples, &tree).unwrap().order;
            let drawn: Vec<_> = nn_crust(&curve.manifold, &samples).edges().iter().map(|&[a, b]| (a, b)).collect();
            let chain = nearest_chain(&curve.manifold, &samples, random.below(n));
            trials.push(Trial {
                others_exact: [neighbours(&tree, true) == truth, drawn == truth, neighbours(&chain, true) == truth],
                ..trial
            });
        }
    }
    println!(
        "{:>12} {:>6} {:>8} {:>8} {:>8} {:>8} {:>10} {:>10}",
        "epsilon", "cases", "ours", "MST", "NN-CRUST", "chain", "certified", "plausible"
    );
    let mut below = 0.0;
    for class in CLASSES {
        let of_class: Vec<_> = trials.iter().filter(|t| (below..class).contains(&t.epsilon)).collect();
        println!(
            "{:>12} {:>6} {:>8.4} {:>8.4} {:>8.4} {:>8.4} {:>10.4} {:>10.4}",
            format!("{below}-{class}"),
            of_class.len(),
            share(&of_class, |t| t.exact),
            share(&of_class, |t| t.others_exact[0]),
            share(&of_class, |t| t.others_exact[1]),
            share(&of_class, |t| t.others_exact[2]),
            share(&of_class, |t| t.found.verdict == Verdict::Certified),
            share(&of_class, |t| t.found.verdict == Verdict::Plausible),
        );
        // What is expected of each class, less four deviations of a share of so many cases: a lucky seed must not decide.
        let expected = match class {
            class if class <= 1.25 => 1.0,
            class if class <= 2.0 => 0.995,
            class if class <= 4.0 => 0.98,
            _ => 0.90,
        };
        let deviation = (expected * (1.0 - expected) / of_class.len().max(1) as f64).sqrt();
        let exact = share(&of_class, |t| t.exact);
        assert!(of_class.is_empty() || exact >= expected - 4.0 * deviation, "{exact} below {class}");
        below = class;
    }
    let wrong = |t: &&Trial| t.found.verdict == Verdict::Certified && !(t.exact && t.topology_right);
    assert_eq!(trials.iter().filter(wrong).count(), 0);
    // ε̂ < 1 is the theorem's hypothesis.
    assert!(trials.iter().all(|t| t.exact || t.epsilon >= 1.0));
    let dense: Vec<_> = trials.iter().filter(|t| t.epsilon <= 0.4).collect();
    let certified = share(&dense, |t| t.found.verdict == Verdict::Certified);
    println!("certified of {} dense samples: {certified:.4}", dense.len());
    // 97 % in 2000 cases; of the ten or so of the short run two may fail.
    assert!(certified >= if dense.len() < 100 { 0.8 } else { 0.95 });
}

#[test]
fn no_wrong_order_is_certified() {
    let mut random = Random::seeded(42);
    let mut trials: Vec<Trial> = Vec::new();
    while trials.len() < cases(30) {
        trials.extend(match random.below(6) {
            5 => retraced(&mut random),
            _ => any_trial(&mut random, Mix::Any),
        });
    }
    print_by_kind(&trials);
    let certified = || trials.iter().filter(|t| t.found.verdict == Verdict::Certified);
    println!("certified: {} of {}", certified().count(), trials.len());
    if let Some(wrong) = certified().find(|t| !(t.exact && t.topology_right)) {
        panic!("{} of {} points, epsilon {}: {:?}", wrong.kind, wrong.n, wrong.epsilon, wrong.found.certificate);
    }
    for t in trials.iter().filter(|t| t.found.verdict == Verdict::Plausible && !(t.exact && t.topology_right)) {
        println!(
            "plausible and wrong: {} of {} points, epsilon {:.2}, order right: {}",
            t.kind, t.n, t.epsilon, t.exact
        );
    }
    let plausible = || trials.iter().filter(|t| t.found.verdict == Verdict::Plausible);
    let wrong = plausible().filter(|t| !t.exact).count();
    println!("plausible: {}, {wrong} of them wrong", plausible().count());
    // One in a hundred of such samples is, at times; when doubts gave way to searches on noisy ones too, every tenth was.
    assert!(wrong * 50 <= plausible().count(), "{wrong} of {}", plausible().count());
    assert!(certified().count() * 12 > trials.len(), "the verdict is of no use");
}

/// 1 where the order goes round as the truth 0, 1, …, n − 1 does, in either direction and from any start: 1 − 4·inversions/(n(n − 1)).
fn kendall_around(order: &[usize]) -> f64 {
    let n = order.len();
    let from = order.iter().position(|&row| row == 0).unwrap();
    let turned: Vec<usize> = (0..n).map(|k| order[(from + k) % n]).collect();
    let inversions = |rows: &[usize]| {
        let later = |k: usize| rows[k + 1..].iter().filter(|&&other| other < rows[k]).count();
        (0..n).map(later).sum::<usize>()
    };
    let backward: Vec<usize> = std::iter::once(0).chain(turned[1..].iter().rev().copied()).collect();
    let least = inversions(&turned).min(inversions(&backward));
    1.0 - 4.0 * least as f64 / (n * (n - 1)) as f64
}

/// How often the order of a hundred noisy samples is exact, and Kendall's tau on average, by each way of ordering.
fn under_noise(cases: usize, spacing: Spacing, noise: f64, ways: &[Options]) -> Vec<[f64; 2]> {
    let mut random = Random::seeded(43);
    let mut sums = vec![[0.0; 2]; ways.len()];
    for _ in 0..cases {
        let curve = Measured::closed(Se3::default(), pose_curve(&mut random));
        let clean = curve.sample(&mut random, 100, spacing);
        let samples = with_noise(&curve.manifold, &mut random, &clean, noise * curve.mean_gap(100));
        let rows = random.permutation(100);
        let mixed = shuffled(&samples, &rows);
        let truth = neighbours(&(0..100).collect::<Vec<_>>(), true);
        for ([exact, tau], options) in sums.iter_mut().zip(ways) {
            let found = unshuffled(&order(&curve.manifold, &mixed, options).unwrap().order, &rows);
            *exact += f64::from(neighbours(&found, true) == truth);
            *tau += kendall_around(&found);
        }
    }
    sums.iter().map(|sums| sums.map(|sum| sum / cases as f64)).collect()
}

/// A hundred samples of a closed curve, moved by noise of a share of their mean gap, ordered by the tree alone, by default, and with
/// denoising. Independent samples have gaps that are far shorter than the noise: their figures are only printed.
fn success_by_noise(spacing: Spacing) {
    let cases = cases(3).min(1000);
    let mst = Options { method: MethodChoice::Mst, ..Options::default() };
    let denoise = Options { denoise: true, ..Options::default() };
    println!("exact share and Kendall tau of {cases} cases each, {spacing:?}");
    println!("{:>6} {:>16} {:>16} {:>16}", "noise", "MST", "auto", "denoised");
    for (noise, expected) in [(0.2, 0.98), (0.3, 0.86), (0.5, 0.40)] {
        let found = under_noise(cases, spacing, noise, &[mst, Options::default(), denoise]);
        let cells: Vec<String> = found.iter().map(|[exact, tau]| format!("{exact:>8.3} {tau:.5}")).collect();
        println!("{noise:>6} {}", cells.join(" "));
        let deviation = (expected * (1.0_f64 - expected) / cases as f64).sqrt();
        for [exact, tau] in found[1..].iter().filter(|_| spacing != Spacing::Iid) {
            assert!(*exact >= expected - 4.0 * deviation, "{exact} at {noise}, {spacing:?}");
            assert!(*tau >= 0.999, "{tau} at {noise}, {spacing:?}");
        }
    }
}

#[test]
fn success_by_noise_of_even_samples() {
    success_by_noise(Spacing::Even);
}

#[test]
fn success_by_noise_of_jittered_samples() {
    success_by_noise(Spacing::Jittered(0.2));
}

#[test]
fn success_by_noise_of_independent_samples() {
    success_by_noise(Spacing::Iid);
}
