//! MuJoCo's inverse dynamics, and ours beside it.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use mujoco_sim::planner::manipulator::Dynamics;
use mujoco_sim::planner::manipulator::nalgebra::DVector;

/// MuJoCo's inverse dynamics of some joints of a model, without contacts and joint limits.
pub(crate) struct Oracle {
    data: MjData<Arc<MjModel>>,
    places: Vec<(usize, usize)>,
}

impl Oracle {
    pub(crate) fn new(mut model: MjModel, joints: &[String]) -> Self {
        model.opt_mut().disableflags |= MjtDisableBit::mjDSBL_CONSTRAINT as i32 | MjtDisableBit::mjDSBL_CONTACT as i32;
        let place = |name: &String| {
            let joint = (0..model.jnt_type().len())
                .find(|&joint| model.id_to_name(MjtObjBase::mjOBJ_JOINT, joint) == Some(name.as_str()))
                .unwrap_or_else(|| panic!("MuJoCo has no joint {name}"));
            (model.jnt_qposadr()[joint] as usize, model.jnt_dofadr()[joint] as usize)
        };
        let places = joints.iter().map(place).collect();
        Self { data: MjData::try_new(Arc::new(model)).unwrap(), places }
    }

    /// The torque of each joint at positions, rates and accelerations.
    pub(crate) fn torque(&mut self, [q, rates, accelerations]: [&DVector<f64>; 3]) -> DVector<f64> {
        for (joint, &(position, velocity)) in self.places.iter().enumerate() {
            self.data.qpos_mut()[position] = q[joint];
            self.data.qvel_mut()[velocity] = rates[joint];
            self.data.qacc_mut()[velocity] = accelerations[joint];
        }
        self.data.inverse();
        let torques = self.data.qfrc_inverse();
        DVector::from_iterator(self.places.len(), self.places.iter().map(|&(_, velocity)| torques[velocity]))
    }

    pub(crate) fn dof(&self) -> usize {
        self.places.len()
    }
}

pub(crate) fn ours(dynamics: &Dynamics, [q, rates, accelerations]: [&DVector<f64>; 3]) -> DVector<f64> {
    let mut torque = DVector::from_element(q.len(), f64::NAN);
    dynamics.torque(q.as_slice(), rates.as_slice(), accelerations.as_slice(), torque.as_mut_slice());
    torque
}
