//! Random smooth curves, sampled, some of them noisy, shuffled: how often each method finds the true order, and whether a verdict
//! ever vouches for a wrong one. `cargo xtask soak orders` runs thousands, the tests a seeded sample.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

mod support;

use reorder::{Options, Ordering, Topology, Verdict, order};
use se3_geom::{Manifold, Se3};
use support::harmonics::*;
use support::{Random, neighbours, shuffled, unshuffled};

/// Upper ends of the classes of ε̂.
const CLASSES: [f64; 5] = [0.4, 1.25, 2.0, 4.0, f64::INFINITY];

fn cases(few: usize) -> usize {
    std::env::var("REORDER_SOAK_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(few)
}

struct Trial {
    epsilon: f64,
    exact: bool,
    topology_right: bool,
    verdict: Verdict,
}

/// Orders samples given in true order, shuffled.
fn tried<M: Manifold>(manifold: &M, random: &mut Random, samples: &[M::Point], closed: bool, epsilon: f64) -> Trial {
    let n = samples.len();
    let rows = random.permutation(n);
    let found: Ordering = order(manifold, &shuffled(samples, &rows), &Options::default()).unwrap();
    let topology_right = (found.topology == Topology::Closed) == closed;
    let truth = neighbours(&(0..n).collect::<Vec<_>>(), closed);
    // A closed curve reported as open, in the right order, lacks its closing pair and nothing else.
    let recovered = neighbours(&unshuffled(&found.order, &rows), closed);
    Trial { epsilon, exact: recovered == truth, topology_right, verdict: found.verdict }
}

#[test]
fn success_by_density() {
    let mut random = Random::seeded(41);
    let mut trials = Vec::new();
    for _ in 0..cases(60) {
        let curve = Measured::closed(Se3::default(), pose_curve(&mut random));
        // Even in the logarithm from 0.2 to 8.
        let wanted = (0.2_f64.ln() + 0.5 * (1.0 + random.signed()) * 40.0_f64.ln()).exp();
        let n = curve.count_for(wanted, Spacing::Iid);
        let samples = curve.sample(&mut random, n, Spacing::Iid);
        trials.push(tried(&curve.manifold, &mut random, &samples, true, curve.epsilon(&samples)));
    }
    println!("{:>12} {:>6} {:>8} {:>10} {:>10}", "epsilon", "cases", "MST", "certified", "plausible");
    let mut below = 0.0;
    for class in CLASSES {
        let of_class: Vec<_> = trials.iter().filter(|t| (below..class).contains(&t.epsilon)).collect();
        let share = |which: &dyn Fn(&Trial) -> bool| {
            of_class.iter().filter(|t| which(t)).count() as f64 / of_class.len().max(1) as f64
        };
        println!(
            "{:>12} {:>6} {:>8.4} {:>10.4} {:>10.4}",
            format!("{below}-{class}"),
            of_class.len(),
            share(&|t| t.exact),
            share(&|t| t.verdict == Verdict::Certified),
            share(&|t| t.verdict == Verdict::Plausible),
        );
        below = class;
    }
}
