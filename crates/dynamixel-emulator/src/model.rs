/// A model of servo: its control table, and its motor as the datasheet has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Model {
    /// The large servo of the ViperX 300: waist, shoulder, elbow, forearm and wrist.
    Xm540W270,
    /// The small servo of the ViperX 300: wrist rotation and gripper.
    Xm430W350,
    /// A servo without a current sensor.
    Xl430W250,
}

/// What ROBOTIS's datasheet says of the motor at 12 V, and what is assumed where it says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datasheet {
    /// Torque of the output shaft at standstill in N m.
    pub stall_torque_n_m: f64,
    /// Current at standstill in A.
    pub stall_current_a: f64,
    /// Speed of the output shaft without a load in rad/s.
    pub no_load_speed_rad_s: f64,
    /// Mass in kg; it is what the losses heat up.
    pub mass_kg: f64,
    /// Inertia of the rotor as the output shaft sees it, in kg m². Assumed: a rotor of 1.5 g cm² (540) or 0.3 g cm² (430) behind the gear.
    pub reflected_inertia_kg_m2: f64,
}

/// The voltage at which the datasheets are read.
pub(crate) const DATASHEET_VOLTAGE_V: f64 = 12.0;

const REV_MIN: f64 = std::f64::consts::TAU / 60.0;

impl Model {
    /// The model's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Xm540W270 => "XM540-W270",
            Self::Xm430W350 => "XM430-W350",
            Self::Xl430W250 => "XL430-W250",
        }
    }

    /// The motor.
    #[must_use]
    pub fn datasheet(self) -> Datasheet {
        let (stall_torque_n_m, stall_current_a, rev_min, mass_kg, gear_ratio, rotor_kg_m2) = match self {
            Self::Xm540W270 => (10.6, 4.4, 30.0, 0.165, 272.5, 1.5e-7),
            Self::Xm430W350 => (4.1, 2.3, 46.0, 0.082, 353.5, 0.3e-7),
            Self::Xl430W250 => (1.5, 1.4, 61.0, 0.057, 258.5, 0.3e-7),
        };
        Datasheet {
            stall_torque_n_m,
            stall_current_a,
            no_load_speed_rad_s: rev_min * REV_MIN,
            mass_kg,
            reflected_inertia_kg_m2: rotor_kg_m2 * gear_ratio * gear_ratio,
        }
    }

    pub(crate) fn table(self) -> &'static str {
        match self {
            Self::Xm540W270 => include_str!("../tables/xm540_w270.csv"),
            Self::Xm430W350 => include_str!("../tables/xm430_w350.csv"),
            Self::Xl430W250 => include_str!("../tables/xl430_w250.csv"),
        }
    }
}
