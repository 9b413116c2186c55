//! Inertias from descriptions: what is read, lumped, absent, refused.
#![allow(clippy::unwrap_used)]

use manipulator::nalgebra::{DVector, Vector3};
use manipulator::{ManipulatorError, Robot};

const PANDA_URDF: &str = include_str!("../../../config/robots/panda.urdf");
const PANDA_SETTINGS: &str = include_str!("../../../config/robots/panda.yaml");

fn holding(robot: &Robot, q: &DVector<f64>) -> DVector<f64> {
    let mut torque = DVector::from_element(q.len(), f64::NAN);
    let rest = vec![0.0; q.len()];
    robot.dynamics.as_ref().unwrap().torque(q.as_slice(), &rest, &rest, torque.as_mut_slice());
    torque
}

fn configuration() -> DVector<f64> {
    DVector::from_fn(7, |j, _| (3.0 * j as f64 + 1.0).sin())
}

/// By virtual work: the weight w of a mass at c of the tool frame adds −Jᵥᵀ·w, with Jᵥ that of the point c.
#[test]
fn a_payload_hangs_at_the_tool() {
    let settings = format!("payload: {{ mass_kg: 2.5, center_of_mass_m: [0.1, -0.05, 0.2] }}\n{PANDA_SETTINGS}");
    let (bare, loaded) = (Robot::shipped("panda").unwrap(), Robot::shipped_with("panda", &settings).unwrap());
    let q = configuration();
    let added = holding(&loaded, &q) - holding(&bare, &q);
    let pose = bare.chain.forward(&q);
    let weight = pose.rotation.inverse() * Vector3::new(0.0, 0.0, -9.81 * 2.5);
    let center = Vector3::new(0.1, -0.05, 0.2);
    for (joint, column) in bare.chain.body_jacobian(&q).column_iter().enumerate() {
        let (linear, angular) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
        let expected = -weight.dot(&(linear + angular.cross(&center)));
        assert!((added[joint] - expected).abs() < 1e-12, "joint {joint}: {} for {expected}", added[joint]);
    }
    assert!(added.amax() > 1.0);
}

#[test]
fn gravity_points_where_the_settings_say() {
    let q = configuration();
    let with = |gravity: &str| {
        holding(&Robot::shipped_with("panda", &format!("gravity_m_s2: {gravity}\n{PANDA_SETTINGS}")).unwrap(), &q)
    };
    let usual = holding(&Robot::shipped("panda").unwrap(), &q);
    assert_eq!(usual, with("[0, 0, -9.81]"));
    assert!((with("[0, 0, 9.81]") + &usual).amax() < 1e-12 && with("[0, 0, 0]").amax() == 0.0);
    // The first axis is vertical: only gravity from the side loads it.
    assert!(usual[0].abs() < 1e-12 && with("[9.81, 0, 0]")[0].abs() > 0.1);
    let refused = Robot::shipped_with("panda", &format!("gravity_m_s2: [0, 0, .nan]\n{PANDA_SETTINGS}"));
    assert!(matches!(refused, Err(ManipulatorError::NonFinite { what: "gravity" })));
}

#[test]
fn bodies_on_fixed_joints_count_with_what_carries_them() {
    let q = configuration();
    // The same body once in the link that moves, once in one bolted to it 0.107 m farther along z.
    let body = |link: &str, z: f64| {
        let inertial = format!(
            r#"<link name="{link}"><inertial><origin xyz="0.02 0 {z}" rpy="0.3 0 0"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.15"/></inertial></link>"#
        );
        let bare = format!(r#"<link name="{link}"/>"#);
        assert!(PANDA_URDF.contains(&bare), "{link}");
        holding(&Robot::from_urdf(&PANDA_URDF.replace(&bare, &inertial), PANDA_SETTINGS).unwrap(), &q)
    };
    let bare = holding(&Robot::shipped("panda").unwrap(), &q);
    let on_flange = body("panda_link8", 0.05);
    assert!((&on_flange - &bare).amax() > 1.0);
    let turned = PANDA_URDF.replace(r#"xyz="0 0 0" rpy="0 0 -0.7853981633974483""#, r#"xyz="0 0 0" rpy="0 0 0""#);
    assert_ne!(turned, PANDA_URDF);
    // On panda_hand, which stands an eighth of a turn about z, the same body lies elsewhere; unturned, in the same place.
    assert!((body("panda_hand", 0.05) - &on_flange).amax() > 1e-3);
    let inertial = r#"<link name="panda_hand"><inertial><origin xyz="0.02 0 0.05" rpy="0.3 0 0"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.15"/></inertial></link>"#;
    let unturned = turned.replace(r#"<link name="panda_hand"/>"#, inertial);
    let unturned = Robot::from_urdf(&unturned, PANDA_SETTINGS).unwrap();
    assert!((holding(&unturned, &q) - &on_flange).amax() < 1e-12);
}

#[test]
fn without_inertials_there_are_no_dynamics() {
    let mut urdf = PANDA_URDF.to_owned();
    while let (Some(from), Some(to)) = (urdf.find("<inertial>"), urdf.find("</inertial>")) {
        urdf.replace_range(from..to + "</inertial>".len(), "");
    }
    assert!(Robot::from_urdf(&urdf, PANDA_SETTINGS).unwrap().dynamics.is_none());
}

#[test]
fn impossible_inertias_are_refused_by_name() {
    for (good, bad) in [(r#"mass value="3.228604""#, r#"mass value="-3""#), (r#"ixx="0.037242""#, r#"ixx="-1""#)] {
        assert!(PANDA_URDF.contains(good));
        match Robot::from_urdf(&PANDA_URDF.replace(good, bad), PANDA_SETTINGS) {
            Err(ManipulatorError::LinkInertia { link, .. }) => assert_eq!(link, "panda_link3"),
            other => panic!("{other:?}"),
        }
    }
    let drive = PANDA_SETTINGS.replacen("rotor_inertia_kg_m2: 0.1", "rotor_inertia_kg_m2: -0.1", 1);
    let refused = Robot::shipped_with("panda", &drive).unwrap_err().to_string();
    assert!(refused.contains("panda_joint1") && refused.contains("rotor inertia"), "{refused}");
    let payload = format!("payload: {{ mass_kg: -1 }}\n{PANDA_SETTINGS}");
    let refused = Robot::shipped_with("panda", &payload).unwrap_err().to_string();
    assert!(refused.contains("payload") && refused.contains("negative"), "{refused}");
}
