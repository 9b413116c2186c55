//! `reorder`: exact minimum spanning trees beside quitefastmst's, and the whole command on a million poses.

use std::fs;

use crate::bench::figure::{Bound, Figure, Peer};
use crate::bench::peers::Peers;
use crate::bench::programs::{Costs, Program, run_in_turn};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::python::output;

const REQUIREMENTS: &str = include_str!("ordering/requirements.txt");
const POINTS: &str = include_str!("ordering/points.py");
const QUITEFASTMST: &str = include_str!("ordering/quitefastmst_trees.py");
const WHOLE_COMMAND: &str = include_str!("ordering/whole_command.py");

const TREES: &str = "figures";
const PEER: &str = "quitefastmst 0.9.2";
const COMMAND: &str = "reorder order";

/// Name and unit of a figure, whose cost it is and what it is compared with, by program and name, and the bound.
type Row = (&'static str, &'static str, [&'static str; 2], Option<[&'static str; 3]>, Bound);

const fn tree(name: &'static str, cost: &'static str, peer: [&'static str; 3], bound: f64) -> Row {
    (name, "s", [TREES, cost], Some(peer), Bound::Ratio(bound))
}

const SMOOTH: [&str; 3] = [TREES, "se3 smooth 1e5", "ours, smooth set"];

const ROWS: [Row; 12] = [
    tree("tree of 1e6 points in R3, noisy curve", "r3 1e6", [PEER, "r3 1e6", PEER], 0.65),
    tree("tree of 1e5 points in R7, noisy curve", "r7 1e5", [PEER, "r7 1e5", PEER], 0.35),
    tree(
        "tree of 1e5 poses, exact",
        "se3 smooth 1e5",
        [PEER, "embedded smooth 1e5", "quitefastmst 0.9.2, inexact embedding"],
        0.6,
    ),
    ("tree of 1e6 poses, exact", "s", [TREES, "se3 smooth 1e6"], None, Bound::Ours(4.0)),
    tree("tree of 1e5 poses: full turns", "se3 full turns 1e5", SMOOTH, 3.0),
    tree("tree of 1e5 poses: clusters", "se3 clusters 1e5", SMOOTH, 3.0),
    tree("tree of 1e5 poses: duplicates", "se3 duplicates 1e5", SMOOTH, 3.0),
    tree("tree of 1e5 poses: identical", "se3 identical 1e5", SMOOTH, 3.0),
    tree("tree of 1e5 poses: uniform", "se3 uniform 1e5", SMOOTH, 3.0),
    tree(
        "tree of 1e6 poses, two threads (wall)",
        "two threads, wall",
        [TREES, "one thread, wall", "ours, one thread"],
        0.667,
    ),
    ("reorder order, 1e6 poses from CSV (wall)", "s", [COMMAND, "seconds"], None, Bound::Ours(12.0)),
    ("reorder order, 1e6 poses from CSV: memory", "MiB", [COMMAND, "MiB"], None, Bound::Ours(1536.0)),
];

pub(crate) fn measure(layout: &Layout) -> Outcome<Vec<Figure>> {
    let peers = Peers::of(layout, "ordering", REQUIREMENTS)?;
    let folder = layout.root().join("target/bench/ordering");
    fs::create_dir_all(&folder).map_err(Failure::io("create", &folder))?;
    let csv = folder.join("poses.csv");
    // Written last.
    if !csv.exists() {
        println!("writing the points to {} …", folder.display());
        output("the sets of points", peers.python(layout, POINTS).arg(&folder))?;
    }
    let build = |arguments: &[&str]| -> Outcome<_> {
        let missing = || Failure::step("cargo", "no program was built".to_owned());
        build_executables(layout, arguments)?.into_iter().next().ok_or_else(missing)
    };
    let trees = build(&["bench", "--no-run", "--package", "reorder", "--bench", "figures"])?;
    let reorder = build(&["build", "--release", "--package", "reorder-cli"])?;
    let mut ours = layout.command(trees);
    ours.arg(&folder);
    let mut quitefastmst = peers.python(layout, QUITEFASTMST);
    quitefastmst.arg(&folder);
    let mut whole = peers.python(layout, WHOLE_COMMAND);
    whole.arg(reorder).arg("order").arg(&csv);
    let mut programs =
        [(TREES, ours), (PEER, quitefastmst), (COMMAND, whole)].map(|(name, command)| Program { name, command });
    let costs = run_in_turn(&mut programs)?;
    let cost_of = |program: &str, name: &str| -> Outcome<f64> {
        let costs: Option<&Costs> =
            programs.iter().zip(&costs).find(|(p, _)| p.name == program).map(|(_, costs)| costs);
        let missing = || Failure::step("measuring", format!("{program} did not print {name}"));
        costs.and_then(|costs| costs.get(name).copied()).ok_or_else(missing)
    };
    let figure = |&(name, unit, [program, cost], ref peer, bound): &Row| {
        let value = |[program, cost, name]: [&'static str; 3]| Ok(Peer { name, value: cost_of(program, cost)? });
        let peer = peer.map(value).transpose()?;
        Ok(Figure { name, unit, ours: cost_of(program, cost)?, peer, bound })
    };
    ROWS.iter().map(figure).collect()
}
