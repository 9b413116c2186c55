//! The motor behind its gear: current, torque, heat.

use crate::model::{DATASHEET_VOLTAGE_V, Datasheet, Model};

/// Room temperature in °C.
pub(crate) const AMBIENT_C: f64 = 25.0;
/// Specific heat of a servo, mostly aluminium and steel, in J/(kg K). Assumed.
const SPECIFIC_HEAT_J_KG_K: f64 = 800.0;
/// From the case to the air, in K/W for a servo of one kg; it grows as mass^(−2/3), which is as the surface shrinks. Assumed.
const THERMAL_RESISTANCE_K_W: f64 = 2.0;

/// A DC motor of the datasheet's stall torque, stall current and no-load speed, all seen at the output shaft:
/// `u = R i + k_e ω`, `τ = k_t i`. The gear's losses make `k_t` less than `k_e`. The inductance is left out: its time constant is far
/// below the control period.
#[derive(Debug, Clone)]
pub(crate) struct Motor {
    datasheet: Datasheet,
    pub(crate) current_a: f64,
    pub(crate) temperature_c: f64,
}

impl Motor {
    pub(crate) fn new(model: Model) -> Self {
        Self { datasheet: model.datasheet(), current_a: 0.0, temperature_c: AMBIENT_C }
    }

    fn resistance_ohm(&self) -> f64 {
        DATASHEET_VOLTAGE_V / self.datasheet.stall_current_a
    }

    fn back_emf_v(&self, velocity_rad_s: f64) -> f64 {
        DATASHEET_VOLTAGE_V / self.datasheet.no_load_speed_rad_s * velocity_rad_s
    }

    /// The voltage that makes a current flow.
    pub(crate) fn voltage_for(&self, current_a: f64, velocity_rad_s: f64) -> f64 {
        current_a * self.resistance_ohm() + self.back_emf_v(velocity_rad_s)
    }

    /// Applies a voltage for a while; nothing when the bridge is open.
    pub(crate) fn drive(&mut self, voltage_v: Option<f64>, velocity_rad_s: f64, dt_s: f64) {
        self.current_a =
            voltage_v.map_or(0.0, |voltage| (voltage - self.back_emf_v(velocity_rad_s)) / self.resistance_ohm());
        let mass = self.datasheet.mass_kg;
        let lost_w = self.current_a.powi(2) * self.resistance_ohm();
        let to_air_w = (self.temperature_c - AMBIENT_C) / (THERMAL_RESISTANCE_K_W * mass.powf(-2.0 / 3.0));
        self.temperature_c += (lost_w - to_air_w) / (SPECIFIC_HEAT_J_KG_K * mass) * dt_s;
    }

    pub(crate) fn torque_n_m(&self) -> f64 {
        self.datasheet.stall_torque_n_m / self.datasheet.stall_current_a * self.current_a
    }

    /// The current as part of the stall current at 12 V.
    pub(crate) fn load(&self) -> f64 {
        self.current_a / self.datasheet.stall_current_a
    }
}

/// The overload rule. The e-manual says "persistent load that exceeds maximum output" and no figure, so this is assumed: an I²t
/// integral `∫ (load² − continuous²) dt` that never falls below 0 and trips at a limit. Half of the stall torque is borne for ever, all
/// of it for two seconds.
#[derive(Debug, Clone, Default)]
pub(crate) struct Overload(f64);

impl Overload {
    const CONTINUOUS: f64 = 0.5;
    const LIMIT_S: f64 = 1.5;

    /// Counts a load in, and says whether it has been too much.
    pub(crate) fn trips(&mut self, load: f64, dt_s: f64) -> bool {
        self.0 = (self.0 + (load * load - Self::CONTINUOUS * Self::CONTINUOUS) * dt_s).clamp(0.0, Self::LIMIT_S);
        self.0 >= Self::LIMIT_S
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_datasheet_comes_out_again() {
        for model in [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250] {
            let (mut motor, datasheet) = (Motor::new(model), model.datasheet());
            motor.drive(Some(12.0), 0.0, 1e-3);
            assert!((motor.torque_n_m() - datasheet.stall_torque_n_m).abs() < 1e-9);
            motor.drive(Some(12.0), datasheet.no_load_speed_rad_s, 1e-3);
            assert!(motor.torque_n_m().abs() < 1e-9);
            motor.drive(None, datasheet.no_load_speed_rad_s, 1e-3);
            assert_eq!(motor.torque_n_m(), 0.0, "an open bridge does not brake");
        }
        // The other voltages of the XM540's datasheet, which the model was not made from: within 4 %.
        let mut motor = Motor::new(Model::Xm540W270);
        for (voltage, torque) in [(11.1, 10.0), (14.8, 12.9)] {
            motor.drive(Some(voltage), 0.0, 1e-3);
            assert!((motor.torque_n_m() / torque - 1.0).abs() < 0.04, "{} at {voltage} V", motor.torque_n_m());
        }
    }

    #[test]
    fn a_stalled_motor_overheats_and_a_lightly_loaded_one_does_not() {
        let mut motor = Motor::new(Model::Xm540W270);
        let warm_after = |motor: &mut Motor, voltage, seconds: u32| {
            (0..seconds).for_each(|_| motor.drive(Some(voltage), 0.0, 1.0));
            motor.temperature_c
        };
        let light = warm_after(&mut motor, 2.4, 7200);
        assert!((30.0..60.0).contains(&light), "{light} °C at a fifth of the stall torque");
        let stalled = warm_after(&mut motor, 12.0, 200);
        assert!(stalled > 80.0, "{stalled} °C");
    }

    #[test]
    fn overload_trips_after_two_seconds_of_stall_and_never_at_half_the_torque() {
        let mut overload = Overload::default();
        assert!(!(0..100_000).any(|_| overload.trips(0.5, 1e-3)));
        let tripped = (1..).find(|_| overload.trips(-1.0, 1e-3)).unwrap();
        assert!((1990..=2010).contains(&tripped), "{tripped} ms");
    }
}
