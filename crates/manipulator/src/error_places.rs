//! Which pose an error is about.

use crate::error::ManipulatorError;
use crate::reach::OutOfReach;

impl ManipulatorError {
    /// Index, along the curve, of the pose that the error is about.
    pub fn pose(&self) -> Option<usize> {
        match self {
            Self::Unreachable(OutOfReach { misses, .. }) => misses.first().map(|miss| miss.pose),
            Self::UnreachableBetween { pose, .. }
            | Self::JointLimit { pose, .. }
            | Self::Singular { pose, .. }
            | Self::Jump { pose, .. }
            | Self::PathTolerance { pose, .. } => Some(*pose),
            Self::HoldingTorque { pose, .. } | Self::ConstantSpeed { pose, .. } => *pose,
            _ => None,
        }
    }

    /// The same about another pose.
    pub(crate) fn at_pose(mut self, other: usize) -> Self {
        match &mut self {
            Self::UnreachableBetween { pose, .. }
            | Self::JointLimit { pose, .. }
            | Self::Singular { pose, .. }
            | Self::Jump { pose, .. }
            | Self::PathTolerance { pose, .. } => *pose = other,
            _ => {}
        }
        self
    }
}
