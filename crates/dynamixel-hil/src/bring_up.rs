//! From a bus that is open to servos that are what the configuration says, set up and ready to hold where they stand.

use std::time::Duration;

use crate::bus::Bus;
use crate::config::{Config, Servo};
use crate::error::{HilError, Result};
use crate::model::Model;
use crate::register::{
    DRIVE_MODE, GOAL_POSITION, MAX_POSITION_LIMIT, MIN_POSITION_LIMIT, Mode, OPERATING_MODE, POSITION_D_GAIN,
    POSITION_I_GAIN, POSITION_P_GAIN, PRESENT_POSITION, PROFILE_ACCELERATION, PROFILE_VELOCITY, RETURN_DELAY_TIME,
    Register, SECONDARY_ID, TORQUE_ENABLE, VELOCITY_UNIT_RAD_S, angle_rad, within_a_turn,
};
use crate::servo_state::ServoState;

/// Bit 0 of Drive Mode: clockwise is positive.
const REVERSED: u32 = 0x01;
/// So far outside of its limits, in pulses, a servo is put to its limit: 0.03 rad, as an arm sags on its rest.
const OUTSIDE: i32 = 20;
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

/// Where a servo stands, in rad of its joint, as the arm will see it: mirrored, if the servo does not yet count as the configuration has
/// it. `None` of a servo without a joint.
///
/// # Errors
/// As [`Bus::read`].
pub fn joint_position(bus: &mut Bus, servo: &Servo) -> Result<Option<f64>> {
    if servo.joint.is_none() {
        return Ok(None);
    }
    let is_reversed = bus.read(servo.id, DRIVE_MODE)? & REVERSED != 0;
    let angle = angle_rad(within_a_turn(bus.read(servo.id, PRESENT_POSITION)? as i32));
    Ok(Some(if is_reversed == servo.reversed { angle } else { -angle } + servo.offset_rad))
}

/// Has servos that latched an error start anew, and waits for them. One that holds in spite of it (low voltage) would drop the arm.
///
/// # Errors
/// Where one still holds, does not come back, or latches the error again.
pub(crate) fn clear_errors(bus: &mut Bus, config: &Config) -> Result<()> {
    for servo in &config.servos {
        let errors = bus.hardware_errors(servo.id)?;
        if errors.0 == 0 {
            continue;
        }
        if bus.read(servo.id, TORQUE_ENABLE)? != 0 {
            let why = format!("only starting anew clears that {errors}");
            return Err(HilError::WouldDrop { servo: servo.label(), why });
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

/// Sets every servo up; one that already holds goes on holding. Returns the raw positions that each takes as goals, least and most.
///
/// # Errors
/// Where a servo does not answer, refuses, or has latched an error; where one that holds would have to let go for a setting that
/// cannot be written under torque; where one stands outside of its own limits.
pub(crate) fn set_up(bus: &mut Bus, config: &Config) -> Result<Vec<[i32; 2]>> {
    // The other bits of Drive Mode choose profiles by time, and torque by goals: both off.
    let kept = |reversed: bool| {
        let drive_mode = u32::from(reversed) * REVERSED;
        [
            (DRIVE_MODE, drive_mode),
            (OPERATING_MODE, Mode::Position as u32),
            (RETURN_DELAY_TIME, 0),
            (SECONDARY_ID, NO_ID),
        ]
    };
    // Nothing is written before it is known that no servo has to let go for it.
    for servo in &config.servos {
        if bus.read(servo.id, TORQUE_ENABLE)? != 0 {
            for (register, value) in kept(servo.reversed) {
                let is = bus.read(servo.id, register)?;
                if is != value {
                    let why = format!("its {} of {is} has to be {value}, which torque forbids to write", register.name);
                    return Err(HilError::WouldDrop { servo: servo.label(), why });
                }
            }
        }
    }
    // Before all else: a servo that also obeys what another one is told would take over that one's sense of rotation.
    for servo in &config.servos {
        write_kept(bus, servo.id, &[(SECONDARY_ID, NO_ID)])?;
    }
    let mut ranges = Vec::with_capacity(config.servos.len());
    for servo in &config.servos {
        let errors = bus.hardware_errors(servo.id)?;
        if errors.0 != 0 {
            return Err(HilError::Hardware { servo: servo.label(), errors });
        }
        write_kept(bus, servo.id, &kept(servo.reversed))?;
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
        let [least, most] = [MIN_POSITION_LIMIT, MAX_POSITION_LIMIT].map(|limit| bus.read(servo.id, limit));
        let [least, most] = [least? as i32, most? as i32];
        ranges.push([least, most]);
        // A servo without torque is to hold where it stands once it gets some, and not where it stood at some other time.
        if bus.read(servo.id, TORQUE_ENABLE)? == 0 {
            let position = within_a_turn(bus.read(servo.id, PRESENT_POSITION)? as i32);
            let goal = position.clamp(least, most);
            if (goal - position).abs() > OUTSIDE {
                return Err(HilError::Outside { servo: servo.label(), position, least, most });
            }
            bus.write(servo.id, GOAL_POSITION, goal as u32)?;
        }
    }
    Ok(ranges)
}

/// Writes settings that a servo keeps without power, where they differ.
fn write_kept(bus: &mut Bus, id: u8, wanted: &[(Register, u32)]) -> Result<()> {
    for &(register, value) in wanted {
        if bus.read(id, register)? != value {
            bus.write(id, register, value)?;
        }
    }
    Ok(())
}
