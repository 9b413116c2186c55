//! How often an order is right, by how dense the sample is: closed curves of three harmonics in SE(3), independent samples. ε is half
//! the greatest gap over the curve's reach; the theorems ask for ε < 1.
//!
//! `cargo run --release -p reorder --example success_by_epsilon -- 5000` tries so many curves.

#[allow(dead_code)]
#[path = "../../se3-geom/examples/drawing/mod.rs"]
mod drawing;
#[path = "../tests/support/mod.rs"]
mod support;

use std::error::Error;
use std::path::Path;

use drawing::{Panel, gallery_path, write};
use plotters::style::{BLUE, MAGENTA, RED, RGBColor};
use reorder::{Options, Verdict, nearest_chain, nn_crust, order};
use se3_geom::Se3;
use se3_geom::nalgebra::Vector2;
use support::harmonics::{Measured, Spacing, pose_curve};
use support::{Random, neighbours};

/// Classes of ε, equally wide in its logarithm.
pub(crate) const CLASSES: usize = 8;
const LEAST: f64 = 0.25;
const MOST: f64 = 8.0;
const MOST_POINTS: usize = 1000;
const NAMES: [(&str, RGBColor); 4] = [
    ("order", BLUE),
    ("NN-CRUST", MAGENTA),
    ("nearest-neighbour chain", RED),
    ("order, not ambiguous", RGBColor(0, 140, 0)),
];

/// Share of right orders by class and method, and of orders that are vouched for; how many of those were wrong.
pub(crate) struct Numbers {
    pub(crate) cases: [usize; CLASSES],
    pub(crate) shares: [[f64; 4]; CLASSES],
    pub(crate) silently_wrong: usize,
}

/// Tries so many curves.
pub(crate) fn compute(curves: usize) -> Result<Numbers, Box<dyn Error>> {
    let mut random = Random::seeded(55);
    let (mut cases, mut counts, mut silently_wrong) = ([0; CLASSES], [[0_usize; 4]; CLASSES], 0);
    let class_of = |epsilon: f64| ((epsilon / LEAST).ln() / (MOST / LEAST).ln() * CLASSES as f64).floor();
    let mut tried = 0;
    while tried < curves {
        let curve = Measured::closed(Se3::default(), pose_curve(&mut random));
        let wanted = LEAST * (MOST / LEAST).powf(0.5 * (1.0 + random.signed()));
        let n = curve.count_for(wanted, Spacing::Iid);
        if n > MOST_POINTS {
            continue;
        }
        tried += 1;
        let samples = curve.sample(&mut random, n, Spacing::Iid);
        let class = class_of(curve.epsilon(&samples));
        if !(0.0..CLASSES as f64).contains(&class) {
            continue;
        }
        // The samples are in true order, which no method looks at: all break ties by row only, and there are none.
        let truth = neighbours(&(0..n).collect::<Vec<_>>(), true);
        let ordering = order(&curve.manifold, &samples, &Options::default())?;
        let exact = neighbours(&ordering.order, true) == truth;
        let drawn: Vec<_> = nn_crust(&curve.manifold, &samples).edges().iter().map(|&[a, b]| (a, b)).collect();
        let chain = nearest_chain(&curve.manifold, &samples, random.below(n));
        let vouched = ordering.verdict != Verdict::Ambiguous;
        silently_wrong += usize::from(vouched && !exact);
        let class = class as usize;
        cases[class] += 1;
        for (count, right) in
            counts[class].iter_mut().zip([exact, drawn == truth, neighbours(&chain, true) == truth, vouched])
        {
            *count += usize::from(right);
        }
    }
    let share = |k: usize| counts[k].map(|count| count as f64 / cases[k].max(1) as f64);
    Ok(Numbers { cases, shares: std::array::from_fn(share), silently_wrong })
}

fn middle(class: usize) -> f64 {
    LEAST * (MOST / LEAST).powf((class as f64 + 0.5) / CLASSES as f64)
}

/// Shares over log₂ ε; three units high, so that one scale serves both axes.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let mut panel = Panel::new("right orders over log2 of epsilon; 3 is all of them");
    for (k, (name, colour)) in NAMES.into_iter().enumerate() {
        let filled = (0..CLASSES).filter(|&class| numbers.cases[class] > 0);
        panel.line(
            filled.map(|class| Vector2::new(middle(class).log2(), 3.0 * numbers.shares[class][k])),
            colour,
            name,
        );
    }
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let curves = std::env::args().nth(1).map_or(Ok(400), |n| n.parse())?;
    let numbers = compute(curves)?;
    println!("{:>8} {:>6} {:>8} {:>9} {:>8} {:>8}", "epsilon", "cases", "order", "NN-CRUST", "chain", "vouched");
    for class in 0..CLASSES {
        let [ours, nn_crust, chain, vouched] = numbers.shares[class];
        let (epsilon, cases) = (middle(class), numbers.cases[class]);
        println!("{epsilon:>8.2} {cases:>6} {ours:>8.3} {nn_crust:>9.3} {chain:>8.3} {vouched:>8.3}");
    }
    println!("vouched for and wrong: {}", numbers.silently_wrong);
    let path = gallery_path("success_by_epsilon")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
