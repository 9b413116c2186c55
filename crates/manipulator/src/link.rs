//! Links as the URDF has them, for whoever draws the arm.

use se3_geom::{Pose, Twist};

/// A link and the joint that carries it: base_from_link = base_from_parent · `parent_from_joint` · exp(`screw`·q).
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Its name; also that of its frame.
    pub name: String,
    /// Where the joint is in the frame of the link before, with q = 0.
    pub parent_from_joint: Pose,
    /// The joint's unit screw axis in its own frame, (0, ω) of a turning joint and (v, 0) of a sliding one; none of a fixed one.
    pub screw: Option<Twist>,
}
