//! The chain of a model and its dynamics, for planning.

use std::path::Path;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use planner::manipulator::nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use planner::manipulator::{Chain, Drive, Dynamics, Inertia, ManipulatorError};
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
    Ok(AtZero::read(path.as_ref(), tool_site)?.chain)
}

/// Inertias, rotor inertias, friction and gravity of the chain that [`read_chain`] reads: what is executed in simulation, where the
/// model differs from a URDF. Bodies that hang on the chain by further joints count as they stand in the model's initial state.
///
/// ```no_run
/// let file = mujoco_sim::model_file("panda")?;
/// let mut torque = [0.0; 7];
/// mujoco_sim::read_dynamics(file, mujoco_sim::TOOL_SITE)?.torque(&[0.1; 7], &[0.2; 7], &[0.3; 7], &mut torque);
/// # Ok::<(), mujoco_sim::SimError>(())
/// ```
///
/// # Errors
/// As [`read_chain`].
pub fn read_dynamics(path: impl AsRef<Path>, tool_site: &str) -> Result<Dynamics> {
    AtZero::read(path.as_ref(), tool_site)?.dynamics()
}

/// A model with the joints of the chain at zero.
struct AtZero {
    file: String,
    site: String,
    model: Arc<MjModel>,
    data: MjData<Arc<MjModel>>,
    joints: Vec<usize>,
    chain: Chain,
}

impl AtZero {
    fn read(path: &Path, tool_site: &str) -> Result<Self> {
        let file = path.display().to_string();
        let model = Arc::new(model::load(path)?);
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
        let chain = Chain::from_space_screws(screws, site_pose(&data, site));
        let chain = chain.map_err(|error| not_a_chain(error.to_string()))?;
        Ok(Self { file, site: tool_site.into(), model, data, joints, chain })
    }

    fn dynamics(&self) -> Result<Dynamics> {
        let model = &self.model;
        let refused = |error: ManipulatorError| SimError::NotAChain {
            file: self.file.clone(),
            site: self.site.clone(),
            why: error.to_string(),
        };
        let mut links = vec![Inertia::default(); self.joints.len()];
        for body in 1..model.body_mass().len() {
            if let Some(carrier) = self.carrier(body) {
                links[carrier] = links[carrier] + self.body(body).map_err(refused)?;
            }
        }
        let drive = |&joint: &usize| {
            let dof = model.jnt_dofadr()[joint] as usize;
            Drive {
                rotor_inertia_kg_m2: model.dof_armature()[dof],
                damping_n_m_s: model.dof_damping()[dof],
                friction_n_m: model.dof_frictionloss()[dof],
            }
        };
        let drives: Vec<_> = self.joints.iter().map(drive).collect();
        Dynamics::new(&self.chain, &links, &drives, model.opt().gravity).map_err(refused)
    }

    /// Which joint of the chain, counted along it, moves a body: the last one on the way there.
    fn carrier(&self, mut body: usize) -> Option<usize> {
        while body != 0 {
            let of_body = |joint: &usize| self.model.jnt_bodyid()[*joint] as usize == body;
            if let Some(last) = self.joints.iter().rposition(of_body) {
                return Some(last);
            }
            body = self.model.body_parentid()[body] as usize;
        }
        None
    }

    /// Inertia of a body in the world.
    fn body(&self, body: usize) -> std::result::Result<Inertia, ManipulatorError> {
        // MuJoCo keeps principal moments; the columns of this matrix are their axes.
        let axes = Matrix3::from_row_slice(&self.data.ximat()[body]);
        let moments = Matrix3::from_diagonal(&Vector3::from(self.model.body_inertia()[body]));
        let center = Vector3::from(self.data.xipos()[body]);
        Inertia::of_body(self.model.body_mass()[body], center, axes * moments * axes.transpose())
    }
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
