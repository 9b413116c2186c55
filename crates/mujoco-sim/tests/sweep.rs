//! What a sweep of a trajectory finds, and what it must not miss.
#![allow(clippy::unwrap_used)]

mod support;

use std::fs;
use std::path::Path;

use mujoco_sim::planner::manipulator::{JointPoint, JointTrajectory, Robot};
use mujoco_sim::{SimError, SimulatedArm, Sweep, SweepOptions, TOOL_SITE, model_file};
use support::{FOLDED, HOME, quintic_move, ur5e};

fn sweep(arm: &mut SimulatedArm, trajectory: &JointTrajectory) -> Sweep {
    arm.sweep(trajectory, &SweepOptions::default()).unwrap()
}

fn sorted(bodies: &[String; 2]) -> [&str; 2] {
    let mut names = bodies.each_ref().map(String::as_str);
    names.sort_unstable();
    names
}

/// The UR5e with something else in its world.
fn ur5e_with(test: &str, geom: &str) -> SimulatedArm {
    let text = fs::read_to_string(model_file("ur5e").unwrap()).unwrap();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test).with_extension("xml");
    assert!(text.contains("<worldbody>"));
    fs::write(&path, text.replace("<worldbody>", &format!("<worldbody>{geom}"))).unwrap();
    SimulatedArm::load(path, TOOL_SITE).unwrap()
}

#[test]
fn an_arm_that_folds_into_itself_is_caught_when_it_does() {
    let mut arm = ur5e();
    let trajectory = quintic_move(HOME, FOLDED, 2.0);
    let found = sweep(&mut arm, &trajectory);
    let first = found.contacts.first().expect("its wrist ends in its upper arm");
    assert_eq!(sorted(&first.bodies), ["upper_arm_link", "wrist_2_link"]);
    assert!(first.from_s > 0.5 && first.until_s == 2.0 && first.depth_max_m > 0.01, "{first:?}");
    let mut touch = |time_s: f64| !arm.touches(trajectory.at(time_s)[0].as_slice()).unwrap().is_empty();
    // A check is at most 5 mm of way before or after.
    assert!(touch(first.from_s) && !touch(first.from_s - 0.01));
    let near = found.approaches.first().expect("and comes near to it before");
    assert!(near.from_s < first.from_s && near.from_s > first.from_s - 0.1, "{near:?}");
}

#[test]
fn every_shipped_arm_has_shapes_and_can_hit_itself() {
    // From home into a pose in which the arm is bent onto its own foot.
    let folded: [(&str, Vec<f64>); 2] =
        [("vx300s", vec![0.0, -1.85, 1.6, 0.0, 1.8, 0.0]), ("panda", vec![0.0, -1.7, 0.0, -3.07, 0.0, 0.0, 0.785])];
    for (name, goal) in folded {
        let robot = Robot::shipped(name).unwrap();
        let mut arm = SimulatedArm::load(model_file(name).unwrap(), TOOL_SITE).unwrap();
        let at_rest = |time_s: f64, q: &[f64]| JointPoint {
            time_s,
            positions: q.to_vec(),
            velocities: vec![0.0; q.len()],
            accelerations: vec![0.0; q.len()],
        };
        let home = robot.preferred.as_slice();
        let joint_names = robot.chain.joint_names().to_vec();
        let stay = JointTrajectory { joint_names: joint_names.clone(), points: vec![at_rest(0.0, home)] };
        assert_eq!(sweep(&mut arm, &stay).approaches, [], "{name} at home");
        let fold = JointTrajectory { joint_names, points: vec![at_rest(0.0, home), at_rest(2.0, &goal)] };
        let found = sweep(&mut arm, &fold);
        println!("{name}: {:?} in {} checks", found.contacts.first(), found.checks);
        assert!(found.contacts.first().is_some_and(|event| event.from_s > 0.2), "{name}");
    }
}

/// A post of 4 mm that the tool sweeps past at 2 rad/s: between points 10 ms apart it moves by 2 cm, so that a look at the points misses it.
#[test]
fn what_is_thinner_than_a_step_is_not_missed() {
    let mut goal = HOME;
    goal[0] += 2.0;
    let trajectory = quintic_move(HOME, goal, 1.52);
    // Where the tool passes in the middle of the move, outside of the wrist.
    let mut free = ur5e();
    let tool = free.tool_pose(trajectory.at(0.76)[0].as_slice()).unwrap().translation.vector;
    let post = format!(
        "<geom name=\"post\" type=\"box\" size=\"0.002 0.002 0.05\" pos=\"{} {} {}\"/>",
        tool.x, tool.y, tool.z
    );
    let mut arm = ur5e_with("post", &post);
    let found = sweep(&mut arm, &trajectory);
    let first = found.contacts.first().expect("the post is in the way");
    assert!(sorted(&first.bodies).contains(&"world"), "{first:?}");
    assert!((first.from_s..=first.until_s).contains(&0.76), "{first:?}");
    // Both ends are free: one look at each would find nothing.
    for end in [HOME, goal] {
        assert_eq!(arm.touches(&end).unwrap(), []);
    }
    assert_eq!(sweep(&mut free, &trajectory).approaches, []);
}

/// Against a dense grid of its own: no pair that comes within the clearance at any time is left out.
#[test]
fn nothing_nearer_than_the_clearance_is_left_out() {
    let mut arm = ur5e_with("table", "<geom name=\"table\" type=\"box\" size=\"2 2 0.01\" pos=\"0 0 -0.03\"/>");
    let mut goal = HOME;
    goal[1] += 1.2;
    goal[2] += 0.3;
    let trajectory = quintic_move(HOME, goal, 2.0);
    let found = sweep(&mut arm, &trajectory);
    let touching: Vec<f64> = (0..=2000)
        .map(|k| 1e-3 * f64::from(k))
        .filter(|&t| !arm.touches(trajectory.at(t)[0].as_slice()).unwrap().is_empty())
        .collect();
    let first = found.approaches.first().expect("the wrist ends in the table");
    assert!(!touching.is_empty() && first.from_s <= touching[0], "{first:?} {:?}", touching.first());
    // It is told from the clearance on, which at the speed of the wrist is not long before.
    assert!(touching[0] - first.from_s < 0.2, "{first:?} {}", touching[0]);
}

#[test]
fn the_sweep_is_as_fine_as_its_clearance() {
    let mut goal = HOME;
    goal[0] += 2.0;
    let trajectory = quintic_move(HOME, goal, 1.52);
    let mut arm = ur5e();
    let [coarse, fine] =
        [0.02, 0.002].map(|clearance_m| arm.sweep(&trajectory, &SweepOptions { clearance_m }).unwrap());
    // 2 rad at a reach of 0.9 m or more.
    assert!(
        coarse.checks as f64 > 2.0 * 0.9 / 0.02 && fine.checks > 9 * coarse.checks,
        "{} {}",
        coarse.checks,
        fine.checks
    );
}

#[test]
fn what_cannot_be_told_is_refused() {
    let mut arm = ur5e();
    let trajectory = quintic_move(HOME, FOLDED, 2.0);
    for clearance_m in [0.0, -1.0, f64::NAN, 1e-9, 1e3] {
        let refused = arm.sweep(&trajectory, &SweepOptions { clearance_m });
        assert!(matches!(refused, Err(SimError::InvalidOption { name: "clearance_m", .. })), "{clearance_m}");
    }
    let mut far = HOME;
    far[0] = 1e9;
    let endless = arm.sweep(&quintic_move(HOME, far, 2.0), &SweepOptions::default());
    assert!(matches!(endless, Err(SimError::TooManyChecks { .. })));

    let text = fs::read_to_string(model_file("ur5e").unwrap()).unwrap();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shapeless.xml");
    let lines = text.lines().filter(|line| !line.contains("<geom class"));
    fs::write(&path, lines.collect::<Vec<_>>().join("\n")).unwrap();
    let mut ghost = SimulatedArm::load(path, TOOL_SITE).unwrap();
    assert!(matches!(ghost.sweep(&trajectory, &SweepOptions::default()), Err(SimError::NoShapes)));
}
