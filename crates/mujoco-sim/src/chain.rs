//! The kinematic chain of a model, for planning.

use std::path::Path;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use planner::manipulator::Chain;
use planner::manipulator::nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use planner::se3_geom::{Pose, Twist};

use crate::error::{Result, SimError};
use crate::model;

/// The chain of hinges and slides that leads from the world to the site `tool_site` of an MJCF model.
///
/// Its poses are `world_from_tool`, its joints stand in the order world to tool and are zero where MuJoCo's `qpos` is. The
/// screw axis of a joint is (a × u, u) for a hinge about u through a, and (u, 0) for a slide along u, both with all joints at zero.
///
/// ```no_run
/// let chain = mujoco_sim::read_chain(mujoco_sim::model_file("panda")?, mujoco_sim::TOOL_SITE)?;
/// assert_eq!(chain.dof(), 7);
/// # Ok::<(), mujoco_sim::SimError>(())
/// ```
///
/// # Errors
/// Where the file is no model or has no such site, or [`SimError::NotAChain`], which names the joint: a free or ball joint, one that
/// has no name or that an equality constraint couples to another, or none at all.
pub fn read_chain(path: impl AsRef<Path>, tool_site: &str) -> Result<Chain> {
    let file = path.as_ref().display().to_string();
    let model = Arc::new(model::load(path.as_ref())?);
    let site = model::site(&model, &file, tool_site)?;
    let not_a_chain = |why: String| SimError::NotAChain { file: file.clone(), site: tool_site.into(), why };
    let joints = joints_to(&model, site);
    let names = joints.iter().map(|&joint| usable_name(&model, joint)).collect::<std::result::Result<Vec<_>, _>>();
    let names = names.map_err(not_a_chain)?;

    let mut data = MjData::try_new(Arc::clone(&model))
        .map_err(|error| SimError::Model { file: file.clone(), reason: error.to_string() })?;
    for &joint in &joints {
        data.qpos_mut()[model.jnt_qposadr()[joint] as usize] = 0.0;
    }
    data.forward_kinematics();
    let screw = |&joint: &usize| {
        let (anchor, axis) = (Vector3::from(data.xanchor()[joint]), Vector3::from(data.xaxis()[joint]));
        match model.jnt_type()[joint] {
            MjtJoint::mjJNT_SLIDE => Twist::new(axis, Vector3::zeros()),
            _ => Twist::new(anchor.cross(&axis), axis),
        }
    };
    let screws = names.into_iter().zip(joints.iter().map(screw)).collect();
    Chain::from_space_screws(screws, site_pose(&data, site)).map_err(|error| not_a_chain(error.to_string()))
}

/// `world_from_site`.
pub(crate) fn site_pose(data: &MjData<Arc<MjModel>>, site: usize) -> Pose {
    let [x, y, z] = data.site_xpos()[site];
    // MuJoCo's matrices are row by row. Taking the matrix leaves no quaternion order to mistake.
    let matrix = Matrix3::from_row_slice(&data.site_xmat()[site]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    Pose::from_parts(Translation3::new(x, y, z), rotation)
}

/// All joints between the world and a site, in the order in which they act.
fn joints_to(model: &MjModel, site: usize) -> Vec<usize> {
    let mut joints = Vec::new();
    let mut body = model.site_bodyid()[site] as usize;
    while body != 0 {
        let count = model.body_jntnum()[body] as usize;
        let first = model.body_jntadr()[body].max(0) as usize;
        joints.extend((first..first + count).rev());
        body = model.body_parentid()[body] as usize;
    }
    joints.reverse();
    joints
}

/// The name of a joint that a chain of single axes can have, or why it cannot.
fn usable_name(model: &MjModel, joint: usize) -> std::result::Result<String, String> {
    let name = model.id_to_name(MjtObjBase::mjOBJ_JOINT, joint).filter(|name| !name.is_empty());
    let shown = name.map_or_else(|| joint.to_string(), |name| format!("{name:?}"));
    match model.jnt_type()[joint] {
        MjtJoint::mjJNT_FREE => return Err(format!("joint {shown} is a free joint")),
        MjtJoint::mjJNT_BALL => return Err(format!("joint {shown} is a ball joint")),
        _ => {}
    }
    let coupled = (0..model.eq_type().len()).any(|constraint| {
        model.eq_type()[constraint] == MjtEq::mjEQ_JOINT
            && model.eq_active0()[constraint]
            && [model.eq_obj1id()[constraint], model.eq_obj2id()[constraint]].contains(&(joint as i32))
    });
    match name {
        _ if coupled => Err(format!("joint {shown} is coupled by an equality constraint")),
        Some(name) => Ok(name.to_owned()),
        None => Err(format!("joint {shown} has no name")),
    }
}
