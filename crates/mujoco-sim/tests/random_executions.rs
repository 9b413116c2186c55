//! Random pose sets all over the workspace, planned and executed: the arm follows, the tool is at every pose when it should be, and
//! the torques are those predicted. `cargo xtask soak executions 50` runs fifty an arm, the tests a seeded sample.
// Helpers of tests are not seen as tests.
#![allow(clippy::unwrap_used)]

#[path = "support/oracle.rs"]
mod oracle;
#[path = "../../planner/tests/support/mod.rs"]
mod support;

use mujoco_rs::prelude::MjModel;
use mujoco_sim::planner::manipulator::nalgebra::DVector;
use mujoco_sim::planner::manipulator::{Dynamics, JointTrajectory, Robot};
use mujoco_sim::planner::{Plan, plan};
use mujoco_sim::{ExecuteOptions, Execution, SimulatedArm, TOOL_SITE, model_file, read_dynamics};
use oracle::{Oracle, ours};
use support::pose_sets::PoseSet;

const SAMPLE: usize = 2;

#[test]
fn the_ur5e_executes_random_plans() {
    assert_executes_random_plans("ur5e");
}

#[test]
fn the_viperx_executes_random_plans() {
    assert_executes_random_plans("vx300s");
}

#[test]
fn the_panda_executes_random_plans() {
    assert_executes_random_plans("panda");
}

/// As far as wanted: executed without a contact. Random configurations may well lie in the arm itself or in the ground; runs that
/// touch something are judged until then, and do not count.
fn assert_executes_random_plans(name: &str) {
    let wanted = std::env::var("REORDER_SOAK_CASES").ok().map_or(SAMPLE, |n| n.parse().unwrap());
    let mut bench = Bench::of(name);
    let (mut executed, mut refused, mut worst) = (0, 0, Figures::default());
    let (mut contacts, mut faults) = (Vec::new(), Vec::new());
    for seed in 0.. {
        if executed == wanted {
            break;
        }
        assert!(refused + contacts.len() <= 4 * wanted + 8, "too few are executed to say anything: {contacts:?}");
        let set = PoseSet::draw(&bench.robot, seed);
        let Ok(plan) = plan(&bench.robot, &set.config(), &set.request) else {
            refused += 1;
            continue;
        };
        let every_step = ExecuteOptions { sample_rate_hz: 1e4, ..ExecuteOptions::default() };
        let execution = bench.arm.execute(&plan.trajectory, &every_step).unwrap();
        match execution.contacts.first() {
            Some(contact) => {
                let (bodies, from_s) = (contact.bodies.join(" on "), contact.from_s);
                contacts.push(format!("{seed}: {bodies} at {from_s:.2} s"));
                if from_s == 0.0 {
                    continue;
                }
            }
            None => executed += 1,
        }
        let figures = bench.judge(&set, &plan, &execution);
        if !figures.hold() {
            faults.push(format!("{name} {seed}: {figures:?}"));
        }
        worst = worst.max(figures);
    }
    println!("| arm | executed | tracking | poses | torque: same states | executed | refused | contacts |");
    println!("|---|---|---|---|---|---|---|---|");
    let Figures { tracking_rad, pose_m, pose_rad, torque_model, torque_executed } = worst;
    println!(
        "| {name} | {executed} | {tracking_rad:.1e} rad | {pose_m:.1e} m, {pose_rad:.1e} rad | {torque_model:.1e} | {torque_executed:.1e} | {refused} | {} |",
        contacts.len()
    );
    contacts.iter().for_each(|contact| println!("{name} {contact}"));
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// An arm with the two descriptions of its dynamics: the planner's, and MuJoCo's.
struct Bench {
    robot: Robot,
    arm: SimulatedArm,
    of_model: Dynamics,
    oracle: Oracle,
}

/// The greatest errors. Torques are shares of the joint's greatest torque on the trajectory.
#[derive(Debug, Default, Clone, Copy)]
struct Figures {
    tracking_rad: f64,
    pose_m: f64,
    pose_rad: f64,
    torque_model: f64,
    torque_executed: f64,
}

impl Figures {
    fn hold(&self) -> bool {
        self.tracking_rad <= 0.01
            && self.pose_m <= 2e-3
            && self.pose_rad <= 0.02
            // Rounding of some hundred products, 1e-14 of the arm's greatest torque, at a joint with as little as 1e-5 of that.
            && self.torque_model <= 1e-9
            && self.torque_executed <= 0.01
    }

    fn max(self, other: Self) -> Self {
        Self {
            tracking_rad: self.tracking_rad.max(other.tracking_rad),
            pose_m: self.pose_m.max(other.pose_m),
            pose_rad: self.pose_rad.max(other.pose_rad),
            torque_model: self.torque_model.max(other.torque_model),
            torque_executed: self.torque_executed.max(other.torque_executed),
        }
    }
}

impl Bench {
    fn of(name: &str) -> Self {
        let (robot, file) = (Robot::shipped(name).unwrap(), model_file(name).unwrap());
        let oracle = Oracle::new(MjModel::from_xml(&file).unwrap(), robot.chain.joint_names());
        let of_model = read_dynamics(&file, TOOL_SITE).unwrap();
        Self { robot, arm: SimulatedArm::load(&file, TOOL_SITE).unwrap(), of_model, oracle }
    }

    /// The figures until something is touched, if anything is.
    fn judge(&mut self, set: &PoseSet, plan: &Plan, execution: &Execution) -> Figures {
        let until_s = execution.contacts.first().map_or(f64::INFINITY, |contact| contact.from_s);
        let free = execution.samples.iter().take_while(|sample| sample.time_s < until_s);
        let tracking_rad = free.map(|sample| (&sample.position - &sample.reference).amax()).fold(0.0, f64::max);
        let due = set.request.poses.iter().zip(&plan.pose_times_s).filter(|&(_, &time_s)| time_s < until_s);
        let (poses, times_s): (Vec<_>, Vec<f64>) = due.unzip();
        let errors = execution.pose_errors(&poses, &times_s).unwrap();
        Figures {
            tracking_rad,
            pose_m: errors.max_m,
            pose_rad: errors.max_rad,
            torque_model: self.torque_at_same_states(&plan.trajectory),
            torque_executed: self.torque_of_execution(&plan.trajectory, execution, until_s),
        }
    }

    /// Our inverse dynamics of MuJoCo's model against MuJoCo's, at every published point.
    fn torque_at_same_states(&mut self, trajectory: &JointTrajectory) -> f64 {
        let mut peaks = Peaks::new(self.oracle.dof());
        for point in &trajectory.points {
            let [q, rates, accelerations, _] = trajectory.at(point.time_s);
            let state = [&q, &rates, &accelerations];
            peaks.note(&ours(&self.of_model, state), &self.oracle.torque(state));
        }
        peaks.share()
    }

    /// The robot's own dynamics on the planned motion against what the executed one needed: MuJoCo's inverse dynamics at the positions,
    /// velocities and differences of velocities that the simulated arm went through. The actuators' forces themselves say less:
    /// MuJoCo notes them at the velocity before a step, but damps with the one after it, kd·q̈·h = 400 N m s·5 rad/s²·2 ms = 4 N m away.
    fn torque_of_execution(&mut self, trajectory: &JointTrajectory, execution: &Execution, until_s: f64) -> f64 {
        let dynamics = self.robot.dynamics.as_ref().unwrap();
        let mut peaks = Peaks::new(self.oracle.dof());
        for step in execution.samples.windows(2) {
            let [now, after] = [&step[0], &step[1]];
            if after.time_s > execution.duration_s.min(until_s) {
                break;
            }
            // MuJoCo moves a joint over a step with the velocity at its end, so that velocities are those of half a step earlier.
            let velocity = (&now.velocity + &after.velocity) * 0.5;
            let acceleration = (&after.velocity - &now.velocity) / (after.time_s - now.time_s);
            let needed = self.oracle.torque([&now.position, &velocity, &acceleration]);
            let [q, rates, accelerations, _] = trajectory.at(now.time_s);
            peaks.note(&ours(dynamics, [&q, &rates, &accelerations]), &needed);
        }
        peaks.share()
    }
}

/// Joint by joint, the greatest difference and the greatest torque.
struct Peaks {
    apart: DVector<f64>,
    torque: DVector<f64>,
}

impl Peaks {
    fn new(dof: usize) -> Self {
        Self { apart: DVector::zeros(dof), torque: DVector::zeros(dof) }
    }

    fn note(&mut self, predicted: &DVector<f64>, needed: &DVector<f64>) {
        let apart = predicted - needed;
        assert!(apart.iter().all(|apart| apart.is_finite()), "{predicted} for {needed}");
        self.apart.zip_apply(&apart, |worst, apart| *worst = worst.max(apart.abs()));
        self.torque.zip_apply(needed, |peak, torque| *peak = peak.max(torque.abs()));
    }

    /// The greatest difference as a share of that joint's greatest torque.
    fn share(&self) -> f64 {
        assert!(self.torque.min() > 0.0, "no joint is without its own weight and inertia: {}", self.torque);
        self.apart.component_div(&self.torque).max()
    }
}
