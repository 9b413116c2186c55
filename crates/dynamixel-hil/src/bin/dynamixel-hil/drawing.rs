//! Every shape once, and how well it went.

use std::error::Error;
use std::path::PathBuf;

use dynamixel_hil::Config;
use dynamixel_hil::emulator::Timing;
use dynamixel_hil::planner::Arm;
use serde_json::{Value, json};

use crate::motion::Record;
use crate::pacer::open;
use crate::shape::plan_all;

/// Steps in which the arm only holds, before it moves.
const HOLD_STEPS: usize = 50;

pub(crate) fn draw_all(config: &Config, bags: &[PathBuf], timing: Timing) -> Result<Value, Box<dyn Error>> {
    let robot = config.robot()?;
    let shapes = plan_all(&robot, robot.preferred.as_slice(), bags)?;
    let mut runs = Vec::with_capacity(shapes.len());
    let mut start = robot.preferred.as_slice().to_vec();
    for shape in &shapes {
        // A bus of its own for each, so that the figures are its own.
        let (mut arm, simulation, mut pacer) = open(config, &start, timing)?;
        for _ in 0..HOLD_STEPS {
            pacer.step(&mut arm)?;
        }
        let record = Record::of(shape, &mut arm, &simulation, &mut pacer)?;
        let [pose_m, pose_rad] = record.pose_errors(&robot, shape);
        let (counters, steps) = (arm.counters(), arm.step_times());
        runs.push(json!({
            "name": shape.name,
            "robot": config.robot,
            "n_poses": shape.poses.len(),
            "verdict": shape.verdict,
            "duration_s": shape.trajectory.duration_s(),
            "tracking_rms_rad": record.rms_rad(),
            "tracking_max_rad": record.max_rad,
            "pose_error_max_m": pose_m,
            "pose_error_max_rad": pose_rad,
            "fastest_rad_s": record.fastest_rad_s,
            "rate_hz": steps.rate_hz(),
            "jitter_rms_ms": 1e3 * steps.jitter_rms_s(),
            "longest_step_ms": 1e3 * steps.longest_s(),
            "packets": counters.sent,
            "retries": counters.retries,
            "errors": counters.timeouts + counters.corrupt,
        }));
        start = arm.present().goal;
    }
    Ok(json!({ "runs": runs }))
}
