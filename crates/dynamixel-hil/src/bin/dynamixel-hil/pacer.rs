//! What a control loop goes by: the wall clock, or the time of an emulated bus.

use std::error::Error;
use std::time::{Duration, Instant};

use dynamixel_hil::emulator::Timing;
use dynamixel_hil::planner::{Arm, ArmLost};
use dynamixel_hil::{Config, DynamixelArm, Simulation};

/// Lets an arm's time pass, step by step.
pub(crate) struct Pacer {
    steps: u64,
    period_s: f64,
    clock: Clock,
}

enum Clock {
    Wall(Instant),
    /// Simulated time passes with the traffic and from step to step, so that a run repeats, however busy the machine is.
    Bus(Simulation, f64),
}

/// A simulated arm that stands at `start`, and what it goes by.
pub(crate) fn open(
    config: &Config,
    start: &[f64],
    timing: Timing,
) -> Result<(DynamixelArm, Simulation, Pacer), Box<dyn Error>> {
    if config.port != dynamixel_hil::SIMULATED_PORT {
        return Err("on a real arm nobody could say where its joints are: set port to sim".into());
    }
    let simulation = Simulation::open(config, start, timing)?;
    let began = Instant::now();
    let clock: dynamixel_hil::Clock = match timing {
        Timing::WallClock => Box::new(move || began.elapsed().as_secs_f64()),
        Timing::BusTime => simulation.clock(),
    };
    let arm = DynamixelArm::open(config.clone(), &simulation.path(), clock)?;
    let clock = match timing {
        Timing::WallClock => Clock::Wall(Instant::now()),
        Timing::BusTime => Clock::Bus(simulation.clone(), now_s(&simulation)),
    };
    let pacer = Pacer { steps: 0, period_s: 1.0 / config.rate_hz, clock };
    Ok((arm, simulation, pacer))
}

impl Pacer {
    /// Waits for the next step, and has the arm make it.
    pub(crate) fn step(&mut self, arm: &mut dyn Arm) -> Result<(), ArmLost> {
        self.steps += 1;
        let until_s = self.steps as f64 * self.period_s;
        // Behind by more than the arm makes up for, everything comes later.
        let most_behind_s = arm.most_behind_s();
        match &mut self.clock {
            Clock::Wall(began) => {
                let due = *began + Duration::from_secs_f64(until_s);
                let now = Instant::now();
                // A pace, not a wait for an event.
                std::thread::sleep(due.saturating_duration_since(now));
                if now > due + Duration::from_secs_f64(most_behind_s) {
                    *began += now - due;
                }
            }
            Clock::Bus(simulation, origin_s) => {
                let late_s = now_s(simulation) - *origin_s - until_s;
                simulation.with_bus(|bus| bus.advance(-late_s));
                if late_s > most_behind_s {
                    *origin_s += late_s;
                }
            }
        }
        arm.run(until_s)
    }
}

fn now_s(simulation: &Simulation) -> f64 {
    simulation.with_bus(|bus| bus.now_s()).unwrap_or_default()
}
