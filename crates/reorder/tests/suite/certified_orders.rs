//! What is certified is right: dense samples of random curves until so many of their orders are certified. `cargo xtask soak certified`
//! runs thousands, the test a seeded sample.

use reorder::Verdict;

use crate::support::Random;
use crate::support::trials::{Mix, Trial, any_trial, cases, print_by_kind};

#[test]
fn certified_orders_are_right() {
    let mut random = Random::seeded(44);
    let mut trials: Vec<Trial> = Vec::new();
    let (mut certified, wanted) = (0, cases(40));
    while certified < wanted {
        if let Some(trial) = any_trial(&mut random, Mix::Dense) {
            let is_certified = trial.found.verdict == Verdict::Certified;
            assert!(
                !is_certified || trial.exact && trial.topology_right,
                "{} of {} points, epsilon {}: {:?}",
                trial.kind,
                trial.n,
                trial.epsilon,
                trial.found.certificate
            );
            certified += usize::from(is_certified);
            trials.push(trial);
            // Crossings and closed curves with independent gaps are rarely certified, others mostly.
            assert!(trials.len() < 50 + 5 * certified, "the verdict is of no use");
        }
    }
    print_by_kind(&trials);
    println!("certified: {certified} of {}", trials.len());
}
