//! The port `sim`: an emulated bus whose servos move the arm in MuJoCo.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use dynamixel_emulator::units::BAUD_RATES;
use dynamixel_emulator::{Bus, EmulatedPort, ServoSettings, Timing, item};

use crate::arm::{Clock, DynamixelArm};
use crate::config::{Config, SIMULATED_PORT};
use crate::error::{HilError, Result};
use crate::plant::{ArmPlant, PlantView};

/// An emulated bus with the arm behind it. It ends when its last copy does.
#[derive(Clone)]
pub struct Simulation {
    port: Arc<Mutex<Option<EmulatedPort>>>,
    path: PathBuf,
    view: PlantView,
}

impl Simulation {
    /// Servos as the factory sends them, but for ID and rate, on an arm that stands at `start` (rad, in the robot's joint order) as if
    /// somebody held it until its torque is on.
    ///
    /// # Errors
    /// Where there is no model of the arm, or the system has no pseudo-terminal.
    pub fn open(config: &Config, start: &[f64], timing: Timing) -> Result<Self> {
        let plant = ArmPlant::new(config, &config.robot()?, start)?;
        let view = plant.view();
        let rate = BAUD_RATES.iter().position(|&baud| baud == config.baud);
        let rate = rate.ok_or_else(|| HilError::Emulator(format!("servos do not know {} baud", config.baud)))?;
        let servos = config.servos.iter();
        let servos =
            servos.map(|servo| ServoSettings::new(servo.id, servo.model.into()).with(item::BAUD_RATE, rate as i32));
        let failed = |error: dynamixel_emulator::Error| HilError::Emulator(error.to_string());
        let bus = Bus::new(servos.collect(), Box::new(plant)).map_err(failed)?;
        let port = EmulatedPort::open(bus, timing).map_err(failed)?;
        let path = port.path().to_path_buf();
        Ok(Self { port: Arc::new(Mutex::new(Some(port))), path, view })
    }

    /// What a master opens.
    pub fn path(&self) -> String {
        self.path.display().to_string()
    }

    /// The simulated truth.
    pub fn view(&self) -> &PlantView {
        &self.view
    }

    /// Looks at the bus or changes it, between two packets; `None` once it is unplugged.
    pub fn with_bus<R>(&self, look: impl FnOnce(&mut Bus) -> R) -> Option<R> {
        self.lock().as_ref().map(|port| port.with_bus(look))
    }

    /// Pulls the cable of the port.
    pub fn unplug(&self) {
        self.lock().take();
    }

    /// The time of the bus, which stands once it is unplugged.
    pub fn clock(&self) -> Clock {
        let bus = self.clone();
        let mut last_s = 0.0;
        let last = Mutex::new(move || {
            last_s = bus.with_bus(|bus| bus.now_s()).unwrap_or(last_s);
            last_s
        });
        Box::new(move || (last.lock().unwrap_or_else(PoisonError::into_inner))())
    }

    fn lock(&self) -> MutexGuard<'_, Option<EmulatedPort>> {
        self.port.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The arm of a configuration, holding where it stands, in real time; with the simulation behind it, which it keeps, where the port is
/// `sim`. That one begins at `start` (rad), else where the robot's settings prefer it.
///
/// # Errors
/// As [`DynamixelArm::open`] and [`Simulation::open`].
pub fn open(config: Config, start: Option<&[f64]>) -> Result<(DynamixelArm, Option<Simulation>)> {
    let began = Instant::now();
    let clock = Box::new(move || began.elapsed().as_secs_f64());
    if config.port != SIMULATED_PORT {
        let port = config.port.clone();
        return Ok((DynamixelArm::open(config, &port, clock)?, None));
    }
    let preferred = config.robot()?.preferred;
    let simulation = Simulation::open(&config, start.unwrap_or(preferred.as_slice()), Timing::WallClock)?;
    let mut arm = DynamixelArm::open(config, &simulation.path(), clock)?;
    arm.keep(simulation.clone());
    Ok((arm, Some(simulation)))
}
