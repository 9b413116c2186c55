//! Seeded numbers and paths for the tests of this crate.
#![allow(dead_code, clippy::unwrap_used)]

pub(crate) mod curves;
pub(crate) mod sound;

use manipulator::nalgebra::DVector;
use manipulator::{EndDerivatives, JointPath, Robot};
use se3_geom::{Pose, pose_from_xyzw};

/// SplitMix64 (Steele, Lea, Flood 2014): a few lines, the same everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

pub(crate) fn ur5e() -> Robot {
    Robot::shipped("ur5e").unwrap()
}

/// A pose of the base of a UR5e in a room, and that robot, whose base frame is the room's.
pub(crate) fn mounted_ur5e() -> (Pose, Robot) {
    let g = pose_from_xyzw([0.4, -0.3, 0.9], [0.5, 0.5, -0.5, 0.5]).unwrap();
    let (roll, pitch, yaw) = g.rotation.euler_angles();
    let mount = format!(
        r#"<link name="room"/><joint name="mount" type="fixed"><origin xyz="0.4 -0.3 0.9" rpy="{roll} {pitch} {yaw}"/>
           <parent link="room"/><child link="base_link"/></joint><link name="base_link"/>"#
    );
    let urdf = include_str!("../../../../config/robots/ur5e.urdf").replace(r#"<link name="base_link"/>"#, &mount);
    let settings = include_str!("../../../../config/robots/ur5e.yaml").replace("base_link", "room");
    (g, Robot::from_urdf(&urdf, &settings).unwrap())
}

/// A random configuration, each joint within `half_range` of the middle of its limits.
pub(crate) fn random_configuration(robot: &Robot, half_range: f64, random: &mut Random) -> DVector<f64> {
    DVector::from_fn(robot.chain.dof(), |_, _| random.between(-half_range, half_range))
}

/// A random configuration in the middle `part` of the joint ranges, at most a turn of each.
pub(crate) fn configuration_within(robot: &Robot, part: f64, random: &mut Random) -> DVector<f64> {
    DVector::from_fn(robot.chain.dof(), |joint, _| {
        let (lower, upper) = (robot.limits.lower[joint], robot.limits.upper[joint]);
        let half = (0.5 * (upper - lower)).min(std::f64::consts::PI);
        0.5 * (lower + upper) + part * half * random.between(-1.0, 1.0)
    })
}

/// A smooth random path: every joint a sum of three sines of random phase and up to `waves` periods, sampled at `samples` parameters.
pub(crate) fn random_path(robot: &Robot, waves: f64, samples: usize, random: &mut Random) -> JointPath {
    let dof = robot.chain.dof();
    let terms: Vec<[f64; 3]> = (0..3 * dof)
        .map(|_| [random.between(0.1, 0.6), random.between(0.2, 1.0) * waves, random.between(0.0, 6.0)])
        .collect();
    let value = |s: f64, order: i32| {
        DVector::from_fn(dof, |joint, _| {
            terms[3 * joint..3 * joint + 3]
                .iter()
                .map(|[size, periods, phase]| {
                    let rate = std::f64::consts::TAU * periods;
                    let argument = rate * s + phase + std::f64::consts::FRAC_PI_2 * f64::from(order);
                    size * rate.powi(order) * argument.sin()
                })
                .sum()
        })
    };
    let parameters: Vec<f64> = (0..samples).map(|i| i as f64 / (samples - 1) as f64).collect();
    let values: Vec<_> = parameters.iter().map(|&s| value(s, 0)).collect();
    let end = |s: f64| EndDerivatives { first: value(s, 1), second: value(s, 2) };
    JointPath::through(&parameters, &values, [&end(0.0), &end(1.0)]).unwrap()
}
