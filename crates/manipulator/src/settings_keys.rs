//! Names and units in robot settings that a map of structs would let pass.

use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};

use crate::chain::Chain;
use crate::error::{ManipulatorError, Result};
use crate::urdf::one_line;

/// Each key of a turning joint, and what it is called for a sliding one.
const UNITS: [[&str; 2]; 7] = [
    ["acceleration_rad_s2", "acceleration_m_s2"],
    ["jerk_rad_s3", "jerk_m_s3"],
    ["velocity_rad_s", "velocity_m_s"],
    ["effort_n_m", "effort_n"],
    ["lower_rad", "lower_m"],
    ["upper_rad", "upper_m"],
    ["preferred_rad", "preferred_m"],
];

#[derive(serde::Deserialize)]
struct Keys {
    joints: Pairs<Pairs<IgnoredAny>>,
}

/// A map as it is written, with what is in it twice.
struct Pairs<V>(Vec<(String, V)>);

impl<'de, V: Deserialize<'de>> Deserialize<'de> for Pairs<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Collect<V>(PhantomData<V>);
        impl<'de, V: Deserialize<'de>> Visitor<'de> for Collect<V> {
            type Value = Pairs<V>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a map")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Pairs<V>, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Pairs(pairs))
            }
        }
        deserializer.deserialize_map(Collect(PhantomData))
    }
}

/// Whether every joint is there once, its figures in the units of its kind.
pub(crate) fn check(settings_yaml: &str, chain: &Chain) -> Result<()> {
    let wrong = |reason| Err(ManipulatorError::Settings { reason });
    let keys: Keys = serde_yaml::from_str(settings_yaml)
        .map_err(|error| ManipulatorError::Settings { reason: one_line(&error.to_string()) })?;
    let Pairs(joints) = keys.joints;
    for (index, (name, Pairs(figures))) in joints.iter().enumerate() {
        if joints[..index].iter().any(|(other, _)| other == name) {
            return wrong(format!("joint {name:?} is there twice"));
        }
        let Some(joint) = chain.joint_names().iter().position(|other| other == name) else { continue };
        let (own, kind) = if chain.is_rotary(joint) { (0, "turns") } else { (1, "slides") };
        for [key, fitting] in UNITS.map(|pair| [pair[1 - own], pair[own]]) {
            if figures.iter().any(|(given, _)| given == key) {
                return wrong(format!("joint {name:?} {kind}: its {key} must be {fitting}"));
            }
        }
    }
    Ok(())
}
