//! The shipped arm on an emulated bus, run in lockstep: simulated time passes with the traffic and from step to step, and never by
//! itself, so that a run repeats whatever else the machine does.

// Each test binary uses its part of this.
#![allow(dead_code)]

use std::sync::atomic::{AtomicBool, Ordering};

use dynamixel_hil::emulator::{Rates, Timing};
use dynamixel_hil::planner::manipulator::nalgebra::DVector;
use dynamixel_hil::planner::manipulator::{JointTrajectory, Robot, TimingOptions, rest_to_rest};
use dynamixel_hil::planner::{Arm, Present};
use dynamixel_hil::{Config, DynamixelArm, HilError, Simulation};

pub(crate) const START: [f64; 6] = [0.0, -0.5, 0.7, 0.0, 1.37, 0.0];

pub(crate) fn config() -> Config {
    let shipped = Config::from_yaml(include_str!("../../../../config/arms/vx300s.yaml")).expect("it is shipped");
    // Answers are on time in simulation; on a busy machine the SDK, which goes by the wall clock, must wait for them a little longer.
    Config { latency_ms: 5.0, rate_hz: 200.0, ..shipped }
}

pub(crate) fn robot() -> Robot {
    config().robot().expect("it is shipped")
}

pub(crate) fn simulation() -> Simulation {
    Simulation::open(&config(), &START, Timing::BusTime).expect("the set-up has fetched the model")
}

/// From rest to rest, within the limits.
pub(crate) fn swing(from: &[f64], to: &[f64]) -> JointTrajectory {
    let column = DVector::from_column_slice;
    rest_to_rest(&robot(), &column(from), &column(to), &TimingOptions::default()).expect("both are within the limits")
}

/// A place that every joint is some way off.
pub(crate) fn elsewhere(from: &[f64]) -> Vec<f64> {
    let by = [0.6, -0.3, 0.4, 0.5, -0.4, 0.6];
    from.iter().zip(by).map(|(q, by)| q + by).collect()
}

/// An arm, its bus, and the time.
pub(crate) struct Lockstep {
    pub(crate) arm: DynamixelArm,
    pub(crate) simulation: Simulation,
    period_s: f64,
    steps: u64,
    /// Bus time less the arm's.
    origin_s: f64,
    /// The greatest true speed of a joint so far, in rad/s, and error from where it was to be, in rad.
    pub(crate) fastest_rad_s: f64,
    pub(crate) worst_rad: f64,
}

impl Lockstep {
    pub(crate) fn new() -> Self {
        Self::on(simulation()).expect("nothing is wrong with it")
    }

    pub(crate) fn on(simulation: Simulation) -> Result<Self, HilError> {
        let path = simulation.path();
        Self::at(simulation, &path)
    }

    /// By another name of the simulation's port.
    pub(crate) fn at(simulation: Simulation, path: &str) -> Result<Self, HilError> {
        let config = config();
        let period_s = 1.0 / config.rate_hz;
        let arm = DynamixelArm::open(config, path, simulation.clock())?;
        let origin_s = simulation.with_bus(|bus| bus.now_s()).expect("it is plugged in");
        Ok(Self { arm, simulation, period_s, steps: 0, origin_s, fastest_rad_s: 0.0, worst_rad: 0.0 })
    }

    /// One step of the arm, at its time on the bus; later where the bus was busy for too long, as in real time.
    pub(crate) fn step(&mut self) -> Present {
        self.steps += 1;
        let until_s = self.steps as f64 * self.period_s;
        let late_s = self.simulation.with_bus(|bus| {
            let late_s = bus.now_s() - self.origin_s - until_s;
            bus.advance(-late_s);
            late_s
        });
        if let Some(late_s) = late_s.filter(|late_s| *late_s > self.arm.most_behind_s()) {
            self.origin_s += late_s;
        }
        self.arm.run(until_s).expect("this arm can always be mended");
        let truth = self.simulation.view().now();
        self.fastest_rad_s = truth.velocity.iter().fold(self.fastest_rad_s, |most, v| most.max(v.abs()));
        let desired = self.arm.desired(self.arm.clock_s());
        let errors = truth.position.iter().zip(&desired).map(|(is, wanted)| (is - wanted).abs());
        self.worst_rad = errors.fold(self.worst_rad, f64::max);
        self.arm.present()
    }

    pub(crate) fn run(&mut self, seconds: f64) -> Present {
        let steps = (seconds / self.period_s).ceil() as usize;
        (0..steps).map(|_| self.step()).last().expect("at least a step")
    }

    /// Plays a swing to somewhere else, and steps to the middle of it.
    pub(crate) fn half_way(&mut self) -> JointTrajectory {
        let from = self.arm.present().goal;
        let trajectory = swing(&from, &elsewhere(&from));
        self.arm.play(None, trajectory.clone()).expect("it begins here");
        self.run(0.5 * trajectory.duration_s());
        trajectory
    }

    /// Lets the bus's time pass by itself while something waits for it.
    pub(crate) fn meanwhile<R>(&mut self, wait: impl FnOnce(&mut DynamixelArm) -> R) -> R {
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    self.simulation.with_bus(|bus| bus.advance(0.001));
                    std::thread::yield_now();
                }
            });
            let result = wait(&mut self.arm);
            done.store(true, Ordering::Relaxed);
            result
        })
    }

    /// Steps until the arm tells of a fault.
    pub(crate) fn until_fault(&mut self, seconds: f64) -> String {
        let steps = (seconds / self.period_s) as usize;
        (0..steps).find_map(|_| self.step().fault).expect("a fault within this time")
    }

    pub(crate) fn hurt(&self, rates: Rates) {
        self.simulation.with_bus(|bus| {
            bus.faults_mut().seed(7);
            (bus.faults_mut().to_servos, bus.faults_mut().to_host) = (rates, rates);
        });
    }
}
