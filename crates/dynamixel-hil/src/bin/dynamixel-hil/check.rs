//! Before anything moves: are the servos those of the configuration, and how are they?

use std::collections::BTreeMap;
use std::error::Error;

use dynamixel_hil::emulator::Timing;
use dynamixel_hil::register::{PRESENT_INPUT_VOLTAGE, PRESENT_POSITION, PRESENT_TEMPERATURE, TORQUE_ENABLE};
use dynamixel_hil::{Bus, Config, SIMULATED_PORT, Simulation, identify, joint_position};
use serde_json::{Value, json};

/// Reads, and writes nothing.
pub(crate) fn check(config: &Config) -> Result<Value, Box<dyn Error>> {
    let (mut bus, _simulation) = open(config)?;
    identify(&mut bus, config)?;
    let mut servos = Vec::with_capacity(config.servos.len());
    for servo in &config.servos {
        let mut read = |register| bus.read(servo.id, register);
        let (torque, position) = (read(TORQUE_ENABLE)?, read(PRESENT_POSITION)? as i32);
        let (voltage, temperature) = (read(PRESENT_INPUT_VOLTAGE)?, read(PRESENT_TEMPERATURE)?);
        let position_rad = joint_position(&mut bus, servo)?;
        let errors = bus.hardware_errors(servo.id)?;
        servos.push(json!({
            "id": servo.id,
            "name": servo.name,
            "model": servo.model.name(),
            "torque": torque != 0,
            "position_pulses": position,
            "joint": servo.joint,
            "position_rad": position_rad,
            "voltage_v": f64::from(voltage) / 10.0,
            "temperature_c": temperature,
            "errors": if errors.0 == 0 { Value::Null } else { errors.to_string().into() },
        }));
    }
    Ok(json!({ "port": config.port, "servos": servos }))
}

/// Switches every torque off, of servos that answer and whatever else is wrong.
pub(crate) fn release(config: &Config) -> Result<Value, Box<dyn Error>> {
    let (mut bus, _simulation) = open(config)?;
    let failed: Vec<String> =
        config.ids().into_iter().filter_map(|id| bus.set_torque(id, false).err()).map(|why| why.to_string()).collect();
    if failed.is_empty() { Ok(json!({ "released": config.ids() })) } else { Err(failed.join("; ").into()) }
}

fn open(config: &Config) -> Result<(Bus, Option<Simulation>), Box<dyn Error>> {
    let names: BTreeMap<_, _> = config.servos.iter().map(|servo| (servo.id, servo.name.clone())).collect();
    let (port, simulation) = match config.port.as_str() {
        SIMULATED_PORT => {
            let simulation = Simulation::open(config, config.robot()?.preferred.as_slice(), Timing::WallClock)?;
            (simulation.path(), Some(simulation))
        }
        port => (port.to_owned(), None),
    };
    Ok((Bus::open(&port, config.baud, config.latency_ms, names)?, simulation))
}
