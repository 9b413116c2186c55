//! The shapes again and again on a bus that damages packets.

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use dynamixel_hil::Config;
use dynamixel_hil::emulator::{Rates, Timing};
use dynamixel_hil::planner::Arm;
use dynamixel_hil::planner::manipulator::nalgebra::DVector;
use dynamixel_hil::planner::manipulator::{TimingOptions, rest_to_rest};
use serde_json::{Value, json};

use crate::motion::Record;
use crate::pacer::open;
use crate::shape::{Shape, plan_all};

/// A joint of an arm that is led within its speed is hardly faster: it swings a little.
const SWING: f64 = 1.1;

pub(crate) fn run(config: &Config, bags: &[PathBuf], seconds: f64, corrupted: f64) -> Result<Value, Box<dyn Error>> {
    let robot = config.robot()?;
    let start = robot.preferred.as_slice().to_vec();
    let mut round = plan_all(&robot, &start, bags)?;
    if let Some(last) = round.last().and_then(|shape| shape.trajectory.points.last()) {
        let (from, to) = (DVector::from_column_slice(&last.positions), DVector::from_column_slice(&start));
        let trajectory = rest_to_rest(&robot, &from, &to, &TimingOptions::default())?;
        let (name, verdict) = ("the way back".to_owned(), Value::Null);
        round.push(Shape { name, poses: Vec::new(), pose_times_s: Vec::new(), trajectory, verdict });
    }
    let (mut arm, simulation, mut pacer) = open(config, &start, Timing::WallClock)?;

    let mut rms = |damage: bool, seconds: f64| -> Result<Round, Box<dyn Error>> {
        let rate = if damage { corrupted } else { 0.0 };
        let rates = Rates { corrupted: rate, ..Rates::default() };
        simulation.with_bus(|bus| (bus.faults_mut().to_servos, bus.faults_mut().to_host) = (rates, rates));
        let (mut done, began) = (Round::default(), Instant::now());
        while done.motions == 0 || began.elapsed().as_secs_f64() < seconds {
            for shape in &round {
                match Record::of(shape, &mut arm, &simulation, &mut pacer) {
                    Ok(record) => done.add(&record, SWING * config.velocity_rad_s),
                    Err(why) => {
                        done.faults.push(why);
                        return Ok(done);
                    }
                }
            }
        }
        Ok(done)
    };
    let clean = rms(false, 0.0)?;
    let damaged = rms(true, seconds)?;
    let (counters, steps) = (arm.counters(), arm.step_times());
    let faults = [clean.faults.as_slice(), &damaged.faults].concat();
    Ok(json!({
        "corrupted": corrupted,
        "motions": damaged.motions,
        "faults": faults,
        "jumps": clean.jumps + damaged.jumps,
        "clean_rms_rad": clean.rms_rad(),
        "damaged_rms_rad": damaged.rms_rad(),
        "ratio": damaged.rms_rad() / clean.rms_rad(),
        "packets": counters.sent,
        "damaged_packets": simulation.with_bus(|bus| bus.faults().hurt),
        "missed": counters.timeouts + counters.corrupt,
        "rate_hz": steps.rate_hz(),
        "jitter_rms_ms": 1e3 * steps.jitter_rms_s(),
        "longest_step_ms": 1e3 * steps.longest_s(),
        "servo_faults": arm.present().fault,
    }))
}

/// Some motions one after the other.
#[derive(Default)]
struct Round {
    motions: usize,
    jumps: usize,
    squares: f64,
    faults: Vec<String>,
}

impl Round {
    fn add(&mut self, record: &Record, fastest_rad_s: f64) {
        self.motions += 1;
        self.jumps += usize::from(record.fastest_rad_s > fastest_rad_s);
        self.squares += record.rms_rad().powi(2);
    }

    fn rms_rad(&self) -> f64 {
        (self.squares / self.motions.max(1) as f64).sqrt()
    }
}
