//! What a session is expected to hand out.

use planner::{Job, Outcome, Output};

pub(crate) fn only_job(outputs: Vec<Output>) -> Job {
    let [Output::Run(job)] = <[Output; 1]>::try_from(outputs).unwrap() else { panic!("no job") };
    job
}

pub(crate) fn only_outcome(outputs: Vec<Output>) -> Box<Outcome> {
    let [Output::Publish(outcome)] = <[Output; 1]>::try_from(outputs).unwrap() else { panic!("nothing published") };
    outcome
}
