//! A robot: its chain and how hard each joint may be driven.

use std::collections::BTreeMap;

use nalgebra::{DVector, Matrix3, Vector3};
use serde::Deserialize;

use crate::chain::Chain;
use crate::dynamics::{Drive, Dynamics, GRAVITY_M_S2};
use crate::error::{ManipulatorError, Result};
use crate::inertia::Inertia;
use crate::link::Link;
use crate::settings_keys;
use crate::urdf::{self, UrdfLimits};

/// Name, URDF and settings.
const SHIPPED: [(&str, &str, &str); 3] = [
    ("ur5e", include_str!("../../../config/robots/ur5e.urdf"), include_str!("../../../config/robots/ur5e.yaml")),
    ("vx300s", include_str!("../../../config/robots/vx300s.urdf"), include_str!("../../../config/robots/vx300s.yaml")),
    ("panda", include_str!("../../../config/robots/panda.urdf"), include_str!("../../../config/robots/panda.yaml")),
];

/// Limits of every joint, each of shape (dof), in SI units (rad, or m for prismatic joints).
///
/// Velocity, acceleration and jerk limits are positive and hold in both directions. Continuous joints have infinite positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Least position.
    pub lower: DVector<f64>,
    /// Greatest position.
    pub upper: DVector<f64>,
    /// Greatest speed, per s.
    pub velocity: DVector<f64>,
    /// Greatest acceleration, per s².
    pub acceleration: DVector<f64>,
    /// Greatest jerk, per s³.
    pub jerk: DVector<f64>,
    /// Greatest torque in N·m (force in N for prismatic joints), in both directions; infinite where neither URDF nor settings state one.
    pub effort: DVector<f64>,
}

impl Limits {
    /// The first joint whose position is beyond its limits by more than rounding (1e-9).
    pub(crate) fn first_violation(&self, q: &DVector<f64>) -> Option<usize> {
        (0..q.len()).find(|&i| !(q[i] >= self.lower[i] - 1e-9 && q[i] <= self.upper[i] + 1e-9))
    }
}

/// A manipulator with everything that planning needs to know of it.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Name in the URDF.
    pub name: String,
    /// Kinematics from base frame to tool frame.
    pub chain: Chain,
    /// The same kinematics link by link, for whoever draws the arm: the moving ones in the order of the chain's joints.
    pub links: Vec<Link>,
    /// What each joint may do.
    pub limits: Limits,
    /// Torques that motions need; none where no link between the joints and the tool has a mass.
    pub dynamics: Option<Dynamics>,
    /// The configuration to stay close to where the robot's present state is unknown, of shape (dof).
    pub preferred: DVector<f64>,
    /// Name of the base frame, in which tool poses are given.
    pub base_frame: String,
    /// Name of the tool frame.
    pub tool_frame: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    base_frame: String,
    tool_frame: String,
    #[serde(default = "downwards")]
    gravity_m_s2: [f64; 3],
    #[serde(default)]
    payload: Payload,
    joints: BTreeMap<String, JointSettings>,
}

fn downwards() -> [f64; 3] {
    GRAVITY_M_S2
}

/// A point mass at the tool, in the tool frame.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct Payload {
    mass_kg: f64,
    #[serde(default)]
    center_of_mass_m: [f64; 3],
}

/// For prismatic joints the same figures in metres, under the keys with `_m`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointSettings {
    #[serde(alias = "acceleration_m_s2")]
    acceleration_rad_s2: f64,
    #[serde(alias = "jerk_m_s3")]
    jerk_rad_s3: f64,
    #[serde(default, alias = "velocity_m_s")]
    velocity_rad_s: Option<f64>,
    #[serde(default, alias = "effort_n")]
    effort_n_m: Option<f64>,
    #[serde(default, alias = "lower_m")]
    lower_rad: Option<f64>,
    #[serde(default, alias = "upper_m")]
    upper_rad: Option<f64>,
    #[serde(default, alias = "preferred_m")]
    preferred_rad: Option<f64>,
    #[serde(default, alias = "rotor_inertia_kg")]
    rotor_inertia_kg_m2: f64,
}

impl Robot {
    /// A robot whose description is part of this crate, one of [`Robot::shipped_names`].
    ///
    /// ```
    /// let panda = manipulator::Robot::shipped("panda")?;
    /// assert_eq!((panda.chain.dof(), panda.limits.effort[6]), (7, 12.0));
    /// # Ok::<(), manipulator::ManipulatorError>(())
    /// ```
    ///
    /// # Errors
    /// [`ManipulatorError::UnknownRobot`] for any other name.
    pub fn shipped(name: &str) -> Result<Self> {
        let (urdf, settings) = shipped_description(name)?;
        Self::from_urdf(urdf, settings)
    }

    /// The robots whose descriptions are part of this crate: `ur5e`, `vx300s` (ViperX 300 6DOF) and `panda` (Franka Panda, seven joints).
    pub fn shipped_names() -> impl Iterator<Item = &'static str> {
        SHIPPED.iter().map(|(name, ..)| *name)
    }

    /// URDF and YAML settings of a robot whose description is part of this crate, as text.
    ///
    /// # Errors
    /// As [`Robot::shipped`].
    pub fn shipped_description(name: &str) -> Result<(&'static str, &'static str)> {
        shipped_description(name)
    }

    /// A robot whose description is part of this crate, with other settings than the shipped ones.
    ///
    /// # Errors
    /// As [`Robot::shipped`] and [`Robot::from_urdf`].
    pub fn shipped_with(name: &str, settings_yaml: &str) -> Result<Self> {
        Self::from_urdf(shipped_description(name)?.0, settings_yaml)
    }

    /// A robot from a URDF and the YAML settings beside it.
    ///
    /// The settings have `base_frame`, `tool_frame` and, under `joints`, for every moving joint between them
    /// `acceleration_rad_s2`, `jerk_rad_s3` and optionally `lower_rad`, `upper_rad`, `velocity_rad_s`, `effort_n_m`
    /// (which only tighten the URDF's), `preferred_rad` (else the middle of the range) and `rotor_inertia_kg_m2` (as seen at the joint,
    /// else 0). Also optional are `gravity_m_s2` in the base frame and `payload` with `mass_kg` and `center_of_mass_m` in the tool frame.
    ///
    /// Links between two moving joints, and what hangs on them, count as one body; other moving joints stay at zero.
    ///
    /// # Errors
    /// A [`ManipulatorError`] that names the frame, joint or key that is wrong.
    pub fn from_urdf(urdf: &str, settings_yaml: &str) -> Result<Self> {
        let settings: Settings = serde_yaml::from_str(settings_yaml)
            .map_err(|error| ManipulatorError::Settings { reason: urdf::one_line(&error.to_string()) })?;
        let description = urdf::parse(urdf)?;
        let (chain, stated) = urdf::chain(&description, &settings.base_frame, &settings.tool_frame)?;
        if let Some(joint) = settings.joints.keys().find(|name| !chain.joint_names().contains(name)) {
            return Err(ManipulatorError::UnknownJoint { joint: joint.clone() });
        }
        settings_keys::check(settings_yaml, &chain)?;
        let mut joints = Vec::with_capacity(chain.dof());
        for (name, stated) in chain.joint_names().iter().zip(&stated) {
            let own = settings.joints.get(name);
            let own = own.ok_or_else(|| ManipulatorError::MissingSettings { joint: name.clone() })?;
            joints.push(combine(name, stated, own)?);
        }
        let column = |k: usize| DVector::from_iterator(joints.len(), joints.iter().map(|j| j[k]));
        let limits = Limits {
            lower: column(0),
            upper: column(1),
            velocity: column(2),
            acceleration: column(3),
            jerk: column(4),
            effort: column(5),
        };
        let preferred = column(6);
        let links = urdf::links(&description, &settings.base_frame, &settings.tool_frame)?;
        let mut carried = urdf::carried(&description, &settings.base_frame, &settings.tool_frame)?;
        let payload = Vector3::from(settings.payload.center_of_mass_m);
        let payload = Inertia::of_body(settings.payload.mass_kg, payload, Matrix3::zeros())
            .map_err(|error| ManipulatorError::Settings { reason: format!("payload: {error}") })?;
        if let Some(last) = carried.last_mut() {
            *last = *last + payload.in_parent(chain.home());
        }
        let drives: Vec<Drive> = chain
            .joint_names()
            .iter()
            .zip(&stated)
            .map(|(name, stated)| Drive {
                rotor_inertia_kg_m2: settings.joints[name].rotor_inertia_kg_m2,
                damping_n_m_s: stated.damping,
                friction_n_m: stated.friction,
            })
            .collect();
        let dynamics = Dynamics::new(&chain, &carried, &drives, settings.gravity_m_s2)?;
        let dynamics = carried.iter().any(|link| link.mass_kg() > 0.0).then_some(dynamics);
        let Settings { base_frame, tool_frame, .. } = settings;
        Ok(Self { name: description.name, chain, links, limits, dynamics, preferred, base_frame, tool_frame })
    }

    /// Whether `q` has a finite position for every joint, within its limits up to rounding; `what` names it in the error.
    ///
    /// # Errors
    /// [`ManipulatorError::WrongSize`], [`ManipulatorError::NonFinite`], [`ManipulatorError::BeyondLimits`].
    pub fn check_within_limits(&self, what: &'static str, q: &DVector<f64>) -> Result<()> {
        self.check_configuration(what, q)?;
        let Some(joint) = self.limits.first_violation(q) else { return Ok(()) };
        Err(ManipulatorError::BeyondLimits {
            what,
            joint: self.chain.joint_names()[joint].clone(),
            value: q[joint],
            lower: self.limits.lower[joint],
            upper: self.limits.upper[joint],
        })
    }

    pub(crate) fn check_configuration(&self, what: &'static str, q: &DVector<f64>) -> Result<()> {
        self.check_limits()?;
        if q.len() != self.chain.dof() {
            return Err(ManipulatorError::WrongSize { what, expected: self.chain.dof(), given: q.len() });
        }
        if !q.iter().all(|x| x.is_finite()) {
            return Err(ManipulatorError::NonFinite { what });
        }
        Ok(())
    }

    /// Whoever set a limit by hand may have set it to anything; comparing with what is no number would pass every test.
    pub(crate) fn check_limits(&self) -> Result<()> {
        let Limits { lower, upper, velocity, acceleration, jerk, effort } = &self.limits;
        let expected = self.chain.dof();
        let wrong = [lower, upper, velocity, acceleration, jerk, effort].into_iter().find(|v| v.len() != expected);
        if let Some(given) = wrong.map(DVector::len) {
            return Err(ManipulatorError::WrongSize { what: "a limit", expected, given });
        }
        for (i, joint) in self.chain.joint_names().iter().enumerate() {
            let range = upper[i] - lower[i];
            let figures = [
                ("its range (upper - lower limit)", range, range > 0.0),
                ("its velocity limit", velocity[i], velocity[i] > 0.0 && velocity[i].is_finite()),
                ("its acceleration limit", acceleration[i], acceleration[i] > 0.0 && acceleration[i].is_finite()),
                ("its jerk limit", jerk[i], jerk[i] > 0.0 && jerk[i].is_finite()),
                ("its effort limit", effort[i], effort[i] > 0.0),
            ];
            if let Some(&(what, value, _)) = figures.iter().find(|(.., right)| !right) {
                return Err(ManipulatorError::InvalidJoint { joint: joint.clone(), what, value, must_be: "positive" });
            }
        }
        Ok(())
    }
}

/// URDF and settings.
fn shipped_description(name: &str) -> Result<(&'static str, &'static str)> {
    let found = SHIPPED.iter().find(|(known, ..)| *known == name);
    let unknown = || ManipulatorError::UnknownRobot {
        name: name.into(),
        known: Robot::shipped_names().collect::<Vec<_>>().join(", "),
    };
    found.map(|(_, urdf, settings)| (*urdf, *settings)).ok_or_else(unknown)
}

/// Lower, upper, velocity, acceleration, jerk, effort, preferred.
fn combine(name: &str, stated: &UrdfLimits, own: &JointSettings) -> Result<[f64; 7]> {
    let invalid = |what, value, must_be| ManipulatorError::InvalidJoint { joint: name.into(), what, value, must_be };
    let figures = [own.velocity_rad_s, own.lower_rad, own.upper_rad, own.preferred_rad];
    if let Some(value) = figures.into_iter().flatten().find(|v| !v.is_finite()) {
        return Err(invalid("a figure of its settings", value, "finite"));
    }
    let positive = [
        ("its acceleration limit", own.acceleration_rad_s2),
        ("its jerk limit", own.jerk_rad_s3),
        ("its velocity limit", own.velocity_rad_s.unwrap_or(stated.velocity)),
        ("its effort limit", own.effort_n_m.unwrap_or(1.0)),
    ];
    for (what, value) in positive {
        if !(value.is_finite() && value > 0.0) {
            return Err(invalid(what, value, "positive"));
        }
    }
    let lower = stated.lower.max(own.lower_rad.unwrap_or(f64::NEG_INFINITY));
    let upper = stated.upper.min(own.upper_rad.unwrap_or(f64::INFINITY));
    if lower >= upper {
        return Err(invalid("its range (upper - lower limit)", upper - lower, "positive"));
    }
    let middle = if (lower + upper).is_finite() { 0.5 * (lower + upper) } else { 0.0 };
    let preferred = own.preferred_rad.unwrap_or(middle);
    if !(lower..=upper).contains(&preferred) {
        return Err(invalid("its preferred position", preferred, "within its limits"));
    }
    let velocity = stated.velocity.min(own.velocity_rad_s.unwrap_or(f64::INFINITY));
    let effort = stated.effort.min(own.effort_n_m.unwrap_or(f64::INFINITY));
    Ok([lower, upper, velocity, own.acceleration_rad_s2, own.jerk_rad_s3, effort, preferred])
}
