//! The `reorder` command: orders poses, plans trajectories through them, and shows what came of it.

mod ask;
mod drawn;
mod failure;
mod order;
mod output;
mod plan;
mod progress;
mod replay;
mod report;
mod simulate;
mod source;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(version, about = "Poses in any order come in; an ordered, C2, executable trajectory goes out.")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Recover the order of points sampled from a curve
    Order(order::Arguments),
    /// Plan an audited joint trajectory through unordered poses
    Plan(plan::Arguments),
    /// Put the poses of recordings in order, of one bag or many, and compare with how they were recorded
    Replay(replay::Arguments),
    /// Show points, order, plan and doubts on one self-contained HTML page
    Report(report::Arguments),
    /// Execute a planned trajectory in MuJoCo (by the program reorder-simulate, which needs MuJoCo; see its --help)
    #[command(disable_help_flag = true)]
    Simulate(simulate::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Order(arguments) => order::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            failure.exit_code()
        }
    }
}
