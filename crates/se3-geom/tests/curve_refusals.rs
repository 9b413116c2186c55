//! Straight lines and Bézier curves that there are not.
#![allow(missing_docs, clippy::unwrap_used)]

use std::f64::consts::PI;

use se3_geom::nalgebra::{UnitQuaternion, Vector2, Vector3};
use se3_geom::{Bezier, LieGroup, LogError, Pose, R2, Screw, Se3Group, So3, So3Group};

/// Where only the rotations decide, the error names their angle, whatever the positions.
#[test]
fn half_turns_of_the_group_are_named_by_their_angle() {
    let start = Pose::identity();
    let end = Pose::new(Vector3::new(3.0, 4.0, 0.0), Vector3::new(0.0, PI, 0.0));
    let half_turn = LogError::CutLocus { distance: PI, angle_rad: Some(PI) };
    assert_eq!(Screw::between(start, end).unwrap_err(), half_turn);
    assert_eq!(Bezier::new(Se3Group, [start, start, end, end]).unwrap_err(), half_turn);
    let nowhere = Pose::translation(f64::NAN, 0.0, 0.0);
    assert_eq!(Screw::between(start, nowhere).unwrap_err(), LogError::NotAPoint);
    assert_eq!(Bezier::new(Se3Group, [start, start, nowhere, end]).unwrap_err(), LogError::NotAPoint);
}

#[test]
fn bezier_refuses_what_it_cannot_join() {
    let (identity, turned) = (UnitQuaternion::identity(), So3Group::exp(Vector3::new(PI, 0.0, 0.0)));
    assert!(Bezier::new(So3, [identity, identity, turned, turned]).is_err());
    let too_fast = [Vector3::new(3.0 * PI + 0.1, 0.0, 0.0), Vector3::zeros()];
    assert!(Bezier::from_end_velocities(So3, [identity, identity], too_fast).is_err());
    let nan = [Vector2::new(f64::NAN, 0.0), Vector2::zeros()];
    assert!(Bezier::from_end_velocities(R2::default(), nan, [Vector2::zeros(); 2]).is_err());
}
