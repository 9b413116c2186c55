//! Which pose an error is about.

use crate::error::ManipulatorError;
use crate::reach::OutOfReach;

impl ManipulatorError {
    /// Indices, along the curve, of the poses that the error is about.
    pub fn poses(&self) -> Vec<usize> {
        match self {
            Self::Unreachable(OutOfReach { misses, .. }) => misses.iter().map(|miss| miss.pose).collect(),
            Self::UnreachableBetween { pose, .. }
            | Self::CutOff { pose }
            | Self::JointLimit { pose, .. }
            | Self::Singular { pose, .. }
            | Self::Jump { pose, .. }
            | Self::PathTolerance { pose, .. } => vec![*pose],
            Self::HoldingTorque { pose, .. } | Self::ConstantSpeed { pose, .. } => pose.iter().copied().collect(),
            _ => Vec::new(),
        }
    }

    /// The same about another pose.
    pub(crate) fn at_pose(mut self, other: usize) -> Self {
        match &mut self {
            Self::UnreachableBetween { pose, .. }
            | Self::CutOff { pose }
            | Self::JointLimit { pose, .. }
            | Self::Singular { pose, .. }
            | Self::Jump { pose, .. }
            | Self::PathTolerance { pose, .. } => *pose = other,
            _ => {}
        }
        self
    }
}
