//! Samples of random curves, ordered, and what came of it.
#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::{Options, Ordering, Topology, Verdict, order};
use se3_geom::{Manifold, R2, R3, Se3, Sphere};

use super::harmonics::*;
use super::{Random, neighbours, shuffled, unshuffled};

/// Samples of more points are not tried: they take long and say nothing new.
pub(crate) const MOST_POINTS: usize = 1500;

pub(crate) fn cases(few: usize) -> usize {
    std::env::var("REORDER_SOAK_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(few)
}

pub(crate) struct Trial {
    pub(crate) kind: String,
    pub(crate) n: usize,
    pub(crate) epsilon: f64,
    pub(crate) exact: bool,
    pub(crate) topology_right: bool,
    /// The spanning tree alone, NN-CRUST, and the nearest-neighbour chain from any point.
    pub(crate) others_exact: [bool; 3],
    pub(crate) found: Ordering,
}

/// Orders samples given in true order, shuffled.
pub(crate) fn tried<M: Manifold>(
    manifold: &M,
    random: &mut Random,
    samples: &[M::Point],
    closed: bool,
    epsilon: f64,
) -> Trial {
    let n = samples.len();
    let rows = random.permutation(n);
    let mixed = shuffled(samples, &rows);
    let found: Ordering = order(manifold, &mixed, &Options::default()).unwrap();
    let topology_right = (found.topology == Topology::Closed) == closed;
    let truth = neighbours(&(0..n).collect::<Vec<_>>(), closed);
    // A closed curve reported as open, in the right order, lacks its closing pair and nothing else.
    let recovered = neighbours(&unshuffled(&found.order, &rows), closed);
    let exact = recovered == truth;
    Trial { kind: String::new(), n, epsilon, exact, topology_right, others_exact: [false; 3], found }
}

/// Even in the logarithm.
pub(crate) fn between(random: &mut Random, least: f64, most: f64) -> f64 {
    (least.ln() + 0.5 * (1.0 + random.signed()) * (most / least).ln()).exp()
}

pub(crate) fn share<'a>(trials: &[&'a Trial], which: impl Fn(&&&'a Trial) -> bool) -> f64 {
    trials.iter().filter(|t| which(t)).count() as f64 / trials.len().max(1) as f64
}

/// Which samples are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mix {
    /// Of every density and noise.
    Any,
    /// Dense and with hardly any noise, most of which can be certified.
    Dense,
}

/// One sample of any kind: every space, spacing, density, noise, open and closed.
fn any_sample<M: Isotropic>(random: &mut Random, mix: Mix, name: &str, curve: Measured<M>) -> Option<Trial> {
    let spacing = [Spacing::Iid, Spacing::Even, Spacing::Jittered(0.4)][random.below(3)];
    let (noises, most_dense): (&[f64], _) = match mix {
        Mix::Any => (&[0.0, 0.0, 0.003, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5], 4.0),
        Mix::Dense => (&[0.0, 0.0, 0.0, 0.003, 0.01], 0.5),
    };
    let noise = noises[random.below(noises.len())];
    let n = match random.below(2) {
        1 if mix == Mix::Any => 8 + random.below(120),
        _ => curve.count_for(between(random, 0.1, most_dense), spacing),
    };
    if n > MOST_POINTS {
        return None;
    }
    let clean = curve.sample(random, n, spacing);
    let epsilon = curve.epsilon(&clean);
    let samples = with_noise(&curve.manifold, random, &clean, noise * curve.mean_gap(n));
    let trial = tried(&curve.manifold, random, &samples, curve.closed, epsilon);
    let ends = if curve.closed { "closed" } else { "open" };
    let noisy = if noise > 0.0 { "noisy" } else { "clean" };
    let spacing = format!("{spacing:?}");
    Some(Trial { kind: format!("{name} {ends} {noisy} {}", &spacing[..3]), ..trial })
}

/// The whole of a random loop, or a part of it.
fn any_curve<M: Isotropic, F: Fn(f64) -> M::Point + 'static>(
    random: &mut Random,
    mix: Mix,
    name: &str,
    manifold: M,
    draw: impl Fn(&mut Random) -> F,
) -> Option<Trial> {
    let at = draw(random);
    let curve = match random.below(2) {
        0 => Measured::closed(manifold, at),
        _ => {
            let span = std::f64::consts::TAU * (0.6 + 0.2 * random.signed());
            Measured::open(manifold, at, span)
        }
    };
    any_sample(random, mix, name, curve)
}

/// A sample of a random curve in any space; `None` where it would have too many points.
pub(crate) fn any_trial(random: &mut Random, mix: Mix) -> Option<Trial> {
    match random.below(5) {
        0 => any_curve(random, mix, "SE3", Se3::default(), pose_curve),
        1 => any_curve(random, mix, "R3", R3::default(), space_curve),
        2 => any_curve(random, mix, "R2", R2::default(), plane_curve),
        3 => any_curve(random, mix, "S2", Sphere, sphere_curve),
        _ => any_curve(random, mix, "R2 crossing", R2::default(), crossing_curve),
    }
}

/// A curve there and back, the way back moved aside by some share of a gap.
pub(crate) fn retraced(random: &mut Random) -> Option<Trial> {
    let there = Measured::open(Se3::default(), pose_curve(random), 0.5 * std::f64::consts::TAU);
    let spacing = [Spacing::Iid, Spacing::Even, Spacing::Jittered(0.4)][random.below(3)];
    let n = 10 + random.below(150);
    let aside = there.mean_gap(n) * (0.02_f64.ln() + 0.5 * (1.0 + random.signed()) * 100.0_f64.ln()).exp();
    let mut samples = there.sample(random, n, spacing);
    let back = there.sample(random, n, spacing);
    let direction = random.vector().normalize() * aside;
    samples.extend(back.iter().rev().map(|p| {
        let mut p = *p;
        p.translation.vector += direction;
        p
    }));
    let spacing = format!("{spacing:?}");
    let trial = tried(&there.manifold, random, &samples, false, f64::INFINITY);
    Some(Trial { kind: format!("SE3 retraced {}", &spacing[..3]), ..trial })
}

pub(crate) fn print_by_kind(trials: &[Trial]) {
    let mut kinds: Vec<_> = trials.iter().map(|t| t.kind.clone()).collect();
    kinds.sort();
    kinds.dedup();
    println!(
        "{:>26} {:>6} {:>7} {:>9} {:>6} {:>6} {:>9} {:>6}",
        "kind", "cases", "exact", "certified", "wrong", "topol.", "plausible", "wrong"
    );
    for kind in kinds {
        let of_kind: Vec<_> = trials.iter().filter(|t| t.kind == kind).collect();
        let count = |which: &dyn Fn(&Trial) -> bool| of_kind.iter().filter(|t| which(t)).count();
        let is = |t: &Trial, v| t.found.verdict == v;
        println!(
            "{kind:>26} {:>6} {:>7.3} {:>9} {:>6} {:>6} {:>9} {:>6}",
            of_kind.len(),
            share(&of_kind, |t| t.exact),
            count(&|t| is(t, Verdict::Certified)),
            count(&|t| is(t, Verdict::Certified) && !t.exact),
            count(&|t| is(t, Verdict::Certified) && !t.topology_right),
            count(&|t| is(t, Verdict::Plausible)),
            count(&|t| is(t, Verdict::Plausible) && !t.exact),
        );
    }
}
