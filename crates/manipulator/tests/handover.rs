//! Hand-overs: from a running trajectory to a stop on its path, or to another goal; no jump, no broken limit.
#![allow(clippy::unwrap_used)]

mod support;

use manipulator::nalgebra::DVector;
use manipulator::{
    EndDerivatives, JointPath, JointTrajectory, ManipulatorError, Robot, TimingOptions, audit, audit_from, audit_under,
    connect, rest_to_rest, slow_to_stop, time_path,
};
use support::{Random, random_configuration, random_path};

/// A timed random path around the configuration that the arm prefers.
fn running(robot: &Robot, random: &mut Random) -> JointTrajectory {
    running_under(robot, &TimingOptions::default(), random)
}

fn running_under(robot: &Robot, options: &TimingOptions, random: &mut Random) -> JointTrajectory {
    let around_zero = random_path(robot, 1.5, 60, random);
    let largest = around_zero.knots().iter().map(|&s| around_zero.at(s)[0].amax()).fold(0.0, f64::max);
    let nearby: Vec<_> =
        around_zero.knots().iter().map(|&s| &robot.preferred + &around_zero.at(s)[0] * (0.6 / largest)).collect();
    let none = EndDerivatives { first: DVector::zeros(robot.chain.dof()), second: DVector::zeros(robot.chain.dof()) };
    let path = JointPath::through(around_zero.knots(), &nearby, [&none, &none]).unwrap();
    time_path(robot, &path, options).unwrap().trajectory
}

/// A time of a running trajectory: that of one of its points, or any other.
fn some_time(running: &JointTrajectory, random: &mut Random) -> f64 {
    if random.unit() < 0.5 {
        running.points[(random.unit() * (running.points.len() - 1) as f64) as usize].time_s
    } else {
        (random.unit() * running.duration_s() * 1e9).round() * 1e-9
    }
}

/// What is executed in the end, judged from the first point on, and by differences of positions around the hand-over.
fn assert_taken_over(robot: &Robot, running: &JointTrajectory, at_s: f64, next: &JointTrajectory) {
    assert!(audit_from(robot, next, &running.state_at(at_s)).limits_ok);
    let executed = running.switched(at_s, next);
    let found = audit(robot, &executed);
    assert!(found.limits_ok && found.starts_and_ends_at_rest, "{found:?}");
    let [before, after] = [running.at(at_s), next.at(0.0)];
    for order in 0..3 {
        // The state is that of a point, or evaluated once: only the time's offset into its interval is rounded.
        assert!((&before[order] - &after[order]).amax() < 1e-9, "order {order} jumps at {at_s}");
    }
}

/// The greatest distance of the executed stop from the path of `running` after `at_s`, sampled four times a point.
fn distance_from_path(running: &JointTrajectory, at_s: f64, stop: &JointTrajectory) -> f64 {
    let mut passed = at_s;
    let samples = 4 * stop.points.len();
    (0..=samples).fold(0.0, |worst, k| {
        let q = stop.at(stop.duration_s() * k as f64 / samples as f64)[0].clone();
        let away = |t: f64| (&running.at(t)[0] - &q).norm();
        // The clock never runs faster than it did: the nearest place is at most one sample's time farther on.
        let (mut low, mut high) = (passed, passed + 1.01 * stop.duration_s() / samples as f64 + 1e-6);
        for _ in 0..60 {
            let [a, b] = [1.0 / 3.0, 2.0 / 3.0].map(|part| low + part * (high - low));
            if away(a) < away(b) { high = b } else { low = a }
        }
        passed = 0.5 * (low + high);
        f64::max(worst, away(passed))
    })
}

#[test]
fn a_stop_stays_on_the_path_and_within_the_limits() {
    let mut random = Random(71);
    let (mut stopped, mut cases, mut farthest) = (0, 0, 0.0_f64);
    let mut durations = Vec::new();
    for name in ["ur5e", "vx300s", "panda"] {
        let robot = Robot::shipped(name).unwrap();
        for _ in 0..3 {
            let running = running(&robot, &mut random);
            for _ in 0..3 {
                let at_s = some_time(&running, &mut random);
                let clock = std::time::Instant::now();
                let stop = slow_to_stop(&robot, &running, at_s, &TimingOptions::default()).unwrap();
                let took = clock.elapsed();
                assert_taken_over(&robot, &running, at_s, &stop);
                // Quintics through points 10 ms apart of a motion whose jerk changes by at most 2·50 rad/s³ between them
                // deviate by less than 100·0.01³/60 = 2e-6 rad a joint.
                let away = distance_from_path(&running, at_s, &stop);
                assert!(away < 5e-6, "{away} rad off the path");
                farthest = farthest.max(away);
                cases += 1;
                let left = running.duration_s() - at_s;
                println!("{name} at {at_s:.2}: {:.3} s of {left:.3} left, {took:?}", stop.duration_s());
                stopped += usize::from(stop.duration_s() < left - 1e-6);
                durations.push(stop.duration_s());
            }
        }
    }
    durations.sort_by(f64::total_cmp);
    println!(
        "{stopped} of {cases} stopped before the end, at most {farthest:.1e} rad off, median {} s",
        durations[durations.len() / 2]
    );
    assert!(2 * stopped > cases);
}

/// Per joint, the greatest torque from `at_s` on, ten times between points as the audit looks.
fn greatest_torques(robot: &Robot, trajectory: &JointTrajectory, at_s: f64) -> Vec<f64> {
    let left = trajectory.after(at_s);
    let dof = robot.chain.dof();
    let (mut torque, mut greatest) = (vec![0.0; dof], vec![0.0_f64; dof]);
    for pair in left.points.windows(2) {
        for part in 0..=10 {
            let [q, rates, accelerations, _] =
                left.at(pair[0].time_s + (pair[1].time_s - pair[0].time_s) * f64::from(part) / 10.0);
            let state = [q, rates, accelerations];
            robot.dynamics.as_ref().unwrap().torque(
                state[0].as_slice(),
                state[1].as_slice(),
                state[2].as_slice(),
                &mut torque,
            );
            greatest.iter_mut().zip(&torque).for_each(|(most, now)| *most = most.max(now.abs()));
        }
    }
    greatest
}

/// Stops are looked for under limits of velocity, acceleration and jerk alone; it is their audit that counts torques.
#[test]
fn a_stop_that_takes_more_torque_than_there_is_is_not_returned() {
    let mut random = Random(97);
    let options = TimingOptions::default();
    let mut too_hard = 0;
    for _ in 0..6 {
        let mut robot = Robot::shipped("panda").unwrap();
        robot.limits.effort.fill(1e6);
        let running = running(&robot, &mut random);
        let at_s = running.points[(running.points.len() as f64 * (0.3 + 0.4 * random.unit())) as usize].time_s;
        let hardest = slow_to_stop(&robot, &running, at_s, &options).unwrap();
        // As much as the rest of the running trajectory takes, and a thousandth more.
        let needed = greatest_torques(&robot, &running, at_s);
        robot.limits.effort.iter_mut().zip(&needed).for_each(|(effort, needed)| *effort = 1.001 * needed);
        let from = running.state_at(at_s);
        let found = audit_from(&robot, &hardest, &from);
        let stop = slow_to_stop(&robot, &running, at_s, &options).unwrap();
        let judged = audit_from(&robot, &stop, &from);
        assert!(judged.limits_ok && judged.max_ratio.torque.unwrap() <= 1.0, "{judged:?}");
        if found.max_ratio.torque.unwrap() > 1.0 {
            too_hard += 1;
            assert!(!found.limits_ok && stop != hardest);
            let ignored = slow_to_stop(&robot, &running, at_s, &TimingOptions { torque: false, ..options.clone() });
            assert_eq!(ignored.unwrap(), hardest, "torques are ignored only where that is asked for");
        }
        // Where even going on takes too much there is nothing to return.
        robot.limits.effort.iter_mut().zip(&needed).for_each(|(effort, needed)| *effort = 0.9 * needed);
        let refused = slow_to_stop(&robot, &running, at_s, &options).unwrap_err();
        let message = refused.to_string();
        let ManipulatorError::LimitsNotMet { audit, .. } = refused else { panic!("{message}") };
        let found = audit.max_ratio;
        assert!(found.torque.unwrap() > 1.0 && found.velocity <= 1.0 && found.jerk <= 1.0, "{message}");
        assert!(message.contains("a joint's torque goes") && !message.contains("velocity"), "{message}");
    }
    assert!(too_hard > 0, "no stop was too hard: the test shows nothing");
}

#[test]
fn a_hand_over_begins_in_the_state_and_ends_at_rest_at_the_goal() {
    let mut random = Random(73);
    let mut gain = Vec::new();
    for name in ["ur5e", "vx300s", "panda"] {
        let robot = Robot::shipped(name).unwrap();
        for _ in 0..2 {
            let running = running(&robot, &mut random);
            for _ in 0..3 {
                let at_s = some_time(&running, &mut random);
                let goal = &robot.preferred + random_configuration(&robot, 0.5, &mut random);
                let options = TimingOptions::default();
                let clock = std::time::Instant::now();
                let next = connect(&robot, &running, at_s, &goal, &options).unwrap();
                let took = clock.elapsed();
                assert_taken_over(&robot, &running, at_s, &next);
                assert_eq!(next.points.last().unwrap().positions, goal.as_slice());
                let stop = slow_to_stop(&robot, &running, at_s, &options).unwrap();
                let end = DVector::from_column_slice(&stop.points.last().unwrap().positions);
                let apart = stop.duration_s() + rest_to_rest(&robot, &end, &goal, &options).unwrap().duration_s();
                println!("{name} at {at_s:.2}: {:.3} s, stop and go {apart:.3} s, {took:?}", next.duration_s());
                assert!(next.duration_s() <= apart + 0.011);
                gain.push(next.duration_s() / apart);
            }
        }
    }
    gain.sort_by(f64::total_cmp);
    println!("median of stop and go {}", gain[gain.len() / 2]);
    assert!(gain[gain.len() / 2] < 0.9);
}

/// Limits of the tool are slower than those of the joints by far: a way that is legal at rest is legal after a stop.
#[test]
fn a_hand_over_keeps_the_limits_of_the_tool() {
    let mut random = Random(101);
    let cases = [
        ("ur5e", Some(0.1), None),
        ("vx300s", None, Some(0.3)),
        ("panda", Some(0.1), Some(0.3)),
        ("ur5e", None, Some(0.3)),
    ];
    for (name, tool_speed_m_s, tool_acceleration_m_s2) in cases {
        let options = TimingOptions { tool_speed_m_s, tool_acceleration_m_s2, ..TimingOptions::default() };
        let robot = Robot::shipped(name).unwrap();
        let running = running_under(&robot, &options, &mut random);
        let at_s = some_time(&running, &mut random);
        for part in [0.05, 1.0] {
            let goal = &robot.preferred + random_configuration(&robot, 0.5, &mut random) * part;
            let clock = std::time::Instant::now();
            let next = connect(&robot, &running, at_s, &goal, &options).unwrap();
            println!("{name}: {:.3} s, found in {:?}", next.duration_s(), clock.elapsed());
            assert_taken_over(&robot, &running, at_s, &next);
            let found = audit_under(&robot, &next, options.audit_rules(), Some(&running.state_at(at_s)));
            assert!(found.limits_ok, "{found:?}");
            assert_eq!(next.points.last().unwrap().positions, goal.as_slice());
        }
    }
}

/// At its last point, and at its first, a trajectory is at rest: nothing is left to stop, and a hand-over is a move from rest.
#[test]
fn at_rest_a_hand_over_is_a_move_from_rest() {
    let mut random = Random(79);
    let robot = Robot::shipped("ur5e").unwrap();
    let options = TimingOptions::default();
    let running = running(&robot, &mut random);
    for at_s in [0.0, running.duration_s()] {
        let here = running.at(at_s)[0].clone();
        let goal = &here + DVector::from_element(6, 0.1);
        let next = connect(&robot, &running, at_s, &goal, &options).unwrap();
        assert_taken_over(&robot, &running, at_s, &next);
        let straight = rest_to_rest(&robot, &here, &goal, &options).unwrap();
        if at_s > 0.0 {
            assert_eq!(slow_to_stop(&robot, &running, at_s, &options).unwrap().points.len(), 1);
            assert!((next.duration_s() - straight.duration_s()).abs() < 0.011);
            assert_eq!(connect(&robot, &running, at_s, &here, &options).unwrap().points.len(), 1);
        }
    }
}

#[test]
fn what_cannot_be_handed_over_is_named() {
    let mut random = Random(83);
    let robot = Robot::shipped("ur5e").unwrap();
    let options = TimingOptions::default();
    let running = running(&robot, &mut random);
    let middle = 0.5 * running.duration_s();
    for at_s in [-1e-9, running.duration_s() + 1e-9, f64::NAN] {
        let refused = slow_to_stop(&robot, &running, at_s, &options).unwrap_err();
        assert!(matches!(refused, ManipulatorError::NotRunning { .. }), "{refused}");
    }
    let beyond = DVector::from_element(6, 7.0);
    let refused = connect(&robot, &running, middle, &beyond, &options).unwrap_err();
    assert!(matches!(refused, ManipulatorError::BeyondLimits { .. }), "{refused}");
    let mut spoilt = running.clone();
    spoilt.points[5].velocities.pop();
    let refused = connect(&robot, &spoilt, middle, &robot.preferred, &options).unwrap_err();
    assert!(matches!(refused, ManipulatorError::NotOfRobot { .. }), "{refused}");
    let mut others = running.clone();
    others.joint_names.reverse();
    let refused = connect(&robot, &others, middle, &robot.preferred, &options).unwrap_err().to_string();
    assert!(refused.contains("the running trajectory") && refused.contains("its joints in their order"), "{refused}");
    let empty = JointTrajectory { points: Vec::new(), ..running.clone() };
    assert!(slow_to_stop(&robot, &empty, 0.0, &options).is_err());
    // Under tighter limits than it was planned for, what runs is illegal, and so is everything that begins in its state.
    let slow = TimingOptions { velocity_scale: 0.01, ..options };
    let refused = connect(&robot, &running, middle, &robot.preferred, &slow).unwrap_err();
    assert!(matches!(refused, ManipulatorError::LimitsNotMet { .. }), "{refused}");
    assert!(refused.to_string().contains("a joint's velocity goes"), "{refused}");
    // A limit of the tool that the running trajectory exceeds is named with its value.
    let slow = TimingOptions { tool_speed_m_s: Some(0.002), ..TimingOptions::default() };
    let refused = slow_to_stop(&robot, &running, middle, &slow).unwrap_err().to_string();
    assert!(refused.contains("the tool's speed goes") && refused.contains("its limit of 0.002 m/s"), "{refused}");
    assert!(!refused.contains("joint"), "{refused}");
}

/// The audit of a take-over judges the first point against the given state, bit for bit.
#[test]
fn a_start_that_is_not_exactly_the_state_fails_the_audit() {
    let mut random = Random(89);
    let robot = Robot::shipped("ur5e").unwrap();
    let running = running(&robot, &mut random);
    let at_s = running.points[running.points.len() / 3].time_s;
    let from = running.state_at(at_s);
    let rest = running.after(at_s);
    assert!(audit_from(&robot, &rest, &from).limits_ok);
    assert!(!audit(&robot, &rest).limits_ok, "it does not begin at rest");
    for spoil in [0, 1, 2] {
        let mut from = from.clone();
        [&mut from.positions, &mut from.velocities, &mut from.accelerations][spoil][3] += 1e-12;
        let found = audit_from(&robot, &rest, &from);
        assert!(!found.starts_and_ends_at_rest && !found.limits_ok);
    }
    let mut never_ends = rest;
    never_ends.points.pop();
    assert!(!audit_from(&robot, &never_ends, &from).limits_ok);
}
