//! `se3-geom`: groups beside Pinocchio's, the spline through poses beside scipy's.

use crate::bench::figure::{Bound, Figure, Peer};
use crate::bench::peers::Peers;
use crate::bench::programs::{Costs, Program, run_in_turn};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;

const REQUIREMENTS: &str = include_str!("geometry/requirements.txt");
const SCIPY: &str = include_str!("geometry/scipy_splines.py");
const PINOCCHIO: &str = "crates/xtask/src/bench/geometry/pinocchio_groups.cpp";

const PINOCCHIO_NAME: &str = "Pinocchio 4.1.0 (C++)";
const SCIPY_NAME: &str = "scipy 1.17.1";

/// Name, unit and how many of it a second has, our cost, whose is the other and its cost, bound.
type Row = (&'static str, (&'static str, f64), &'static str, (&'static str, &'static str), f64);

const NS: (&str, f64) = ("ns", 1e9);
const MS: (&str, f64) = ("ms", 1e3);

const ROWS: [Row; 9] = [
    ("SO(3) exp", NS, "SO(3) exp", (PINOCCHIO_NAME, "SO(3) exp"), 11.0),
    ("SO(3) log", NS, "SO(3) log", (PINOCCHIO_NAME, "SO(3) log"), 15.0),
    ("SE(3) exp", NS, "SE(3) exp", (PINOCCHIO_NAME, "SE(3) exp"), 27.0),
    ("SE(3) log", NS, "SE(3) log", (PINOCCHIO_NAME, "SE(3) log"), 48.0),
    ("pose, twist, acceleration: sorted points", NS, "sorted", (SCIPY_NAME, "sorted"), 150.0),
    ("pose, twist, acceleration: random points", NS, "random", (SCIPY_NAME, "random"), 300.0),
    ("1e6 sorted points into a new vector", MS, "batch", (SCIPY_NAME, "batch"), 150.0),
    ("1e6 sorted points into a vector used before", MS, "batch again", (SCIPY_NAME, "batch"), 150.0),
    ("fit of 1e4 knots", MS, "fit", (SCIPY_NAME, "fit"), 8.0),
];

pub(crate) fn measure(layout: &Layout) -> Outcome<Vec<Figure>> {
    let peers = Peers::of(layout, "geometry", REQUIREMENTS)?;
    let ours = build_executables(layout, &["bench", "--no-run", "--package", "se3-geom", "--bench", "figures"])?;
    let ours = ours.first().ok_or_else(|| Failure::step("cargo bench", "no program figures was built".to_owned()))?;
    let mut programs = vec![
        Program { name: "figures", command: layout.command(ours) },
        Program { name: SCIPY_NAME, command: peers.python(layout, SCIPY) },
    ];
    let compiled = layout.root().join("target/bench/pinocchio_groups");
    if let Some(command) = peers.compile(layout, &layout.root().join(PINOCCHIO), &compiled)? {
        programs.push(Program { name: PINOCCHIO_NAME, command });
    }
    let names: Vec<_> = programs.iter().map(|program| program.name).collect();
    let costs = run_in_turn(&mut programs)?;
    let cost_of = |program: &str, cost: &str| {
        let (_, costs): (_, &Costs) = names.iter().zip(&costs).find(|(name, _)| **name == program)?;
        costs.get(cost).copied()
    };
    ROWS.iter()
        .map(|&(name, (unit, per_second), our_cost, (peer_name, peer_cost), bound)| {
            let missing = || Failure::step("figures", format!("it did not print {our_cost}"));
            let ours = cost_of("figures", our_cost).ok_or_else(missing)? * per_second;
            let peer = cost_of(peer_name, peer_cost).map(|cost| Peer { name: peer_name, value: cost * per_second });
            Ok(Figure { name, unit, ours, peer, bound: Bound::Ours(bound) })
        })
        .collect()
}
