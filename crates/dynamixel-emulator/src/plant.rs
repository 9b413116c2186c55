//! What the shafts of the servos are connected to.

use crate::model::Model;

/// Motion of an output shaft.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shaft {
    /// Angle in rad, counter-clockwise; 0 is the encoder's centre, raw position 2048.
    pub position_rad: f64,
    /// Its rate in rad/s.
    pub velocity_rad_s: f64,
}

/// The mechanism behind the servos, which are counted in the order given to [`crate::Bus::new`].
pub trait Plant: Send {
    /// Moves on by `dt_s` under the torques of the motors at the output shafts, in N m, positive counter-clockwise.
    fn step(&mut self, torques: &[f64], dt_s: f64);
    /// The motion of one shaft.
    fn shaft(&self, servo: usize) -> Shaft;
}

/// Shafts that nothing is mounted on: rotor inertia and the gear's friction.
#[derive(Debug, Clone)]
pub struct FreeShafts(Vec<FreeShaft>);

#[derive(Debug, Clone)]
struct FreeShaft {
    shaft: Shaft,
    inertia_kg_m2: f64,
    friction_n_m: f64,
}

/// Friction of the gear as part of the stall torque. Assumed.
const FRICTION: f64 = 0.01;

impl FreeShafts {
    /// A shaft at its centre for every servo.
    #[must_use]
    pub fn new(models: &[Model]) -> Self {
        let free = |model: &Model| {
            let motor = model.datasheet();
            FreeShaft {
                shaft: Shaft::default(),
                inertia_kg_m2: motor.reflected_inertia_kg_m2,
                friction_n_m: FRICTION * motor.stall_torque_n_m,
            }
        };
        Self(models.iter().map(free).collect())
    }

    /// Turns a shaft by hand. A servo that there is not is left alone.
    #[must_use]
    pub fn turned(mut self, servo: usize, position_rad: f64) -> Self {
        if let Some(free) = self.0.get_mut(servo) {
            free.shaft.position_rad = position_rad;
        }
        self
    }
}

impl Plant for FreeShafts {
    /// Semi-implicit Euler; Coulomb friction takes velocity away but never turns it around.
    fn step(&mut self, torques: &[f64], dt_s: f64) {
        for (free, torque) in self.0.iter_mut().zip(torques) {
            let velocity = free.shaft.velocity_rad_s + torque / free.inertia_kg_m2 * dt_s;
            let lost = free.friction_n_m / free.inertia_kg_m2 * dt_s;
            free.shaft.velocity_rad_s = velocity.signum() * (velocity.abs() - lost).max(0.0);
            free.shaft.position_rad += free.shaft.velocity_rad_s * dt_s;
        }
    }

    fn shaft(&self, servo: usize) -> Shaft {
        self.0.get(servo).map(|free| free.shaft).unwrap_or_default()
    }
}
