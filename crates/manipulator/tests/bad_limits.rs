//! Limits that are none, and chains that are none: refused by name, wherever they come from.
#![allow(clippy::unwrap_used)]

mod support;

use manipulator::nalgebra::DVector;
use manipulator::{
    AuditRules, IkOptions, ManipulatorError, PathOptions, Robot, TimingOptions, audit, audit_under, connect, follow,
    least_duration_s, rest_to_rest, slow_to_stop, solve_ik, time_path,
};
use support::curves::{spline, writing};
use support::{Random, random_path, ur5e};

const URDF: &str = include_str!("../../../config/robots/ur5e.urdf");
const SETTINGS: &str = include_str!("../../../config/robots/ur5e.yaml");
/// What the URDF says of the elbow, and of no other joint.
const STATED: &str =
    r#"lower="-3.141592653589793" upper="3.141592653589793" effort="150" velocity="3.141592653589793""#;

/// The one line of an error that names everything in `words`.
fn assert_refused(urdf: &str, settings: &str, words: &[&str]) {
    let message = Robot::from_urdf(urdf, settings).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    words.iter().for_each(|word| assert!(message.contains(word), "{word:?} is not in {message:?}"));
}

/// The settings with other figures for the elbow.
fn with_elbow(figures: &str) -> String {
    let (before, line) = SETTINGS.split_once("elbow_joint: { ").unwrap();
    let (_, after) = line.split_once('}').unwrap();
    format!("{before}elbow_joint: {{ {figures} }}{after}")
}

#[test]
fn limits_in_settings_of_zero_negative_missing_and_no_number_are_refused_by_name() {
    Robot::from_urdf(URDF, &with_elbow("acceleration_rad_s2: 5.0, jerk_rad_s3: 50.0")).unwrap();
    let [acceleration, jerk] = ["acceleration_rad_s2: 5.0", "jerk_rad_s3: 50.0"];
    for value in ["0.0", "-5.0", ".nan", ".inf"] {
        let figures = format!("acceleration_rad_s2: {value}, {jerk}");
        assert_refused(URDF, &with_elbow(&figures), &["elbow_joint", "acceleration limit", "positive"]);
        let figures = format!("{acceleration}, jerk_rad_s3: {value}");
        assert_refused(URDF, &with_elbow(&figures), &["elbow_joint", "jerk limit", "positive"]);
        let figures = format!("{acceleration}, {jerk}, effort_n_m: {value}");
        assert_refused(URDF, &with_elbow(&figures), &["elbow_joint", "effort limit", "positive"]);
        let figures = format!("{acceleration}, {jerk}, velocity_rad_s: {value}");
        assert_refused(URDF, &with_elbow(&figures), &["elbow_joint", "must be"]);
    }
    for missing in [acceleration, jerk] {
        let key = missing.split(':').next().unwrap();
        let other = if missing == jerk { acceleration } else { jerk };
        assert_refused(URDF, &with_elbow(other), &["elbow_joint", "missing", key]);
    }
    assert_refused(URDF, &with_elbow(&format!("acceleration_rad_s2: fast, {jerk}")), &["elbow_joint", "fast"]);
    for figures in
        ["lower_rad: .nan", "upper_rad: .inf", "lower_rad: 1.0, upper_rad: 1.0", "lower_rad: 2.0, upper_rad: -2.0"]
    {
        assert_refused(URDF, &with_elbow(&format!("{acceleration}, {jerk}, {figures}")), &["elbow_joint", "must be"]);
    }
}

/// The last of two would win, and metres would count as radians.
#[test]
fn a_joint_that_is_there_twice_and_figures_in_other_units_are_refused_by_name() {
    let twice = format!("{SETTINGS}\n  elbow_joint: {{ acceleration_rad_s2: 50.0, jerk_rad_s3: 500.0 }}\n");
    let is_last = SETTINGS.trim_end().lines().last().unwrap().starts_with("  wrist_3_joint");
    assert!(is_last, "the joints are no longer the last of the settings");
    assert_refused(URDF, &twice, &["elbow_joint", "twice"]);
    for (key, other) in
        [("acceleration_rad_s2", "acceleration_m_s2"), ("jerk_rad_s3", "jerk_m_s3"), ("preferred_rad", "preferred_m")]
    {
        assert_refused(URDF, &SETTINGS.replace(key, other), &["turns", key, other]);
    }
}

#[test]
fn limits_in_a_urdf_of_zero_negative_missing_and_no_number_are_refused_by_name() {
    assert_eq!(URDF.matches(STATED).count(), 1);
    for (limits, words) in [
        (r#"lower="-3" upper="3" effort="150" velocity="0""#, ["elbow_joint", "velocity limit"]),
        (r#"lower="-3" upper="3" effort="150" velocity="-1""#, ["elbow_joint", "velocity limit"]),
        (r#"lower="-3" upper="3" effort="150" velocity="nan""#, ["elbow_joint", "velocity limit"]),
        (r#"lower="-3" upper="3" effort="150""#, ["URDF", "velocity"]),
        (r#"lower="-3" upper="3" effort="150" velocity="fast""#, ["URDF", "float"]),
        (r#"lower="3" upper="3" effort="150" velocity="3""#, ["elbow_joint", "range"]),
        (r#"lower="3" upper="-3" effort="150" velocity="3""#, ["elbow_joint", "range"]),
        (r#"lower="nan" upper="3" effort="150" velocity="3""#, ["elbow_joint", "range"]),
        (r#"lower="-inf" upper="3" effort="150" velocity="3""#, ["elbow_joint", "range"]),
        (r#"effort="150" velocity="3""#, ["elbow_joint", "range"]),
        (r#"lower="-3" upper="3" effort="-150" velocity="3""#, ["elbow_joint", "effort limit"]),
        (r#"lower="-3" upper="3" effort="nan" velocity="3""#, ["elbow_joint", "effort limit"]),
    ] {
        assert_refused(&URDF.replace(STATED, limits), SETTINGS, &words);
    }
}

/// The fields of a robot are public. With what is no number every comparison would come out as legal.
#[test]
fn limits_that_were_set_by_hand_are_checked_before_use() {
    let good = ur5e();
    let path = random_path(&good, 0.3, 30, &mut Random(101));
    let running = time_path(&good, &path, &TimingOptions::default()).unwrap().trajectory;
    assert!(audit(&good, &running).limits_ok);
    let curve = spline(&writing(&good, 20));
    let home = good.preferred.clone();
    let pose = good.chain.forward(&home);
    let (options, half_way) = (TimingOptions::default(), running.points[running.points.len() / 2].time_s);
    let refusals = |robot: &Robot| {
        assert!(!audit(robot, &running).limits_ok);
        [
            time_path(robot, &path, &options).map(drop),
            least_duration_s(robot, &path, &options, 100).map(drop),
            rest_to_rest(robot, &home, &home.add_scalar(0.1), &options).map(drop),
            slow_to_stop(robot, &running, half_way, &options).map(drop),
            connect(robot, &running, half_way, &home, &options).map(drop),
            follow(robot, &curve, Some(&home), &PathOptions::default()).map(drop),
            solve_ik(robot, &pose, &home, &IkOptions::default()).map(drop),
        ]
        .map(Result::unwrap_err)
    };
    for value in [0.0, -1.0, f64::NAN] {
        for figure in ["velocity limit", "acceleration limit", "jerk limit", "effort limit"] {
            let mut robot = good.clone();
            let limits = &mut robot.limits;
            match figure {
                "velocity limit" => limits.velocity[2] = value,
                "acceleration limit" => limits.acceleration[2] = value,
                "jerk limit" => limits.jerk[2] = value,
                _ => limits.effort[2] = value,
            }
            for refused in refusals(&robot) {
                match refused {
                    ManipulatorError::InvalidJoint { joint, what, .. } => {
                        assert!(joint == "elbow_joint" && what.ends_with(figure), "{joint} {what}");
                    }
                    other => panic!("{figure} {value}: {other}"),
                }
            }
        }
        let mut robot = good.clone();
        robot.limits.upper[2] = robot.limits.lower[2] + value;
        for refused in refusals(&robot) {
            assert!(refused.to_string().contains("elbow_joint\": its range"), "{refused}");
        }
    }
    let mut robot = good.clone();
    robot.limits.jerk = DVector::from_element(5, 50.0);
    for refused in refusals(&robot) {
        assert_eq!(refused, ManipulatorError::WrongSize { what: "a limit", expected: 6, given: 5 });
    }
}

/// The fields of the rules are public too, and a limit that is none would pass every comparison.
#[test]
fn tool_limits_that_are_none_fail_every_audit() {
    let robot = ur5e();
    let home = robot.preferred.clone();
    let legal = rest_to_rest(&robot, &home, &home.add_scalar(0.1), &TimingOptions::default()).unwrap();
    let passes = |rules: AuditRules| audit_under(&robot, &legal, rules, None).limits_ok;
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(!passes(AuditRules { tool_speed_m_s: Some(value), ..AuditRules::default() }), "{value}");
        assert!(!passes(AuditRules { tool_acceleration_m_s2: Some(value), ..AuditRules::default() }), "{value}");
    }
    let wide = AuditRules { tool_speed_m_s: Some(10.0), tool_acceleration_m_s2: Some(1e3), ..AuditRules::default() };
    assert!(passes(wide));
}

#[test]
fn a_chain_without_joints_and_frames_that_do_not_exist_are_refused_by_name() {
    for (from, to, words) in [
        ("tool_frame: tool0", "tool_frame: tool1", &["tool1"][..]),
        ("base_frame: base_link", "base_frame: floor", &["floor"]),
        ("tool_frame: tool0", "tool_frame: base_link", &["base_link", "no chain"]),
        // A fixed joint leads there, and nothing that moves.
        ("tool_frame: tool0", "tool_frame: base_link_inertia", &["base_link_inertia", "no chain"]),
        ("tool_frame: tool0", "tool_frame: ''", &["\"\""]),
        ("tool_frame: tool0\n", "", &["tool_frame"]),
    ] {
        assert_refused(URDF, &SETTINGS.replace(from, to), words);
    }
    assert_refused(
        r#"<robot name="rock"><link name="base_link"/><link name="tool0"/></robot>"#,
        SETTINGS,
        &["no chain"],
    );
}

/// Both numbers rounded to 1.5708 would say nothing.
#[test]
fn a_joint_hardly_beyond_its_limits_is_told_by_how_much() {
    let mut robot = ur5e();
    robot.limits.upper[2] = std::f64::consts::FRAC_PI_2;
    for (by, words) in [(3.2e-6, "3.2e-6"), (0.25, "0.2500")] {
        let mut q = robot.preferred.clone();
        q[2] = robot.limits.upper[2] + by;
        let message = robot.check_within_limits("the start", &q).unwrap_err().to_string();
        let sentence =
            format!("the start: elbow_joint is at {:.4}, {words} rad (or m) beyond its upper limit of 1.5708", q[2]);
        assert_eq!(message, sentence);
    }
}
