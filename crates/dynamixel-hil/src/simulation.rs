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
    cable: Arc<Mutex<Cable>>,
    path: PathBuf,
    timing: Timing,
    view: PlantView,
}

/// Between the bus and the computer.
enum Cable {
    Plugged(EmulatedPort),
    /// `None` for a moment only.
    Unplugged(Option<Box<Bus>>),
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
        Ok(Self { cable: Arc::new(Mutex::new(Cable::Plugged(port))), path, timing, view })
    }

    /// What a master opens, as long as the cable is not pulled.
    pub fn path(&self) -> String {
        self.path.display().to_string()
    }

    /// The simulated truth.
    pub fn view(&self) -> &PlantView {
        &self.view
    }

    /// Looks at the bus or changes it, between two packets; `None` once it is unplugged.
    pub fn with_bus<R>(&self, look: impl FnOnce(&mut Bus) -> R) -> Option<R> {
        match &*self.lock() {
            Cable::Plugged(port) => Some(port.with_bus(look)),
            Cable::Unplugged(_) => None,
        }
    }

    /// Pulls the cable of the port. The servos keep their power, and what they were told; their time stands.
    pub fn unplug(&self) {
        let mut cable = self.lock();
        if let Cable::Plugged(port) = std::mem::replace(&mut *cable, Cable::Unplugged(None)) {
            *cable = Cable::Unplugged(Some(Box::new(port.unplug())));
        }
    }

    /// Puts the cable back. The system may give the port another name: what a master opens from now on.
    ///
    /// # Errors
    /// Where it is in place, or the system has no pseudo-terminal.
    pub fn plug_in(&self) -> Result<PathBuf> {
        let mut cable = self.lock();
        let Cable::Unplugged(bus) = &mut *cable else {
            return Err(HilError::Emulator("the cable is in place".to_owned()));
        };
        let bus = bus.take().ok_or_else(|| HilError::Emulator("the bus is gone".to_owned()))?;
        let port = EmulatedPort::open(*bus, self.timing).map_err(|error| HilError::Emulator(error.to_string()))?;
        let path = port.path().to_path_buf();
        *cable = Cable::Plugged(port);
        Ok(path)
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

    fn lock(&self) -> MutexGuard<'_, Cable> {
        self.cable.lock().unwrap_or_else(PoisonError::into_inner)
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
