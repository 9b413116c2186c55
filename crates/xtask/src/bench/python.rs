//! The Python package: splines beside scipy's, orders beside a tree that numba compiles and beside the Rust call.

use std::fs;

use crate::bench::figure::{Bound, Figure, Peer};
use crate::bench::peers::Peers;
use crate::bench::programs::{Program, run_in_turn};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::python::output;
use crate::{setup, wheel};

const REQUIREMENTS: &str = include_str!("python/requirements.txt");
const POINTS: &str = include_str!("python/points.py");
const OURS: &str = include_str!("python/ours.py");
const PRIM: &str = include_str!("python/numba_prim.py");
const SPLINES: &str = include_str!("geometry/scipy_splines.py");

const PACKAGE: &str = "the package reorder";
const RUST: &str = "the Rust call";
const NUMBA: &str = "numba 0.68.1, the tree alone";
const SCIPY: &str = "scipy 1.17.1";

/// Name of a figure, our cost, whose the other is and its cost, and the greatest ratio.
type Row = (&'static str, &'static str, (&'static str, &'static str), f64);

const ROWS: [Row; 4] = [
    ("1e6 poses, twists, accelerations of a spline", "batch", (SCIPY, "batch"), 1.0 / 3.0),
    ("order of 1e4 noisy poses (wall)", "order noisy 1e4", (NUMBA, "noisy 1e4"), 1.0 / 20.0),
    // With the certificate and the trees at both other weights, of which the other program has nothing.
    ("order of 1e4 clean poses, certified (wall)", "order clean 1e4", (NUMBA, "clean 1e4"), 1.0 / 5.0),
    ("order of 1e6 poses from numpy (wall)", "order clean 1e6", (RUST, "order clean 1e6"), 1.1),
];

pub(crate) fn measure(layout: &Layout) -> Outcome<Vec<Figure>> {
    let peers = Peers::of(layout, "python", REQUIREMENTS)?;
    setup::take(layout, vec![wheel::step(layout)])?;
    let folder = layout.root().join("target/bench/python");
    fs::create_dir_all(&folder).map_err(Failure::io("create", &folder))?;
    output("the sets of poses", peers.python(layout, POINTS).arg(&folder))?;
    let built = wheel::build(layout, "release", &folder.join("dist"))?;
    let ours = wheel::clean_environment(layout, &folder.join("environment"), &built)?;
    let rust = build_executables(layout, &["bench", "--no-run", "--package", "reorder", "--bench", "whole_order"])?;
    let rust = rust.first().ok_or_else(|| Failure::step("cargo bench", "no whole_order was built".to_owned()))?;

    let mut package = layout.command(ours.join("bin/python"));
    package.args(["-c", OURS]).env_remove("PYTHONPATH");
    let [prim, splines] = [PRIM, SPLINES].map(|program| peers.python(layout, program));
    let mut programs = [(PACKAGE, package), (RUST, layout.command(rust)), (NUMBA, prim), (SCIPY, splines)]
        .map(|(name, command)| Program { name, command });
    programs.iter_mut().for_each(|program| {
        program.command.arg(&folder);
    });
    let costs = run_in_turn(&mut programs)?;
    let cost_of = |program: &str, name: &str| {
        let costs = programs.iter().zip(&costs).find(|(p, _)| p.name == program).map(|(_, costs)| costs);
        let missing = || Failure::step("measuring", format!("{program} did not print {name}"));
        costs.and_then(|costs| costs.get(name).copied()).ok_or_else(missing)
    };
    ROWS.iter()
        .map(|&(name, our_cost, (peer, peer_cost), ratio)| {
            let value = cost_of(peer, peer_cost)?;
            let peer = Some(Peer { name: peer, value });
            Ok(Figure { name, unit: "s", ours: cost_of(PACKAGE, our_cost)?, peer, bound: Bound::Ratio(ratio) })
        })
        .collect()
}
