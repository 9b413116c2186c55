//! Joints and the servos that move them: what a goal must be for a joint to be where it is to be, and where servos say that it is.

use std::f64::consts::TAU;

use planner::manipulator::Robot;

use crate::config::Config;
use crate::register::{VELOCITY_UNIT_RAD_S, angle_rad, pulses};
use crate::servo_state::ServoState;

/// Full duty of the motor's voltage, in units of PWM.
const FULL_PWM: f64 = 885.0;
/// A unit of the Position P Gain.
const P_GAIN_UNIT: f64 = 1.0 / 128.0;
/// Servos of one joint that read positions farther apart, in rad, would press against each other: gears have a play of 0.004 rad, and
/// links that bend under half the arm's weight some 0.02.
const APART_RAD: f64 = 0.05;

/// The servos of an arm, seen as joints.
///
/// A servo's position control is proportional: the duty of its motor is the error times a gain, and torque = stall·(duty − speed/no-load
/// speed). For a torque τ at a speed v a goal must therefore lie ahead of the position by (τ + d·v)/k, with stiffness k = Σ stall·gain
/// and damping d = Σ stall/no-load speed over the servos of the joint.
pub(crate) struct Joints {
    robot: Robot,
    servos: Vec<Seat>,
    /// By joint.
    stiffness_n_m: Vec<f64>,
    damping_n_m_s: Vec<f64>,
    torque: Vec<f64>,
}

/// What a servo moves.
struct Seat {
    joint: Option<usize>,
    offset_rad: f64,
}

impl Joints {
    pub(crate) fn new(config: &Config, robot: Robot) -> Self {
        let names = robot.chain.joint_names();
        let place = |name: &String| names.iter().position(|other| other == name);
        let servos: Vec<Seat> = config
            .servos
            .iter()
            .map(|servo| Seat { joint: servo.joint.as_ref().and_then(place), offset_rad: servo.offset_rad })
            .collect();
        let duty_per_rad = f64::from(config.position_p_gain) * P_GAIN_UNIT * (4096.0 / TAU) / FULL_PWM;
        let (mut stiffness_n_m, mut damping_n_m_s) = (vec![0.0; names.len()], vec![0.0; names.len()]);
        for (servo, seat) in config.servos.iter().zip(&servos) {
            if let Some(joint) = seat.joint {
                let motor = servo.model.datasheet();
                stiffness_n_m[joint] += motor.stall_torque_n_m * duty_per_rad;
                damping_n_m_s[joint] += motor.stall_torque_n_m / motor.no_load_speed_rad_s;
            }
        }
        let torque = vec![0.0; names.len()];
        Self { robot, servos, stiffness_n_m, damping_n_m_s, torque }
    }

    /// The place of the first servo that moves a joint.
    pub(crate) fn servo_of(&self, joint: usize) -> usize {
        self.servos.iter().position(|seat| seat.joint == Some(joint)).unwrap_or_default()
    }

    /// Goal Position of every servo for a desired position, velocity and acceleration of the joints; `held` is where those without a
    /// joint stay, as raw positions by servo. A joint goes no farther than all its servos take as goals by their `ranges` of raw positions: one
    /// that refuses would stay behind, and press against the others.
    pub(crate) fn goals(
        &mut self,
        [position, velocity, acceleration]: [&[f64]; 3],
        held: &[i32],
        ranges: &[[i32; 2]],
    ) -> Vec<u32> {
        let bounds = self.bounds(ranges);
        if let Some(dynamics) = &self.robot.dynamics {
            dynamics.torque(position, velocity, acceleration, &mut self.torque);
        }
        let goal = |(seat, held): (&Seat, &i32)| match seat.joint {
            None => *held,
            Some(j) => {
                let ahead = (self.torque[j] + self.damping_n_m_s[j] * velocity[j]) / self.stiffness_n_m[j];
                pulses((position[j] + ahead).max(bounds[j][0]).min(bounds[j][1]) - seat.offset_rad)
            }
        };
        let goals = self.servos.iter().zip(held).map(goal);
        // What rounding makes of a bound is a pulse at most.
        goals.zip(ranges).map(|(goal, [least, most])| goal.max(*least).min(*most) as u32).collect()
    }

    /// Where all servos of a joint take goals, least and most, in rad.
    fn bounds(&self, ranges: &[[i32; 2]]) -> Vec<[f64; 2]> {
        let mut bounds = vec![[f64::NEG_INFINITY, f64::INFINITY]; self.torque.len()];
        for (seat, range) in self.servos.iter().zip(ranges) {
            if let Some(joint) = seat.joint {
                let [least, most] = range.map(|raw| angle_rad(raw) + seat.offset_rad);
                bounds[joint] = [bounds[joint][0].max(least), bounds[joint][1].min(most)];
            }
        }
        bounds
    }

    /// Two servos of one joint that do not agree where it is, and by how much, in rad.
    pub(crate) fn apart(&self, states: &[ServoState]) -> Option<([usize; 2], f64)> {
        let place = |servo: usize| angle_rad(states[servo].position) + self.servos[servo].offset_rad;
        let pairs = (0..self.servos.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        let of_one_joint = |[a, b]: &[usize; 2]| {
            let [a, b] = [*a, *b].map(|servo| self.servos[servo].joint);
            a.is_some() && a == b
        };
        let gaps = pairs.filter(of_one_joint).map(|[a, b]| ([a, b], (place(a) - place(b)).abs()));
        gaps.max_by(|(_, x), (_, y)| x.total_cmp(y)).filter(|(_, by_rad)| *by_rad > APART_RAD)
    }

    /// Positions and velocities of the joints, in rad and rad/s: means over the servos of each, those without torque left out where
    /// another one has it.
    pub(crate) fn measured(&self, states: &[ServoState]) -> [Vec<f64>; 2] {
        let mean = |joint: usize, of: fn(&ServoState, &Seat) -> f64| {
            let seated = || self.servos.iter().zip(states).filter(|(seat, _)| seat.joint == Some(joint));
            let holds = seated().any(|(_, state)| state.torque);
            let counted = seated().filter(|(_, state)| state.torque || !holds);
            let (sum, count) = counted.fold((0.0, 0.0), |(sum, n), (seat, state)| (sum + of(state, seat), n + 1.0));
            sum / count
        };
        let of_all = |of| (0..self.torque.len()).map(|joint| mean(joint, of)).collect();
        [
            of_all(|state, seat| angle_rad(state.position) + seat.offset_rad),
            of_all(|state, _| f64::from(state.velocity) * VELOCITY_UNIT_RAD_S),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = include_str!("../../../config/arms/vx300s.yaml");

    /// As the factory sends servos.
    const ANY: [[i32; 2]; 9] = [[0, 4095]; 9];

    fn joints() -> Joints {
        let config = Config::from_yaml(SHIPPED).unwrap();
        let robot = config.robot().unwrap();
        Joints::new(&config, robot)
    }

    #[test]
    fn both_servos_of_a_joint_have_its_goal_and_carry_half_of_it() {
        let mut joints = joints();
        assert_eq!((joints.servo_of(1), joints.servo_of(2)), (1, 3));
        let rest = [0.0; 6];
        // Stretched out the arm weighs on the shoulder, not on the waist.
        let stretched = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
        let goals = joints.goals([&stretched, &rest, &rest], &[7; 9], &ANY);
        assert_eq!((goals[0], goals[8]), (pulses(0.5) as u32, 7));
        assert_eq!(goals[1], goals[2]);
        // It turns the shoulder down, towards positive angles: about 1.5 kg at 0.45 m on 2·10.6·4.6 N·m/rad. The goal lies above.
        let ahead_rad = angle_rad(goals[1] as i32);
        assert!((-0.12..-0.03).contains(&ahead_rad), "{ahead_rad}");
    }

    #[test]
    fn a_goal_leads_by_the_lag_of_the_servo() {
        let mut joints = joints();
        let (q, rest, moving) = ([0.0, -1.5, 1.5, 0.0, 0.0, 0.0], [0.0; 6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let standing = joints.goals([&q, &rest, &rest], &[0; 9], &ANY);
        let going = joints.goals([&q, &moving, &rest], &[0; 9], &ANY);
        // 1 rad/s at a no-load speed of 30 rev/min and 800/128·651.9/885 = 4.604 of full duty a rad.
        let lead = f64::from(going[0]) - f64::from(standing[0]);
        let expected = 1.0 / (30.0 * TAU / 60.0) / 4.604 * 4096.0 / TAU;
        assert!((lead - expected).abs() <= 1.0, "{lead} {expected}");
    }

    /// The shoulder's second servo takes less than the first: neither is told more, or they would press against each other.
    #[test]
    fn a_joint_goes_no_farther_than_any_of_its_servos() {
        let mut joints = joints();
        let mut ranges = ANY;
        (ranges[1], ranges[2]) = ([841, 2867], [900, 2800]);
        for (shoulder, expected) in [(-1.85, 900), (1.25, 2800)] {
            let q = [0.0, shoulder, 0.0, 0.0, 0.0, 0.0];
            let goals = joints.goals([&q, &[0.0; 6], &[0.0; 6]], &[0; 9], &ranges);
            assert_eq!([goals[1], goals[2]], [expected; 2], "{shoulder}");
        }
    }

    #[test]
    fn servos_of_one_joint_that_disagree_are_named() {
        let joints = joints();
        let mut states = vec![ServoState { position: 2048, ..ServoState::default() }; 9];
        states[6].position = 3000;
        assert_eq!(joints.apart(&states), None);
        states[4].position = 2048 + 40;
        let (servos, by_rad) = joints.apart(&states).unwrap();
        assert_eq!(servos, [3, 4]);
        assert!((by_rad - 40.0 * TAU / 4096.0).abs() < 1e-12);
    }

    #[test]
    fn servos_and_joints_agree_on_angles() {
        let joints = joints();
        let state = |position, velocity| ServoState { position, velocity, ..ServoState::default() };
        let mut states = vec![state(2048, 0); 9];
        (states[1], states[2]) = (state(1024, 100), state(1026, 100));
        let [position, velocity] = joints.measured(&states);
        assert!((position[1] - angle_rad(1025)).abs() < 1e-12 && position[0] == 0.0);
        assert!((velocity[1] - 100.0 * VELOCITY_UNIT_RAD_S).abs() < 1e-12);
        // The other one holds, and knows better.
        states[2].torque = true;
        assert!((joints.measured(&states)[0][1] - angle_rad(1026)).abs() < 1e-12);
    }
}
