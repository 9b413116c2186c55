//! What a run reports is what happened.

// Helpers of tests are not seen as tests.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use mujoco_sim::planner::manipulator::JointTrajectory;
use mujoco_sim::planner::se3_geom::Pose;
use mujoco_sim::{ExecuteOptions, Execution, SimError, SimulatedArm, TOOL_SITE, model_file};
use support::{FOLDED, HOME, quintic_move, ur5e};

const GOAL: [f64; 6] = [-0.6, -1.2, 1.2, -1.8, -1.0, 0.8];

fn run(arm: &mut SimulatedArm, trajectory: &JointTrajectory) -> Execution {
    arm.execute(trajectory, &ExecuteOptions::default()).unwrap()
}

/// A copy of the UR5e's model with text replaced, in a folder of its own.
fn altered_model(test: &str, replacements: &[(&str, &str)]) -> PathBuf {
    let mut text = fs::read_to_string(model_file("ur5e").unwrap()).unwrap();
    for (old, new) in replacements {
        assert!(text.contains(old), "the model has no {old}");
        text = text.replace(old, new);
    }
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test).with_extension("xml");
    fs::write(&path, text).unwrap();
    path
}

fn load(path: &Path) -> Result<SimulatedArm, SimError> {
    SimulatedArm::load(path, TOOL_SITE)
}

/// A quintic over D has its peak acceleration 10/√3·D/T²: 2 rad in 1.52 s reach the planner's 5 rad/s², at 2.5 rad/s. Left to the
/// position error, the shoulder's inertia alone (more than 2 kg m² on 2000 N m/rad) would take 0.005 rad of it; a reference velocity
/// half a step of 2 ms old, kd/kp·q̈·h/2 = 0.2 s·5 rad/s²·1 ms = 0.001 rad.
#[test]
fn a_move_at_the_acceleration_limit_is_tracked() {
    let mut arm = ur5e();
    let mut goal = HOME;
    goal[0] += 2.0;
    let swing = run(&mut arm, &quintic_move(HOME, goal, 1.52));
    assert!(swing.tracking_max_rad < 1e-4, "{} rad", swing.tracking_max_rad);

    let all_joints = run(&mut arm, &quintic_move(HOME, GOAL, 2.0));
    assert!(all_joints.tracking_max_rad < 0.002, "{} rad", all_joints.tracking_max_rad);
    assert!(all_joints.tracking_rms_rad > 0.0 && all_joints.tracking_rms_rad <= all_joints.tracking_max_rad);
    assert_eq!(all_joints.duration_s, 2.0);
    let last = all_joints.samples.last().unwrap();
    assert!((last.time_s - 2.5).abs() <= all_joints.timestep_s, "no settling: ends at {} s", last.time_s);
    let worst = all_joints.joints.iter().map(|joint| joint.max_rad).fold(0.0, f64::max);
    assert_eq!(worst, all_joints.tracking_max_rad);
    // At home the shoulder already holds some 40 of its 150 N m against gravity.
    assert!(all_joints.max_torque_ratio > 0.2 && all_joints.max_torque_ratio < 0.9, "{}", all_joints.max_torque_ratio);
    assert_eq!(all_joints.saturated_steps, 0);
    assert!(all_joints.contacts.is_empty());
}

#[test]
fn it_is_the_feed_forward_that_tracks() {
    let mut arm = ur5e();
    let trajectory = quintic_move(HOME, GOAL, 2.0);
    let with = run(&mut arm, &trajectory);
    let without =
        arm.execute(&trajectory, &ExecuteOptions { feed_forward: false, ..ExecuteOptions::default() }).unwrap();
    assert!(without.tracking_max_rad > 10.0 * with.tracking_max_rad);
    assert!(without.tracking_rms_rad > 10.0 * with.tracking_rms_rad);
    // A servo that is told positions alone lags by kd·q̇/kp = 0.2 s: 1.8 rad/s at the peak of 0.9708 rad in 2 s, and sags too.
    assert!(without.tracking_max_rad > 0.1, "{} rad", without.tracking_max_rad);
}

#[test]
fn joints_are_matched_by_name() {
    let mut arm = ur5e();
    let trajectory = quintic_move(HOME, GOAL, 1.0);
    let places = [3, 0, 5, 1, 4, 2];
    let permuted = JointTrajectory {
        joint_names: places.iter().map(|&i| trajectory.joint_names[i].clone()).collect(),
        points: trajectory
            .points
            .iter()
            .map(|point| {
                let mut point = point.clone();
                for values in [&mut point.positions, &mut point.velocities, &mut point.accelerations] {
                    *values = places.iter().map(|&i| values[i]).collect();
                }
                point
            })
            .collect(),
    };
    assert_same(run(&mut arm, &trajectory), run(&mut arm, &permuted));
}

#[test]
fn runs_repeat_bit_for_bit() {
    let mut arm = ur5e();
    let trajectory = quintic_move(HOME, FOLDED, 1.0);
    let first = run(&mut arm, &trajectory);
    assert!(!first.contacts.is_empty(), "contacts are the part that would not repeat");
    run(&mut arm, &quintic_move(GOAL, HOME, 0.5));
    assert_same(first.clone(), run(&mut arm, &trajectory));
    assert_same(first, run(&mut ur5e(), &trajectory));
}

fn assert_same(mut one: Execution, mut other: Execution) {
    one.realtime_factor = 0.0;
    other.realtime_factor = 0.0;
    assert!(one == other, "the runs differ");
}

#[test]
fn joints_that_do_not_match_are_named() {
    let mut arm = ur5e();
    let whole = quintic_move(HOME, GOAL, 1.0);
    let sentence = |arm: &mut SimulatedArm, trajectory: &JointTrajectory| {
        arm.execute(trajectory, &ExecuteOptions::default()).unwrap_err().to_string()
    };

    let mut lacking = whole.clone();
    lacking.joint_names.remove(2);
    for point in &mut lacking.points {
        for values in [&mut point.positions, &mut point.velocities, &mut point.accelerations] {
            values.remove(2);
        }
    }
    assert_eq!(sentence(&mut arm, &lacking), "the trajectory says nothing about joint elbow_joint of the model");

    let mut foreign = whole.clone();
    foreign.joint_names[1] = "panda_joint2".into();
    assert!(
        sentence(&mut arm, &foreign).starts_with("the model has no actuated joint panda_joint2; it has shoulder_pan")
    );

    let mut twice = whole;
    twice.joint_names[5] = twice.joint_names[0].clone();
    assert_eq!(sentence(&mut arm, &twice), "the trajectory names joint shoulder_pan_joint twice");
}

#[test]
fn malformed_trajectories_and_options_are_refused() {
    let mut arm = ur5e();
    let whole = quintic_move(HOME, GOAL, 1.0);
    let mut refuse = |alter: &dyn Fn(&mut JointTrajectory), options: ExecuteOptions| {
        let mut trajectory = whole.clone();
        alter(&mut trajectory);
        arm.execute(&trajectory, &options).unwrap_err()
    };
    let usual = ExecuteOptions::default();
    assert!(matches!(refuse(&|t| t.points[1].velocities[3] = f64::NAN, usual), SimError::NonFinite { .. }));
    assert!(matches!(refuse(&|t| t.points[1].time_s = f64::INFINITY, usual), SimError::NonFinite { .. }));
    assert!(matches!(refuse(&|t| t.points.clear(), usual), SimError::EmptyTrajectory));
    assert!(matches!(refuse(&|t| t.points[0].positions.truncate(5), usual), SimError::WrongSize { .. }));
    assert!(matches!(refuse(&|t| t.points[1].time_s = 0.0, usual), SimError::TimesNotIncreasing { point: 1, .. }));
    assert!(matches!(refuse(&|t| t.points[0].time_s = -1.0, usual), SimError::TimesNotIncreasing { point: 0, .. }));
    assert!(matches!(refuse(&|t| t.points[1].time_s = 1e9, usual), SimError::TooLong { .. }));
    let endless = ExecuteOptions { settle_s: f64::NAN, ..usual };
    assert!(matches!(refuse(&|_| (), endless), SimError::InvalidOption { name: "settle_s", .. }));
    let never = ExecuteOptions { sample_rate_hz: 0.0, ..usual };
    assert!(matches!(refuse(&|_| (), never), SimError::InvalidOption { name: "sample_rate_hz", .. }));
    assert!(matches!(arm.tool_pose(&[0.0; 5]), Err(SimError::WrongSize { given: 5, .. })));
    assert!(matches!(arm.tool_pose(&[f64::NAN; 6]), Err(SimError::NonFinite { .. })));
}

#[test]
fn contacts_are_found_named_and_timed() {
    let mut arm = ur5e();
    assert_eq!(arm.touches(&HOME).unwrap(), []);
    let touches = arm.touches(&FOLDED).unwrap();
    assert_eq!(touches.len(), 8);
    assert!(touches.iter().all(|touch| touch.depth_m >= 0.0 && touch.depth_m < 0.1));

    // Folding at a steady pace, the arm is free at first and touches later.
    let trajectory = quintic_move(HOME, FOLDED, 2.0);
    let folding = run(&mut arm, &trajectory);
    let first = folding.contacts.first().expect("the arm folds into itself");
    assert!(first.from_s > 0.5 && first.from_s < 2.0 && first.until_s >= first.from_s, "{first:?}");
    assert!(first.depth_max_m > 0.0);
    assert!(folding.contacts.iter().all(|event| event.bodies.iter().all(|body| body.ends_with("_link"))));
    assert!(folding.contacts.iter().any(|event| event.bodies.iter().any(|body| body == "upper_arm_link")));
}

#[test]
fn pose_errors_are_those_of_the_tool_at_the_time() {
    let mut arm = ur5e();
    let trajectory = quintic_move(HOME, GOAL, 2.0);
    let execution = run(&mut arm, &trajectory);
    // Times between the steps of 2 ms, and both ends.
    let times: Vec<f64> = (0..=137).map(|i| 2.0 * f64::from(i) / 137.0).collect();
    let poses: Vec<Pose> =
        times.iter().map(|&time| arm.tool_pose(trajectory.at(time)[0].as_slice()).unwrap()).collect();
    let errors = execution.pose_errors(&poses, &times).unwrap();
    // A joint error turns the tool about an axis that is less than 1.3 m (the UR5e's reach) away; the errors of six joints add.
    let joint_error = execution.tracking_max_rad + 1e-5;
    assert!(errors.max_m < 6.0 * 1.3 * joint_error && errors.max_rad < 6.0 * joint_error, "{errors:?}");
    assert!(errors.max_m > 0.0 && errors.max_rad > 0.0);

    let mut shifted = poses.clone();
    shifted[50].translation.vector.z += 0.01;
    let off = execution.pose_errors(&shifted, &times).unwrap();
    assert!((off.max_m - 0.01).abs() <= errors.max_m, "{off:?}");

    // The tool is up to 1 m/s fast on its way: poses that are due 0.1 s later are missed by centimetres.
    let late: Vec<f64> = times.iter().map(|time| time + 0.1).collect();
    assert!(execution.pose_errors(&poses, &late).unwrap().max_m > 0.03);

    assert!(matches!(execution.pose_errors(&poses, &times[1..]), Err(SimError::PoseTimeCount { .. })));
    for outside in [-0.001, 3.0, f64::NAN] {
        let errors = execution.pose_errors(&poses[..1], &[outside]);
        assert!(matches!(errors, Err(SimError::PoseTime { pose: 0, .. })), "{outside}");
    }
}

#[test]
fn too_fast_a_move_saturates_the_servos() {
    let mut arm = ur5e();
    let mut goal = HOME;
    goal[0] += 2.0;
    // 2 rad in 0.3 s would take 128 rad/s², on more than 2 kg m² more than the 150 N m.
    let jerked = run(&mut arm, &quintic_move(HOME, goal, 0.3));
    assert_eq!(jerked.max_torque_ratio, 1.0);
    assert!(jerked.saturated_steps > 10);
    assert!(jerked.tracking_max_rad > 0.005, "{} rad", jerked.tracking_max_rad);
}

#[test]
fn gains_are_those_of_the_model() {
    let softer = [
        (r#"gainprm="2000" biasprm="0 -2000 -400""#, r#"gainprm="700" biasprm="0 -700 -90""#),
        (r#"gainprm="500" biasprm="0 -500 -100""#, r#"gainprm="300" biasprm="0 -300 -20""#),
    ];
    let mut arm = load(&altered_model("softer", &softer)).unwrap();
    let execution = run(&mut arm, &quintic_move(HOME, GOAL, 2.0));
    // With the gains of the original the control would be off by (1/700 − 1/2000)·40 N m = 0.04 rad in the shoulder.
    assert!(execution.tracking_max_rad < 0.002, "{}", execution.tracking_max_rad);
}

#[test]
fn models_that_cannot_be_driven_are_refused() {
    let sentence = |path: &Path, site| SimulatedArm::load(path, site).err().unwrap().to_string();
    let ur5e = model_file("ur5e").unwrap();
    assert!(sentence(&ur5e, "pen_tip").ends_with(r#"has no site "pen_tip" to mark the tool"#));
    let torque =
        altered_model("torque", &[(r#"gainprm="500" biasprm="0 -500 -100""#, r#"gainprm="1" biasprm="0 0 0""#)]);
    assert!(sentence(&torque, TOOL_SITE).contains(r#"actuator "wrist_1" is not a position servo"#));
    let broken = altered_model("broken", &[("</mujoco>", "")]);
    assert!(sentence(&broken, TOOL_SITE).contains("is not a model that MuJoCo loads: "));
    assert!(!sentence(&broken, TOOL_SITE).contains('\n'));
    assert!(sentence(Path::new("nowhere.xml"), TOOL_SITE).starts_with("nowhere.xml: "));
    assert!(matches!(model_file("ur10"), Err(SimError::UnknownRobot { .. })));
}

/// With an explicit integrator, a long step and no bound on the force the servos' damping overshoots: h·kd/M = 0.02·100/0.1 > 2.
#[test]
fn a_diverging_simulation_is_an_error() {
    let explicit = [
        (r#"integrator="implicitfast""#, r#"integrator="Euler" timestep="0.02""#),
        (r#" forcerange="-150 150""#, ""),
        (r#" forcerange="-28 28""#, ""),
    ];
    let mut arm = load(&altered_model("explicit", &explicit)).unwrap();
    let outcome = arm.execute(&quintic_move(HOME, GOAL, 2.0), &ExecuteOptions::default());
    let divergence = outcome.map(|execution| execution.tracking_max_rad).unwrap_err();
    assert!(matches!(divergence, SimError::Diverged { timestep_s: 0.02, .. }), "{divergence}");
    assert!(!Path::new("MUJOCO_LOG.TXT").exists(), "MuJoCo noticed first, and wrote its log into the working folder");
}
