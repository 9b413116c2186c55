//! What every arm promises, asked of a fake one, of MuJoCo and of Dynamixel servos.
#![allow(clippy::unwrap_used, missing_docs)]

mod support;

use dynamixel_hil::emulator::Connection;
use dynamixel_hil::planner::manipulator::JointTrajectory;
use dynamixel_hil::planner::{Arm, ArmLost, Controller, Present, Refused};
use mujoco_sim::MujocoArm;
use support::{Lockstep, START, elsewhere, robot, swing};

const PERIOD_S: f64 = 0.005;

/// An arm under test, and how exactly it follows.
trait Subject {
    fn arm(&mut self) -> &mut dyn Arm;
    fn step(&mut self) -> Present;
    /// How far a joint may be from where it is to be, in rad.
    fn tolerance_rad(&self) -> f64;
    /// Breaks something; the words that tell of it. `None` for what cannot break.
    fn injure(&mut self) -> Option<&'static str> {
        None
    }
    fn heal(&mut self) {}
}

/// Is always where it is to be.
struct Fake {
    controller: Controller,
    now_s: f64,
}

impl Arm for Fake {
    fn joint_names(&self) -> &[String] {
        self.controller.robot().chain.joint_names()
    }

    fn run(&mut self, until_s: f64) -> Result<(), ArmLost> {
        self.now_s = until_s;
        Ok(())
    }

    fn play(&mut self, starts_at_s: Option<f64>, trajectory: JointTrajectory) -> Result<u64, Refused> {
        self.controller.play(self.now_s, starts_at_s, trajectory)
    }

    fn stop(&mut self) {
        self.controller.stop(self.now_s);
    }

    fn present(&self) -> Present {
        let [position, velocity, _] = self.controller.at(self.now_s).map(|values| values.as_slice().to_vec());
        self.controller.present(self.now_s, position, velocity)
    }
}

/// An arm whose time passes when it is told to.
struct Stepped<A> {
    arm: A,
    steps: u64,
    tolerance_rad: f64,
}

impl<A: Arm> Subject for Stepped<A> {
    fn arm(&mut self) -> &mut dyn Arm {
        &mut self.arm
    }

    fn step(&mut self) -> Present {
        self.steps += 1;
        self.arm.run(self.steps as f64 * PERIOD_S).unwrap();
        self.arm.present()
    }

    fn tolerance_rad(&self) -> f64 {
        self.tolerance_rad
    }
}

impl Subject for Lockstep {
    fn arm(&mut self) -> &mut dyn Arm {
        &mut self.arm
    }

    fn step(&mut self) -> Present {
        Lockstep::step(self)
    }

    /// Friction of up to 0.02 of the stall torque shifts a joint by 0.02/4.6 rad; a pulse is 0.0015 rad; what a step of 5 ms and the
    /// exchange within it shift at 2 rad/s is 0.01 rad.
    fn tolerance_rad(&self) -> f64 {
        0.03
    }

    fn injure(&mut self) -> Option<&'static str> {
        self.simulation.with_bus(|bus| bus.faults_mut().servos[5].connection = Connection::NoData);
        Some("servo 6 (forearm_roll) does not answer")
    }

    fn heal(&mut self) {
        self.simulation.with_bus(|bus| bus.faults_mut().servos[5].connection = Connection::Whole);
    }
}

#[test]
fn a_fake_arm_keeps_the_contract() {
    let controller = Controller::at_rest(robot(), &START);
    keeps_the_contract(Stepped { arm: Fake { controller, now_s: 0.0 }, steps: 0, tolerance_rad: 1e-12 });
}

#[test]
fn the_mujoco_arm_keeps_the_contract() {
    let arm = MujocoArm::new("vx300s", robot(), &START).unwrap();
    keeps_the_contract(Stepped { arm, steps: 0, tolerance_rad: 0.005 });
}

#[test]
fn the_dynamixel_arm_keeps_the_contract() {
    keeps_the_contract(Lockstep::new());
}

fn keeps_the_contract(mut subject: impl Subject) {
    stands_where_it_says(&mut subject);
    refuses_jumps(&mut subject);
    executes_and_holds(&mut subject);
    stops_smoothly(&mut subject);
    tells_of_faults(&mut subject);
}

fn steps(subject: &mut impl Subject, seconds: f64) -> Vec<Present> {
    (0..(seconds / PERIOD_S).ceil() as usize).map(|_| subject.step()).collect()
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn stands_where_it_says(subject: &mut impl Subject) {
    assert_eq!(subject.arm().joint_names(), robot().chain.joint_names());
    let present = steps(subject, 0.2).pop().unwrap();
    assert!(farthest(&present.position, &START) < subject.tolerance_rad(), "{:?}", present.position);
    assert_eq!((present.fault, present.desired[1].clone()), (None, vec![0.0; 6]));
    // Whole steps of a simulation may end a little earlier.
    assert!((present.now_s - 0.2).abs() < PERIOD_S && present.ends_at_s <= present.now_s);
}

fn refuses_jumps(subject: &mut impl Subject) {
    let before = subject.arm().present();
    let away = elsewhere(&before.goal);
    let refused = subject.arm().play(None, swing(&away, &before.goal)).unwrap_err();
    assert!(matches!(&refused, Refused::Goal(why) if why.contains("would begin with a jump")), "{refused}");
    let mut nameless = swing(&before.goal, &away);
    nameless.joint_names[0] = "nobody".into();
    assert!(matches!(subject.arm().play(None, nameless), Err(Refused::Joints(_))));
    let after = subject.step();
    assert_eq!((after.number, after.goal), (before.number, before.goal));
}

fn executes_and_holds(subject: &mut impl Subject) {
    let from = subject.arm().present().goal;
    let to = elsewhere(&from);
    let trajectory = swing(&from, &to);
    let number = subject.arm().play(None, trajectory.clone()).unwrap();
    let presents = steps(subject, trajectory.duration_s() + 0.5);
    let tolerance = subject.tolerance_rad();
    for present in &presents {
        let off = farthest(&present.position, &present.desired[0]);
        assert!(off <= tolerance && present.number == number && present.fault.is_none(), "{off} at {}", present.now_s);
    }
    // The middle of the motion was on its path, and not at either end.
    let middle = &presents[presents.len() / 3];
    assert!(farthest(&middle.position, &from) > 0.1 && farthest(&middle.position, &to) > 0.1);
    assert!(farthest(&presents.last().unwrap().position, &to) < tolerance);
}

fn stops_smoothly(subject: &mut impl Subject) {
    let from = subject.arm().present().goal;
    let back: Vec<f64> = START.to_vec();
    let trajectory = swing(&from, &back);
    subject.arm().play(None, trajectory.clone()).unwrap();
    let mut presents = steps(subject, 0.5 * trajectory.duration_s());
    subject.arm().stop();
    presents.extend(steps(subject, trajectory.duration_s()));
    let limits = robot().limits;
    for pair in presents.windows(2) {
        let passed_s = pair[1].now_s - pair[0].now_s;
        for joint in 0..6 {
            let step = |order: usize| (pair[1].desired[order][joint] - pair[0].desired[order][joint]).abs() / passed_s;
            assert!(step(0) <= 1.001 * limits.velocity[joint] && step(1) <= 1.001 * limits.acceleration[joint]);
        }
        assert!(farthest(&pair[1].position, &pair[1].desired[0]) <= subject.tolerance_rad());
    }
    let last = presents.last().unwrap();
    assert!(last.ends_at_s < last.now_s && last.desired[1] == vec![0.0; 6]);
    assert!(farthest(&last.goal, &back) > 0.05, "it stopped short of its goal");
    // And on the path: all joints have gone the same part of their way.
    let parts: Vec<f64> = (0..6).map(|j| (last.goal[j] - from[j]) / (back[j] - from[j])).collect();
    assert!(parts.iter().all(|part| (part - parts[0]).abs() < 0.01), "{parts:?}");
}

fn tells_of_faults(subject: &mut impl Subject) {
    let from = subject.arm().present().goal;
    subject.arm().play(None, swing(&from, &elsewhere(&from))).unwrap();
    steps(subject, 0.3);
    let Some(words) = subject.injure() else {
        assert_eq!(subject.arm().recover(), Ok(()));
        return;
    };
    let presents = steps(subject, 2.0);
    let last = presents.last().unwrap();
    assert_eq!(last.fault.as_deref(), Some(words));
    assert!(last.desired[1] == vec![0.0; 6]);
    let here = swing(&last.goal, &from);
    let refused = subject.arm().play(None, here).unwrap_err();
    assert_eq!(refused, Refused::Faulty(words.into()));
    assert!(matches!(subject.arm().recover(), Err(Refused::Faulty(why)) if why == words));
    subject.heal();
    let stood = subject.step().position;
    assert_eq!(subject.arm().recover(), Ok(()));
    let present = steps(subject, 0.5).pop().unwrap();
    assert_eq!(present.fault, None);
    let fell = farthest(&present.position, &stood);
    assert!(fell < 2.0 * subject.tolerance_rad(), "it goes on from where its joints are, {fell}");
    let there = present.goal.clone();
    subject.arm().play(None, swing(&there, &START)).unwrap();
    let arrived = steps(subject, 3.0).pop().unwrap();
    assert!(farthest(&arrived.position, &START) < subject.tolerance_rad());
}
