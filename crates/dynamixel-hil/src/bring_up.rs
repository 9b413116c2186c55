//! From a bus that is open to servos that are what the configuration says, set up and ready to hold where they stand.

use std::time::Duration;

use crate::bus::Bus;
use crate::config::Config;
use crate::error::{HilError, Result};
use crate::model::Model;
use crate::register::{
    DRIVE_MODE, GOAL_POSITION, Mode, OPERATING_MODE, POSITION_D_GAIN, POSITION_I_GAIN, POSITION_P_GAIN,
    PRESENT_POSITION, PROFILE_ACCELERATION, PROFILE_VELOCITY, RETURN_DELAY_TIME, Register, SECONDARY_ID, TORQUE_ENABLE,
    VELOCITY_UNIT_RAD_S, within_a_turn,
};
use crate::servo_state::ServoState;

/// Bit 0 of Drive Mode: clockwise is positive.
const REVERSED: u32 = 0x01;
/// As a Secondary ID.
const NO_ID: u32 = 255;
/// A servo that starts anew is back by then.
const REBOOT_TRIES: usize = 20;
const REBOOT_PAUSE: Duration = Duration::from_millis(50);

/// Checks that every servo is there, alone with its ID, and of the model that it should be.
///
/// # Errors
/// The first that is not, in a sentence.
pub fn identify(bus: &mut Bus, config: &Config) -> Result<()> {
    for (index, servo) in config.servos.iter().enumerate() {
        let number = match bus.ping(servo.id) {
            // Where not even the first one answers, it is hardly its own fault.
            Err(HilError::Silent { .. }) if index == 0 && bus.scan().is_err() => {
                return Err(bus.all_silent());
            }
            answer => answer?,
        };
        if number != servo.model.number() {
            let (expected, found) = (servo.model.name().to_owned(), Model::describe(number));
            return Err(HilError::WrongModel { servo: servo.label(), expected, found });
        }
    }
    Ok(())
}

/// Has servos that latched an error start anew, and waits for them.
///
/// # Errors
/// Where one does not come back, or latches the error again.
pub(crate) fn clear_errors(bus: &mut Bus, config: &Config) -> Result<()> {
    for servo in &config.servos {
        if bus.hardware_errors(servo.id)?.0 == 0 {
            continue;
        }
        bus.reboot(servo.id)?;
        let back = |bus: &mut Bus| {
            std::thread::sleep(REBOOT_PAUSE);
            bus.ping(servo.id).is_ok()
        };
        if !(0..REBOOT_TRIES).any(|_| back(bus)) {
            return Err(HilError::Silent { servo: servo.label() });
        }
    }
    Ok(())
}

/// Sets every servo up. Torque goes off only where a setting differs that cannot be written under torque; a servo that already
/// holds goes on holding.
///
/// # Errors
/// Where a servo does not answer, refuses, or has latched an error.
pub(crate) fn set_up(bus: &mut Bus, config: &Config) -> Result<()> {
    // Before all else: a servo that also obeys what another one is told would take over that one's sense of rotation.
    for servo in &config.servos {
        write_kept(bus, servo.id, &[(SECONDARY_ID, NO_ID)])?;
    }
    for servo in &config.servos {
        let errors = bus.hardware_errors(servo.id)?;
        if errors.0 != 0 {
            return Err(HilError::Hardware { servo: servo.label(), errors });
        }
        // The other bits of Drive Mode choose profiles by time, and torque by goals: both off.
        let drive_mode = u32::from(servo.reversed) * REVERSED;
        let kept = [(DRIVE_MODE, drive_mode), (OPERATING_MODE, Mode::Position as u32), (RETURN_DELAY_TIME, 0)];
        write_kept(bus, servo.id, &kept)?;
        for (register, value) in [
            (POSITION_P_GAIN, u32::from(config.position_p_gain)),
            // With these the feed-forward would no longer be right.
            (POSITION_I_GAIN, 0),
            (POSITION_D_GAIN, 0),
            (PROFILE_ACCELERATION, 0),
            // The servo's own bound on its speed, whatever goal it is given.
            (PROFILE_VELOCITY, (config.velocity_rad_s / VELOCITY_UNIT_RAD_S).ceil() as u32),
        ] {
            bus.write(servo.id, register, value)?;
        }
        let (address, bytes) = ServoState::indirect_addresses();
        bus.write_bytes(servo.id, address, &bytes)?;
        // A servo without torque is to hold where it stands once it gets some, and not where it stood at some other time.
        if bus.read(servo.id, TORQUE_ENABLE)? == 0 {
            let position = bus.read(servo.id, PRESENT_POSITION)?;
            bus.write(servo.id, GOAL_POSITION, within_a_turn(position as i32) as u32)?;
        }
    }
    Ok(())
}

/// Writes settings that a servo keeps without power, where they differ, with its torque off.
fn write_kept(bus: &mut Bus, id: u8, wanted: &[(Register, u32)]) -> Result<()> {
    for &(register, value) in wanted {
        if bus.read(id, register)? != value {
            bus.set_torque(id, false)?;
            bus.write(id, register, value)?;
        }
    }
    Ok(())
}
