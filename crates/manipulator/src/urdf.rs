//! From a URDF to a chain and the limits that the URDF states.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Translation3, UnitQuaternion, Vector3};
use se3_geom::{Pose, Twist};
use urdf_rs::{Joint, JointType};

use crate::chain::Chain;
use crate::error::{ManipulatorError, Result};
use crate::inertia::Inertia;
use crate::link::Link;

/// Limits of one joint as the URDF has them.
pub(crate) struct UrdfLimits {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) velocity: f64,
    /// Infinite where none is stated.
    pub(crate) effort: f64,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
}

pub(crate) fn parse(urdf: &str) -> Result<urdf_rs::Robot> {
    let refused = |reason| ManipulatorError::Urdf { reason };
    let robot = urdf_rs::read_from_string(urdf).map_err(|error| refused(one_line(&error.to_string())))?;
    let links: Vec<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
    let joints: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    for (what, names) in [("links", links), ("joints", joints)] {
        if let Some(name) = first_twice(names) {
            return Err(refused(format!("two {what} are named {name:?}")));
        }
    }
    Ok(robot)
}

fn first_twice(names: Vec<&str>) -> Option<&str> {
    let mut known = BTreeSet::new();
    names.into_iter().find(|name| !known.insert(*name))
}

pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The chain that leads from link `base` to link `tool`, with the limits of its moving joints.
pub(crate) fn chain(robot: &urdf_rs::Robot, base: &str, tool: &str) -> Result<(Chain, Vec<UrdfLimits>)> {
    for frame in [base, tool] {
        if !robot.links.iter().any(|link| link.name == frame) {
            return Err(ManipulatorError::MissingFrame { frame: frame.into() });
        }
    }
    let joints = joints_between(robot, base, tool)?;
    let mut base_from_link = Pose::identity();
    let mut axes_in_base = Vec::new();
    let mut limits = Vec::new();
    for joint in joints {
        base_from_link *= origin(joint)?;
        if joint.joint_type == JointType::Fixed {
            continue;
        }
        axes_in_base.push((joint.name.clone(), base_from_link, unit_screw(joint)?));
        limits.push(stated_limits(joint)?);
    }
    if axes_in_base.is_empty() {
        return Err(ManipulatorError::NoChain { base: base.into(), tool: tool.into() });
    }
    let tool_from_base = base_from_link.inverse();
    let screws = axes_in_base
        .into_iter()
        .map(|(name, base_from_joint, screw)| {
            let tool_from_joint = tool_from_base * base_from_joint;
            let angular = tool_from_joint.rotation * screw.angular;
            let linear = tool_from_joint.rotation * screw.linear + tool_from_joint.translation.vector.cross(&angular);
            (name, Twist::new(linear, angular))
        })
        .collect();
    Ok((Chain::new(screws, base_from_link), limits))
}

/// The links from `base`, which is not among them, to `tool`.
pub(crate) fn links(robot: &urdf_rs::Robot, base: &str, tool: &str) -> Result<Vec<Link>> {
    let link = |joint: &Joint| {
        let screw = (joint.joint_type != JointType::Fixed).then(|| unit_screw(joint)).transpose()?;
        Ok(Link { name: joint.child.link.clone(), parent_from_joint: origin(joint)?, screw })
    };
    joints_between(robot, base, tool)?.into_iter().map(link).collect()
}

fn joints_between<'a>(robot: &'a urdf_rs::Robot, base: &str, tool: &str) -> Result<Vec<&'a Joint>> {
    let parent_joint: BTreeMap<&str, &Joint> = robot.joints.iter().map(|j| (j.child.link.as_str(), j)).collect();
    let mut joints = Vec::new();
    let mut link = tool;
    while link != base {
        let joint = parent_joint.get(link).filter(|_| joints.len() < robot.joints.len());
        let Some(joint) = joint else {
            return Err(ManipulatorError::NoChain { base: base.into(), tool: tool.into() });
        };
        joints.push(*joint);
        link = &joint.parent.link;
    }
    joints.reverse();
    Ok(joints)
}

/// What each moving joint between `base` and `tool` carries, in the frame `base` with all joints at zero: the links up to the next
/// of those joints and all that hangs on them, moving or not. Links without an inertial have none.
pub(crate) fn carried(robot: &urdf_rs::Robot, base: &str, tool: &str) -> Result<Vec<Inertia>> {
    let moving: Vec<&str> = joints_between(robot, base, tool)?
        .into_iter()
        .filter(|joint| joint.joint_type != JointType::Fixed)
        .map(|joint| joint.name.as_str())
        .collect();
    let links: BTreeMap<&str, &urdf_rs::Link> = robot.links.iter().map(|link| (link.name.as_str(), link)).collect();
    let mut below: BTreeMap<&str, Vec<&Joint>> = BTreeMap::new();
    for joint in &robot.joints {
        below.entry(&joint.parent.link).or_default().push(joint);
    }
    let mut carried = vec![Inertia::default(); moving.len()];
    let mut ahead = vec![(base, Pose::identity(), None)];
    let mut links_left = robot.links.len();
    while let Some((name, base_from_link, carrier)) = ahead.pop() {
        // A URDF whose joints form a ring would have no end.
        links_left = links_left
            .checked_sub(1)
            .ok_or_else(|| ManipulatorError::NoChain { base: base.into(), tool: tool.into() })?;
        if let (Some(joint), Some(link)) = (carrier, links.get(name)) {
            let own: usize = joint;
            carried[own] = carried[own] + inertia(link)?.in_parent(&base_from_link);
        }
        for joint in below.get(name).into_iter().flatten() {
            let place = moving.iter().position(|name| *name == joint.name);
            ahead.push((&joint.child.link, base_from_link * origin(joint)?, place.or(carrier)));
        }
    }
    Ok(carried)
}

/// Inertia of a link in its own frame.
fn inertia(link: &urdf_rs::Link) -> Result<Inertia> {
    let stated = &link.inertial;
    let [x, y, z] = stated.origin.xyz.0;
    let [roll, pitch, yaw] = stated.origin.rpy.0;
    let t = &stated.inertia;
    let tensor = Matrix3::new(t.ixx, t.ixy, t.ixz, t.ixy, t.iyy, t.iyz, t.ixz, t.iyz, t.izz);
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw).to_rotation_matrix().into_inner();
    Inertia::of_body(stated.mass.value, Vector3::new(x, y, z), turn * tensor * turn.transpose()).map_err(|error| {
        match error {
            ManipulatorError::Inertia { reason } => ManipulatorError::LinkInertia { link: link.name.clone(), reason },
            other => other,
        }
    })
}

/// `parent_from_joint`; URDF's rpy are fixed-axis angles, R = Rz(y)·Ry(p)·Rx(r).
fn origin(joint: &Joint) -> Result<Pose> {
    let (xyz, rpy) = (joint.origin.xyz.0, joint.origin.rpy.0);
    if let Some(&value) = xyz.iter().chain(&rpy).find(|v| !v.is_finite()) {
        return Err(invalid(joint, "a coordinate of its origin", value, "finite"));
    }
    let rotation = UnitQuaternion::from_euler_angles(rpy[0], rpy[1], rpy[2]);
    Ok(Pose::from_parts(Translation3::new(xyz[0], xyz[1], xyz[2]), rotation))
}

fn unit_screw(joint: &Joint) -> Result<Twist> {
    if let Some(mimic) = &joint.mimic {
        let kind = format!("coupled to joint {:?} by mimic", mimic.joint);
        return Err(ManipulatorError::UnsupportedJoint { joint: joint.name.clone(), kind });
    }
    let axis = Vector3::from(joint.axis.xyz.0);
    let length = axis.norm();
    if !(length.is_finite() && length > 1e-9) {
        return Err(invalid(joint, "the length of its axis", length, "positive"));
    }
    match joint.joint_type {
        JointType::Revolute | JointType::Continuous => Ok(Twist::new(Vector3::zeros(), axis / length)),
        JointType::Prismatic => Ok(Twist::new(axis / length, Vector3::zeros())),
        ref other => Err(ManipulatorError::UnsupportedJoint {
            joint: joint.name.clone(),
            kind: format!("{other:?}").to_lowercase(),
        }),
    }
}

fn stated_limits(joint: &Joint) -> Result<UrdfLimits> {
    let limit = &joint.limit;
    if !(limit.velocity.is_finite() && limit.velocity > 0.0) {
        return Err(invalid(joint, "its velocity limit", limit.velocity, "stated and positive"));
    }
    if !(limit.effort.is_finite() && limit.effort >= 0.0) {
        return Err(invalid(joint, "its effort limit", limit.effort, "positive, or 0 where it is not known"));
    }
    // The parser reads an absent effort as 0, and URDFs without dynamics say 0 too.
    let effort = if limit.effort > 0.0 { limit.effort } else { f64::INFINITY };
    let velocity = limit.velocity;
    let (damping, friction) = joint.dynamics.as_ref().map_or((0.0, 0.0), |stated| (stated.damping, stated.friction));
    if joint.joint_type == JointType::Continuous {
        return Ok(UrdfLimits { lower: f64::NEG_INFINITY, upper: f64::INFINITY, velocity, effort, damping, friction });
    }
    let range = limit.upper - limit.lower;
    if !(range.is_finite() && range > 0.0) {
        return Err(invalid(joint, "its range (upper - lower limit)", range, "stated and positive"));
    }
    Ok(UrdfLimits { lower: limit.lower, upper: limit.upper, velocity, effort, damping, friction })
}

fn invalid(joint: &Joint, what: &'static str, value: f64, must_be: &'static str) -> ManipulatorError {
    ManipulatorError::InvalidJoint { joint: joint.name.clone(), what, value, must_be }
}
