//! How far a joint can carry anything.

use mujoco_rs::prelude::*;

use crate::error::{Result, SimError};
use crate::servo::Servo;

/// For each servo, how far the farthest point that it moves is from the joint's axis, in any configuration, in m; 1 for slides, which
/// move everything as far as themselves.
///
/// # Errors
/// [`SimError::NoShapes`] where no body that moves has a shape that collides.
pub(crate) fn reaches(model: &MjModel, servos: &[Servo]) -> Result<Vec<f64>> {
    let extents = extents(model);
    let reach = |servo: &Servo| {
        let joint = servo.joint_index;
        let body = model.jnt_bodyid()[joint] as usize;
        match model.jnt_type()[joint] {
            MjtJoint::mjJNT_SLIDE => 1.0,
            _ => length(&model.jnt_pos()[joint]) + extents[body],
        }
    };
    let reaches: Vec<f64> = servos.iter().map(reach).collect();
    let moves = |body: usize| servos.iter().any(|servo| model.jnt_bodyid()[servo.joint_index] as usize == body);
    let has_shape = (0..extents.len()).any(|body| moves(body) && extents[body] > 0.0);
    if has_shape { Ok(reaches) } else { Err(SimError::NoShapes) }
}

/// For each body, how far from its frame's origin a colliding shape of it or of a body that it carries can be; 0 without shapes.
fn extents(model: &MjModel) -> Vec<f64> {
    let bodies = model.body_parentid().len();
    let mut extents = vec![0.0_f64; bodies];
    for geom in 0..model.geom_bodyid().len() {
        if model.geom_contype()[geom] != 0 || model.geom_conaffinity()[geom] != 0 {
            let body = model.geom_bodyid()[geom] as usize;
            extents[body] = extents[body].max(length(&model.geom_pos()[geom]) + model.geom_rbound()[geom]);
        }
    }
    // Children come after their parents.
    for body in (1..bodies).rev() {
        if extents[body] > 0.0 {
            let parent = model.body_parentid()[body] as usize;
            // A joint turns the body about an anchor that need not be its origin, or slides it along its range.
            let swing: f64 = joints(model, body).map(|joint| slack(model, joint)).sum();
            extents[parent] = extents[parent].max(length(&model.body_pos()[body]) + swing + extents[body]);
        }
    }
    extents
}

fn joints(model: &MjModel, body: usize) -> std::ops::Range<usize> {
    let first = model.body_jntadr()[body].max(0) as usize;
    first..first + model.body_jntnum()[body] as usize
}

/// By how much a joint may carry its body's origin away from where it stands at zero.
fn slack(model: &MjModel, joint: usize) -> f64 {
    match model.jnt_type()[joint] {
        MjtJoint::mjJNT_SLIDE => model.jnt_range()[joint].iter().fold(0.0, |most, end| most.max(end.abs())),
        _ => 2.0 * length(&model.jnt_pos()[joint]),
    }
}

fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
