//! Kinematics of the shipped arms against MuJoCo's model and published figures, and of any chain against its definition.
#![allow(clippy::unwrap_used)]

mod support;

use manipulator::nalgebra::{DVector, Matrix6xX, UnitQuaternion, Vector3};
use manipulator::{Chain, ManipulatorError, Robot};
use se3_geom::{LieGroup, Manifold, Pose, Se3, Se3Group, So3, Twist, pose_from_xyzw};
use support::{Random, mounted_ur5e, random_configuration, ur5e};

/// MuJoCo's own range ends at 6.28319 and its figures have twelve decimals; the quarter turns of its quaternions are exact.
const GOLDEN_TOLERANCE: f64 = 1e-10;

#[test]
fn tool_poses_are_those_of_mujoco() {
    let golden: serde_json::Value = serde_json::from_str(include_str!("data/ur5e_forward_kinematics.json")).unwrap();
    let robot = ur5e();
    assert_eq!(serde_json::to_value(robot.chain.joint_names()).unwrap(), golden["joints"]);
    let rows = golden["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1000);
    for row in rows {
        let row: Vec<f64> = serde_json::from_value(row.clone()).unwrap();
        let expected = pose_from_xyzw([row[6], row[7], row[8]], [row[9], row[10], row[11], row[12]]).unwrap();
        let found = robot.chain.forward(&DVector::from_column_slice(&row[..6]));
        assert!((found.translation.vector - expected.translation.vector).norm() < GOLDEN_TOLERANCE);
        assert!(So3.distance(&found.rotation, &expected.rotation) < GOLDEN_TOLERANCE);
    }
}

/// log(T(q − h)⁻¹·T(q + h))/2h, one column a joint.
fn difference_quotient(chain: &Chain, q: &DVector<f64>, h: f64) -> Matrix6xX<f64> {
    let mut quotient = Matrix6xX::zeros(chain.dof());
    for joint in 0..chain.dof() {
        let mut step = DVector::zeros(chain.dof());
        step[joint] = h;
        let (before, after) = (chain.forward(&(q - &step)), chain.forward(&(q + &step)));
        let twist = Se3Group::log(&(before.inverse() * after)).unwrap();
        quotient.set_column(joint, &(twist.to_vector() / (2.0 * h)));
    }
    quotient
}

/// A single joint moves on a screw, for which the difference quotient is exact. So the joints are moved together, along a
/// direction, where the error is that of central differences, O(h²): halving the step must quarter it.
#[test]
fn jacobian_is_the_slope_of_forward_kinematics() {
    for name in Robot::shipped_names() {
        assert_jacobian_is_the_slope(&Robot::shipped(name).unwrap());
    }
}

fn assert_jacobian_is_the_slope(robot: &Robot) {
    let mut random = Random(11);
    for _ in 0..20 {
        let q = random_configuration(robot, 3.0, &mut random);
        let jacobian = robot.chain.body_jacobian(&q);
        assert!((difference_quotient(&robot.chain, &q, 1e-4) - &jacobian).amax() < 1e-10);
        let direction = random_configuration(robot, 1.0, &mut random);
        let defect = |h: f64| {
            let (before, after) =
                (robot.chain.forward(&(&q - &direction * h)), robot.chain.forward(&(&q + &direction * h)));
            let twist = Se3Group::log(&(before.inverse() * after)).unwrap();
            (twist.to_vector() / (2.0 * h) - &jacobian * &direction).norm()
        };
        let ratio = defect(0.04) / defect(0.02);
        // The next term of the expansion is h² smaller: with |q̇| ≲ 2.5 it changes the ratio by some per cent.
        assert!((ratio - 4.0).abs() < 0.4, "ratio {ratio}");
    }
}

#[test]
fn names_and_limits_are_those_of_the_data_sheet() {
    let robot = ur5e();
    assert_eq!(robot.name, "ur5e");
    assert_eq!((robot.base_frame.as_str(), robot.tool_frame.as_str()), ("base_link", "tool0"));
    let (pi, tau) = (std::f64::consts::PI, std::f64::consts::TAU);
    assert_eq!(robot.limits.upper.as_slice(), [tau, tau, pi, tau, tau, tau]);
    assert_eq!(robot.limits.lower, -&robot.limits.upper);
    assert_eq!(robot.limits.velocity.as_slice(), [pi; 6]);
    assert_eq!(robot.limits.acceleration.as_slice(), [5.0; 6]);
    assert_eq!(robot.limits.jerk.as_slice(), [50.0; 6]);
    assert_eq!(robot.limits.effort.as_slice(), [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]);
    let unknown = Robot::shipped("ur6e").unwrap_err().to_string();
    assert!(Robot::shipped_names().chain(["ur6e"]).all(|name| unknown.contains(name)), "{unknown}");
}

#[test]
fn effort_limits_come_from_the_urdf_and_are_tightened_by_the_settings() {
    let urdf = mixed("revolute", "");
    let efforts = |urdf: &str, slide: &str| {
        let settings = MIXED_SETTINGS.replace("upper_m: 0.75", slide);
        Robot::from_urdf(urdf, &settings).map(|robot| robot.limits.effort[0])
    };
    assert_eq!(efforts(&urdf, "effort_n: 0.25").unwrap(), 0.25);
    assert_eq!(efforts(&urdf, "effort_n: 7.0").unwrap(), 1.0);
    let unstated = urdf.replace(r#"effort="1" velocity="0.5""#, r#"velocity="0.5""#);
    assert_eq!(efforts(&unstated, "effort_n: 7.0").unwrap(), 7.0);
    assert_eq!(efforts(&unstated, "upper_m: 0.75").unwrap(), f64::INFINITY);
    for (urdf, slide) in [
        (urdf.replace(r#"effort="1""#, r#"effort="-1""#), "upper_m: 0.75"),
        (urdf.replace(r#"effort="1""#, r#"effort="nan""#), "upper_m: 0.75"),
        (urdf.clone(), "effort_n: 0.0"),
        (urdf.clone(), "effort_n: -2.0"),
        (urdf.clone(), "effort_n: .nan"),
    ] {
        let message = efforts(&urdf, slide).unwrap_err().to_string();
        assert!(message.contains("slide") && message.contains("effort"), "{message}");
    }
}

/// Distance of link i from its predecessor along x, twist about x, offset along z (Craig's convention), as the manufacturer publishes
/// them in m and quarter turns; the flange is 0.107 m beyond joint 7, the hand an eighth of a turn about z.
const PANDA_DH: [[f64; 3]; 7] = [
    [0.0, 0.0, 0.333],
    [0.0, -1.0, 0.0],
    [0.0, 1.0, 0.316],
    [0.0825, 1.0, 0.0],
    [-0.0825, -1.0, 0.384],
    [0.0, 1.0, 0.0],
    [0.088, 1.0, 0.0],
];

#[test]
fn the_panda_has_the_published_denavit_hartenberg_figures() {
    let robot = Robot::shipped("panda").unwrap();
    let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
    let mut random = Random(3);
    for _ in 0..100 {
        let q = random_configuration(&robot, 3.0, &mut random);
        let mut expected = Pose::identity();
        for (&[along, quarters, offset], &angle) in PANDA_DH.iter().zip(q.iter()) {
            expected *= about(Vector3::x(), quarters * std::f64::consts::FRAC_PI_2);
            expected *= Pose::translation(along, 0.0, 0.0);
            expected *= about(Vector3::z(), angle);
            expected *= Pose::translation(0.0, 0.0, offset);
        }
        expected *= Pose::translation(0.0, 0.0, 0.107);
        expected *= about(Vector3::z(), -std::f64::consts::FRAC_PI_4);
        // Some thirty products of lengths of about a metre: a few roundings.
        assert!(Se3::default().distance(&robot.chain.forward(&q), &expected) < 1e-14);
    }
}

const MIXED: &str = r#"<robot name="mixed">
  <link name="world"/><link name="rail"/><link name="mast"/><link name="hand"/><link name="tip"/>
  <joint name="slide" type="prismatic"><origin xyz="0 0 1"/><parent link="world"/><child link="rail"/>
    <axis xyz="2 0 0"/><limit lower="-1" upper="1" effort="1" velocity="0.5"/></joint>
  <joint name="spin" type="continuous"><origin xyz="0.2 0 0" rpy="0 0 1.5707963267948966"/><parent link="rail"/><child link="mast"/>
    <axis xyz="0 0 1"/><limit effort="1" velocity="2"/></joint>
  <joint name="bolt" type="fixed"><origin xyz="0.5 0 0"/><parent link="mast"/><child link="hand"/></joint>
  <joint name="gripper" type="MIMICKED"><parent link="hand"/><child link="tip"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/>EXTRA</joint>
</robot>"#;
const MIXED_SETTINGS: &str = "base_frame: world
tool_frame: hand
joints:
  slide: {acceleration_m_s2: 1.0, jerk_m_s3: 10.0, upper_m: 0.75}
  spin: {acceleration_rad_s2: 3.0, jerk_rad_s3: 30.0}
";

fn mixed(kind: &str, extra: &str) -> String {
    MIXED.replace("MIMICKED", kind).replace("EXTRA", extra)
}

/// By hand: slide by 0.3 along x, spin by a quarter turn on top of the mounting's quarter turn; the hand points along −x.
#[test]
fn prismatic_continuous_and_fixed_joints_compose() {
    let robot = Robot::from_urdf(&mixed("revolute", ""), MIXED_SETTINGS).unwrap();
    assert_eq!(robot.chain.joint_names(), ["slide", "spin"]);
    let pose = robot.chain.forward(&DVector::from_column_slice(&[0.3, std::f64::consts::FRAC_PI_2]));
    let expected = pose_from_xyzw([0.3 + 0.2 - 0.5, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]).unwrap();
    assert!(Se3::default().distance(&pose, &expected) < 1e-15);
    assert_eq!((robot.limits.lower[0], robot.limits.upper[0], robot.limits.upper[1]), (-1.0, 0.75, f64::INFINITY));
}

/// The chain of `MIXED` written by hand: the slide along x, the spin about z through (0.2, 0, 1), the hand 0.5 m along y.
#[test]
fn a_chain_of_space_screws_is_that_of_the_urdf() {
    let joints = |axis: Vector3<f64>| {
        let through = Vector3::new(0.2, 0.0, 1.0);
        let slide = ("slide".to_owned(), Twist::new(Vector3::x(), Vector3::zeros()));
        vec![slide, ("spin".to_owned(), Twist::new(through.cross(&axis), axis))]
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let hand = pose_from_xyzw([0.2, 0.5, 1.0], [0.0, 0.0, half, half]).unwrap();
    let chain = Chain::from_space_screws(joints(Vector3::z()), hand).unwrap();
    let robot = Robot::from_urdf(&mixed("revolute", ""), MIXED_SETTINGS).unwrap();
    for q in [[0.0, 0.0], [0.3, 1.1], [-0.8, -2.5]].map(|q| DVector::from_column_slice(&q)) {
        // Lengths of about a metre and a few products: a few roundings.
        assert!(Se3::default().distance(&chain.forward(&q), &robot.chain.forward(&q)) < 1e-14);
        assert!((chain.body_jacobian(&q) - robot.chain.body_jacobian(&q)).amax() < 1e-14);
    }
    let refusal = |joints, pose| Chain::from_space_screws(joints, pose).unwrap_err();
    assert_eq!(refusal(vec![], hand), ManipulatorError::NoJoints);
    for wrong in [Vector3::z() * 1.001, Vector3::zeros(), Vector3::z() * f64::NAN] {
        let message = refusal(joints(wrong), hand).to_string();
        assert!(message.contains("spin") && message.contains("axis"), "{message}");
    }
    let nowhere = Pose::translation(f64::NAN, 0.0, 0.0);
    assert!(matches!(refusal(joints(Vector3::z()), nowhere), ManipulatorError::NonFinite { .. }));
}

#[test]
fn moving_the_base_moves_the_tool() {
    let ((g, mounted), robot) = (mounted_ur5e(), ur5e());
    let mut random = Random(5);
    for _ in 0..50 {
        let q = random_configuration(&robot, 3.0, &mut random);
        let expected: Pose = g * robot.chain.forward(&q);
        // Lengths of about a metre and a dozen products: a few roundings.
        assert!(Se3::default().distance(&mounted.chain.forward(&q), &expected) < 1e-14);
        assert!((mounted.chain.body_jacobian(&q) - robot.chain.body_jacobian(&q)).amax() < 1e-14);
    }
}

#[test]
fn what_is_no_serial_chain_is_refused_by_name() {
    let hand_is_tip = MIXED_SETTINGS.replace("tool_frame: hand", "tool_frame: tip");
    let refusal = |urdf: &str, settings: &str| Robot::from_urdf(urdf, settings).unwrap_err().to_string();
    let good = mixed("revolute", "");
    for (urdf, settings, named) in [
        (mixed("planar", ""), hand_is_tip.as_str(), vec!["gripper", "planar"]),
        (mixed("floating", ""), &hand_is_tip, vec!["gripper", "floating"]),
        (mixed("revolute", r#"<mimic joint="spin"/>"#), &hand_is_tip, vec!["gripper", "mimic", "spin"]),
        (good.clone(), &hand_is_tip, vec!["gripper", "acceleration and jerk"]),
        (good.clone(), &MIXED_SETTINGS.replace("hand", "foot"), vec!["foot"]),
        (good.clone(), &MIXED_SETTINGS.replace("base_frame: world", "base_frame: tip"), vec!["tip", "hand"]),
        (good.clone(), &MIXED_SETTINGS.replace("jerk_m_s3", "jolt"), vec!["jolt"]),
        (good.clone(), &MIXED_SETTINGS.replace("jerk_m_s3", "jerk_rad_s3"), vec!["slide", "slides", "jerk_m_s3"]),
        (good.clone(), &MIXED_SETTINGS.replace(", jerk_m_s3: 10.0", ""), vec!["jerk"]),
        (good.clone(), &MIXED_SETTINGS.replace("slide", "slid"), vec!["slid"]),
        (good.clone(), &MIXED_SETTINGS.replace("jerk_m_s3: 10.0", "jerk_m_s3: -1.0"), vec!["slide", "jerk", "-1"]),
        (good.clone(), &MIXED_SETTINGS.replace("jerk_m_s3: 10.0", "jerk_m_s3: .nan"), vec!["slide", "jerk", "NaN"]),
        (good.replace(r#"velocity="0.5""#, r#"velocity="0""#), MIXED_SETTINGS, vec!["slide", "velocity"]),
        (good.replace(r#"<limit lower="-1" upper="1" effort="1" velocity="0.5"/>"#, ""), MIXED_SETTINGS, vec!["slide"]),
        (good.replace(r#"xyz="2 0 0""#, r#"xyz="0 0 0""#), MIXED_SETTINGS, vec!["slide", "axis"]),
        (good.replace(r#"xyz="0 0 1""#, r#"xyz="0 nan 1""#), MIXED_SETTINGS, vec!["slide", "origin"]),
        (good.replace("</robot>", ""), MIXED_SETTINGS, vec!["URDF"]),
        (String::new(), MIXED_SETTINGS, vec!["URDF"]),
        (good.clone(), "joints: 3", vec!["settings"]),
    ] {
        let message = refusal(&urdf, settings);
        assert!(!message.contains('\n'), "{message}");
        for name in named {
            assert!(message.contains(name), "{name:?} is not in {message:?}");
        }
    }
}
