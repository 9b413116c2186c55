//! What the emulated servos are connected to: the arm's model in MuJoCo, moved by the torques of their motors and nothing else.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use dynamixel_emulator::{Plant, Shaft};
use mujoco_rs::prelude::*;
use mujoco_sim::{SimError, model_file};
use planner::manipulator::Robot;

use crate::config::Config;
use crate::error::{HilError, Result};

/// Time step in s. The stiffest joint has 100 N·m/rad on 0.02 kg·m² of rotor: a period of 90 ms.
const TIME_STEP_S: f64 = 0.001;
/// Friction of a servo's gear as part of its stall torque, independent of speed. Assumed; data sheets do not have it.
const FRICTION: f64 = 0.02;
/// The fingers and their crank, in kg·m² at the gripper's servo. Assumed.
const GRIPPER_INERTIA_KG_M2: f64 = 1e-3;

/// The arm in MuJoCo as the plant of a bus.
///
/// Until a motor gives its first torque the arm stands as if somebody held it. Two servos on one joint are one shaft.
pub struct ArmPlant {
    data: MjData<Arc<MjModel>>,
    joints: Vec<Joint>,
    shafts: Vec<Seat>,
    is_held: bool,
    owed_s: f64,
    view: PlantView,
}

/// A joint's places in MuJoCo's vectors.
struct Joint {
    position: usize,
    velocity: usize,
}

/// What a servo's shaft is part of.
enum Seat {
    /// A joint: its place, the sense of rotation, and where it is when the shaft is at its centre.
    Joint { joint: usize, sign: f64, offset_rad: f64 },
    /// A gripper that nothing is in the way of.
    Free { shaft: Shaft, inertia_kg_m2: f64, friction_n_m: f64 },
}

/// The simulated truth, for whoever compares.
#[derive(Debug, Clone, Default)]
pub struct PlantView(Arc<Mutex<JointTruth>>);

/// The joints as they are in MuJoCo, in the robot's joint order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointTruth {
    /// Simulated time, in s.
    pub time_s: f64,
    /// In rad.
    pub position: Vec<f64>,
    /// In rad/s.
    pub velocity: Vec<f64>,
}

impl PlantView {
    /// The joints now.
    pub fn now(&self) -> JointTruth {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, JointTruth> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ArmPlant {
    /// The arm of a configuration, standing at `start` (rad, in the robot's joint order).
    ///
    /// # Errors
    /// Where MuJoCo has no model of the robot, or one with other joints.
    pub fn new(config: &Config, robot: &Robot, start: &[f64]) -> Result<Self> {
        let file = model_file(&config.robot)?;
        let refused = |reason: String| SimError::Model { file: file.display().to_string(), reason };
        let mut model = MjModel::from_xml(&file).map_err(|error| refused(error.to_string()))?;
        model.opt_mut().timestep = TIME_STEP_S;
        // Its own position servos stay away: torques come from the bus.
        model.opt_mut().disableflags |= MjtDisableBit::mjDSBL_ACTUATION as i32;
        let names = robot.chain.joint_names();
        let mut joints = Vec::with_capacity(names.len());
        for name in names {
            let index = (0..model.jnt_type().len())
                .find(|&joint| model.id_to_name(MjtObjBase::mjOBJ_JOINT, joint) == Some(name.as_str()))
                .ok_or_else(|| refused(format!("it has no joint {name}")))?;
            joints.push(Joint {
                position: model.jnt_qposadr()[index] as usize,
                velocity: model.jnt_dofadr()[index] as usize,
            });
        }
        let mut shafts = Vec::with_capacity(config.servos.len());
        for servo in &config.servos {
            let motor = servo.model.datasheet();
            let (inertia_kg_m2, friction_n_m) = (motor.reflected_inertia_kg_m2, FRICTION * motor.stall_torque_n_m);
            let joint = servo.joint.as_ref().and_then(|joint| names.iter().position(|name| name == joint));
            shafts.push(match joint {
                Some(joint) => {
                    let velocity = joints[joint].velocity;
                    model.dof_armature_mut()[velocity] += inertia_kg_m2;
                    model.dof_frictionloss_mut()[velocity] += friction_n_m;
                    Seat::Joint { joint, sign: if servo.reversed { -1.0 } else { 1.0 }, offset_rad: servo.offset_rad }
                }
                None => {
                    let inertia_kg_m2 = inertia_kg_m2 + GRIPPER_INERTIA_KG_M2;
                    Seat::Free { shaft: Shaft::default(), inertia_kg_m2, friction_n_m }
                }
            });
        }
        let mut data = MjData::try_new(Arc::new(model)).map_err(|error| refused(error.to_string()))?;
        if start.len() != joints.len() {
            let what = format!("the start has {} values for {} joints", start.len(), joints.len());
            return Err(HilError::Emulator(what));
        }
        for (joint, &q) in joints.iter().zip(start) {
            data.qpos_mut()[joint.position] = q;
        }
        data.forward();
        let plant = Self { data, joints, shafts, is_held: true, owed_s: 0.0, view: PlantView::default() };
        plant.show();
        Ok(plant)
    }

    /// The simulated truth.
    pub fn view(&self) -> PlantView {
        self.view.clone()
    }

    fn show(&self) {
        let mut truth = self.view.lock();
        let (qpos, qvel) = (self.data.qpos(), self.data.qvel());
        truth.time_s = self.data.time();
        truth.position = self.joints.iter().map(|joint| qpos[joint.position]).collect();
        truth.velocity = self.joints.iter().map(|joint| qvel[joint.velocity]).collect();
    }
}

impl Plant for ArmPlant {
    fn step(&mut self, torques: &[f64], dt_s: f64) {
        self.is_held &= torques.iter().all(|&torque| torque == 0.0);
        if self.is_held {
            return;
        }
        self.data.qfrc_applied_mut().fill(0.0);
        for (seat, &torque) in self.shafts.iter_mut().zip(torques) {
            match seat {
                Seat::Joint { joint, sign, .. } => {
                    self.data.qfrc_applied_mut()[self.joints[*joint].velocity] += *sign * torque;
                }
                Seat::Free { shaft, inertia_kg_m2, friction_n_m } => {
                    let velocity = shaft.velocity_rad_s + torque / *inertia_kg_m2 * dt_s;
                    // Friction takes speed away, and never turns it round.
                    let lost = *friction_n_m / *inertia_kg_m2 * dt_s;
                    shaft.velocity_rad_s = velocity.signum() * (velocity.abs() - lost).max(0.0);
                    shaft.position_rad += shaft.velocity_rad_s * dt_s;
                }
            }
        }
        self.owed_s += dt_s;
        // Half a step is nearer than none.
        while self.owed_s >= 0.5 * TIME_STEP_S {
            self.data.step();
            self.owed_s -= TIME_STEP_S;
        }
        self.show();
    }

    fn shaft(&self, servo: usize) -> Shaft {
        match self.shafts.get(servo) {
            None => Shaft::default(),
            Some(Seat::Free { shaft, .. }) => *shaft,
            Some(Seat::Joint { joint, sign, offset_rad }) => {
                let Joint { position, velocity } = self.joints[*joint];
                Shaft {
                    position_rad: sign * (self.data.qpos()[position] - offset_rad),
                    velocity_rad_s: sign * self.data.qvel()[velocity],
                }
            }
        }
    }
}
