//! Programs that print costs as one JSON object, run in turn.

use std::collections::BTreeMap;
use std::process::{Command, Stdio};

use crate::failure::{Failure, Outcome};

/// An odd number, so that the median is one of the measurements.
const ROUNDS: usize = 5;

/// A program of ours or of a peer.
pub(crate) struct Program {
    pub(crate) name: &'static str,
    pub(crate) command: Command,
}

/// Costs by the name that the programs give them.
pub(crate) type Costs = BTreeMap<String, f64>;

/// Runs all programs in turn, round after round, and returns for each the medians over the rounds.
pub(crate) fn run_in_turn(programs: &mut [Program]) -> Outcome<Vec<Costs>> {
    let mut rounds = vec![Vec::new(); programs.len()];
    for round in 1..=ROUNDS {
        println!("round {round} of {ROUNDS} …");
        for (program, costs) in programs.iter_mut().zip(&mut rounds) {
            costs.push(run(program)?);
        }
    }
    Ok(rounds.iter().map(|rounds| medians(rounds)).collect())
}

fn run(program: &mut Program) -> Outcome<Costs> {
    let output =
        program.command.stderr(Stdio::inherit()).output().map_err(Failure::io("run", program.command.get_program()))?;
    if !output.status.success() {
        return Err(Failure::Command { what: program.name.to_owned(), status: output.status });
    }
    serde_json::from_slice(&output.stdout).map_err(|error| Failure::step(program.name, error.to_string()))
}

/// The median of every cost that all rounds have.
fn medians(rounds: &[Costs]) -> Costs {
    let names = rounds.first().into_iter().flat_map(|costs| costs.keys());
    let median = |name: &String| {
        let mut values: Vec<f64> = rounds.iter().filter_map(|costs| costs.get(name).copied()).collect();
        values.sort_by(f64::total_cmp);
        (name.clone(), values[values.len() / 2])
    };
    names.map(median).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_over_the_rounds_counts() {
        let rounds = [3.0, 100.0, 1.0].map(|value| Costs::from([("exp".to_owned(), value), ("log".to_owned(), 7.0)]));
        assert_eq!(medians(&rounds), Costs::from([("exp".to_owned(), 3.0), ("log".to_owned(), 7.0)]));
    }

    #[test]
    fn a_program_that_fails_or_prints_something_else_is_named() {
        for (script, says) in [("exit 3", "peer failed with"), ("echo fast", "peer failed: expected")] {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            let failure = run(&mut Program { name: "peer", command }).unwrap_err().to_string();
            assert!(failure.starts_with(says), "{failure}");
        }
    }
}
