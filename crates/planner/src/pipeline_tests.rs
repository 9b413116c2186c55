//! The last gates of the pipeline, shut by hand.

use super::*;

/// Two joint points a tenth of a second apart, at rest: legal if they are near each other.
fn move_by(rad: f64) -> JointTrajectory {
    let robot = Robot::shipped("ur5e").unwrap();
    let from = DVector::from_element(6, -1.0);
    let mut trajectory = rest_to_rest(&robot, &from, &from.add_scalar(rad), &Default::default()).unwrap();
    let seconds = trajectory.duration_s();
    trajectory.points.iter_mut().for_each(|point| point.time_s *= 0.1 / seconds);
    trajectory
}

/// Squeezed into a tenth of a second without its derivatives, a move breaks its limits and the gate stays shut.
#[test]
fn a_trajectory_that_fails_its_audit_is_withheld() {
    let robot = Robot::shipped("ur5e").unwrap();
    let refused = passed_audit(&robot, &Config::default(), &move_by(0.5), None).unwrap_err();
    assert!(matches!(refused, Refusal::Limits { .. }));
    let message = refused.to_string();
    assert!(message.contains("a joint's acceleration goes") && !message.contains('{'), "{message}");
    let from = DVector::from_element(6, -1.0);
    let legal = rest_to_rest(&robot, &from, &from.add_scalar(0.5), &Default::default()).unwrap();
    assert!(passed_audit(&robot, &Config::default(), &legal, None).unwrap().limits_ok);
}

/// At few points a second the quintics between them leave a path that is to be kept to a micrometre; the sentence says what helps.
#[test]
fn a_tool_that_strays_between_points_is_refused() {
    let robot = Robot::shipped("ur5e").unwrap();
    let home = robot.chain.forward(&robot.preferred);
    let pose = |i: usize| {
        let angle = 0.3 * i as f64;
        let offset = manipulator::nalgebra::Translation3::new(0.1 * angle.sin(), 0.1 * angle.cos() - 0.1, 0.0);
        offset * home
    };
    let request = Request { poses: (0..12).map(pose).collect(), ..Request::default() };
    let mut config = Config::default();
    config.path.tolerance_m = 1e-6;
    assert!(plan(&robot, &config, &request).is_ok());
    config.timing.rate_hz = 10.0;
    let refused = plan(&robot, &config, &request).unwrap_err();
    assert!(matches!(refused, Refusal::Strays { error_m, .. } if error_m > 1e-6), "{refused}");
    assert!(refused.to_string().contains("raise rate_hz"), "{refused}");
}

/// A pose that the tool is not at, in position or in orientation, is named.
#[test]
fn a_pose_that_is_missed_is_refused_by_its_index() {
    let robot = Robot::shipped("ur5e").unwrap();
    let config = Config::default();
    let from = DVector::from_element(6, -1.0);
    let trajectory = rest_to_rest(&robot, &from, &from.add_scalar(0.5), &config.timing).unwrap();
    let there = |time: f64| robot.chain.forward(&trajectory.at(time)[0]);
    let times = [0.0, 0.5 * trajectory.duration_s()];
    let mut poses = times.map(there);
    assert!(accuracy(&robot, &config, &poses, &trajectory, &times).is_ok());
    poses[1].translation.vector.x += 3.0 * config.path.tolerance_m;
    let refused = accuracy(&robot, &config, &poses, &trajectory, &times);
    assert!(matches!(refused, Err(Refusal::Accuracy { input_pose: 1, .. })));
    poses[1] = there(times[1]);
    let tilt = Pose::rotation(manipulator::nalgebra::Vector3::x() * 3.0 * config.path.tolerance_rad);
    poses[0] *= tilt;
    let refused = accuracy(&robot, &config, &poses, &trajectory, &times);
    assert!(matches!(refused, Err(Refusal::Accuracy { input_pose: 0, .. })));
    // A time that is no number is not a pose that was passed.
    assert!(accuracy(&robot, &config, &[there(0.0)], &trajectory, &[f64::NAN]).is_err());
}
