//! `manipulator` and `planner`: kinematics, timing and whole plans of 200 poses against their bounds.

use crate::bench::figure::{Bound, Figure};
use crate::bench::programs::{Program, run_in_turn};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;

/// Name, unit, the name that the program gives it, bound.
type Row = (&'static str, &'static str, &'static str, f64);

const ROWS: [Row; 10] = [
    ("inverse kinematics, a pose", "us", "ik us", 10.0),
    ("inverse dynamics, 7 joints", "us", "inverse dynamics us", 2.0),
    ("one TOPP2-RA solution, 7 joints, 1000 gridpoints", "ms", "timing 1000 gridpoints ms", 2.0),
    ("timing without jerk limits, corrected and audited", "ms", "audited timing ms", 15.0),
    ("plan of 200 poses, median", "ms", "plan ms", 250.0),
    ("plan of 200 poses without jerk limits, median", "ms", "plan without jerk ms", 20.0),
    ("duration over second-order bound, median", "-", "duration ratio median", 1.2),
    ("duration over second-order bound, p95", "-", "duration ratio p95", 2.0),
    ("duration over uncorrected solution, median", "-", "corrections ratio median", 1.01),
    ("duration over uncorrected solution, p95", "-", "corrections ratio p95", 1.06),
];

pub(crate) fn measure(layout: &Layout) -> Outcome<Vec<Figure>> {
    let plans = build_executables(layout, &["bench", "--no-run", "--package", "planner", "--bench", "plans"])?;
    let plans = plans.first().ok_or_else(|| Failure::step("cargo bench", "no program plans was built".to_owned()))?;
    let costs = run_in_turn(&mut [Program { name: "plans", command: layout.command(plans) }])?;
    let figure = |&(name, unit, cost, bound): &Row| {
        let ours = costs.first().and_then(|costs| costs.get(cost).copied());
        let missing = || Failure::step("plans", format!("it did not print {cost}"));
        Ok(Figure { name, unit, ours: ours.ok_or_else(missing)?, peer: None, bound: Bound::Ours(bound) })
    };
    ROWS.iter().map(figure).collect()
}
