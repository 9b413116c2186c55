//! The servos that the driver knows.

use dynamixel_emulator::{self as emulator, Datasheet};
use serde::Deserialize;

/// A servo that the driver knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Model {
    /// XM540-W270-R/T.
    #[serde(rename = "XM540-W270")]
    Xm540W270,
    /// XM430-W350-R/T.
    #[serde(rename = "XM430-W350")]
    Xm430W350,
    /// XL430-W250-T.
    #[serde(rename = "XL430-W250")]
    Xl430W250,
}

impl Model {
    const ALL: [Self; 3] = [Self::Xm540W270, Self::Xm430W350, Self::Xl430W250];

    /// As ROBOTIS calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xm540W270 => "XM540-W270",
            Self::Xm430W350 => "XM430-W350",
            Self::Xl430W250 => "XL430-W250",
        }
    }

    /// What it answers to a ping.
    pub fn number(self) -> u16 {
        match self {
            Self::Xm540W270 => 1120,
            Self::Xm430W350 => 1020,
            Self::Xl430W250 => 1060,
        }
    }

    /// The name to a model number, as far as it is known.
    pub(crate) fn describe(number: u16) -> String {
        let known = Self::ALL.into_iter().find(|model| model.number() == number);
        known.map_or_else(|| format!("servo of model number {number}"), |model| model.name().to_owned())
    }

    /// What its data sheet says of its motor.
    pub fn datasheet(self) -> Datasheet {
        emulator::Model::from(self).datasheet()
    }
}

impl From<Model> for emulator::Model {
    fn from(model: Model) -> Self {
        match model {
            Model::Xm540W270 => Self::Xm540W270,
            Model::Xm430W350 => Self::Xm430W350,
            Model::Xl430W250 => Self::Xl430W250,
        }
    }
}
