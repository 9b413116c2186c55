//! The position servos of a model, as its actuators describe them.

use mujoco_rs::prelude::*;

use crate::error::{Result, SimError};

/// One position servo: torque = kp·(control − q) − kd·q̇, clamped to its range.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Servo {
    pub(crate) joint: String,
    pub(crate) joint_index: usize,
    /// Where the joint's position, velocity, control and actuator force stand in MuJoCo's vectors.
    pub(crate) position: usize,
    pub(crate) velocity: usize,
    pub(crate) control: usize,
    pub(crate) force: usize,
    /// Stiffness, in N·m/rad (N/m for slides).
    pub(crate) kp: f64,
    /// Damping, in N·m·s/rad.
    pub(crate) kd: f64,
    pub(crate) control_range: (f64, f64),
    /// Greatest force in either direction; infinite where the model states none.
    pub(crate) greatest_force: f64,
}

impl Servo {
    /// The control that makes the servo give `torque` while the joint is at `position` with `velocity`.
    pub(crate) fn control_for(&self, position: f64, velocity: f64, torque: f64) -> f64 {
        position + (self.kd * velocity + torque) / self.kp
    }

    /// The control within the range that the model allows, and whether it was within already.
    pub(crate) fn clamp(&self, control: f64) -> (f64, bool) {
        let (low, high) = self.control_range;
        let clamped = control.clamp(low, high);
        (clamped, clamped == control)
    }
}

/// The servos of a model in the order of its actuators.
pub(crate) fn servos(model: &MjModel, file: &str) -> Result<Vec<Servo>> {
    let count = model.actuator_trntype().len();
    let mut servos: Vec<Servo> = Vec::with_capacity(count);
    for actuator in 0..count {
        let servo = servo(model, actuator).and_then(|servo| {
            let taken = servos.iter().any(|other| other.joint == servo.joint);
            if taken { Err("acts on a joint that another one moves") } else { Ok(servo) }
        });
        servos.push(servo.map_err(|why| {
            let name = model.id_to_name(MjtObjBase::mjOBJ_ACTUATOR, actuator).filter(|name| !name.is_empty());
            SimError::NotAServo {
                file: file.into(),
                actuator: name.map_or_else(|| actuator.to_string(), Into::into),
                why,
            }
        })?);
    }
    if servos.is_empty() { Err(SimError::NoActuators { file: file.into() }) } else { Ok(servos) }
}

fn servo(model: &MjModel, actuator: usize) -> std::result::Result<Servo, &'static str> {
    if model.actuator_trntype()[actuator] != MjtTrn::mjTRN_JOINT {
        return Err("does not act on a joint");
    }
    let joint = model.actuator_trnid()[actuator][0] as usize;
    if !matches!(model.jnt_type()[joint], MjtJoint::mjJNT_HINGE | MjtJoint::mjJNT_SLIDE) {
        return Err("acts on a joint that is neither hinge nor slide");
    }
    let name = model.id_to_name(MjtObjBase::mjOBJ_JOINT, joint).filter(|name| !name.is_empty());
    let name = name.ok_or("acts on a joint without a name")?;
    if model.actuator_dyntype()[actuator] != MjtDyn::mjDYN_NONE {
        return Err("has a state of its own");
    }
    let (gain, bias) = (model.actuator_gainprm()[actuator], model.actuator_biasprm()[actuator]);
    let kp = gain[0];
    // MuJoCo: force = gain·control + bias₀ + bias₁·length + bias₂·velocity.
    let is_position_servo = model.actuator_gaintype()[actuator] == MjtGain::mjGAIN_FIXED
        && model.actuator_biastype()[actuator] == MjtBias::mjBIAS_AFFINE
        && kp > 0.0
        && bias[0] == 0.0
        && bias[1] == -kp
        && bias[2] <= 0.0;
    if !is_position_servo {
        return Err("is not a position servo (gain kp, bias 0 -kp -kd)");
    }
    let force = model.actuator_outadr()[actuator] as usize;
    if model.actuator_gear()[force][0] != 1.0 {
        return Err("acts through a gear");
    }
    let control = model.actuator_ctrladr()[actuator] as usize;
    let control_range = match model.actuator_ctrllimited()[control] {
        true => model.actuator_ctrlrange()[control].into(),
        false => (f64::NEG_INFINITY, f64::INFINITY),
    };
    let greatest_force = match model.actuator_forcelimited()[actuator] {
        true => model.actuator_forcerange()[actuator].iter().fold(0.0, |most, bound| f64::max(most, bound.abs())),
        false => f64::INFINITY,
    };
    Ok(Servo {
        joint: name.to_owned(),
        joint_index: joint,
        position: model.jnt_qposadr()[joint] as usize,
        velocity: model.jnt_dofadr()[joint] as usize,
        control,
        force,
        kp,
        kd: -bias[2],
        control_range,
        greatest_force,
    })
}
