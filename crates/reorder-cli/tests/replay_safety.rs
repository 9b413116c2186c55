//! What `reorder replay` must not do to recordings, outputs and those who rely on its exit code.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Output;

mod support;

use planner::pose_bag::msg::{Header, JointTrajectory, PoseArray, Time};
use planner::pose_bag::{BagReader, BagWriter, read_poses};
use serde_json::Value;
use support::*;

fn replay(arguments: &[&str]) -> (i32, String, Value) {
    let Output { status, stdout, stderr } = reorder(&[&["replay", "--format", "json"], arguments].concat());
    let json = serde_json::from_slice(&stdout).unwrap_or(Value::Null);
    (status.code().unwrap(), String::from_utf8(stderr).unwrap(), json)
}

const ALL: usize = usize::MAX;

/// Arrays of the first poses of a recording, so many each, recorded at these times.
fn arrays(path: &Path, frame: &str, arrays: &[(u64, usize)]) {
    let poses = read_poses(format!("{BAGS}/lasa_sine"), None).unwrap().remove(0).poses;
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut bag = BagWriter::create(path).unwrap();
    for &(at_ns, n) in arrays {
        let header = Header { stamp: Time::from_nanos(at_ns as i64).unwrap(), frame_id: frame.into() };
        let poses = poses.iter().take(n).map(Into::into).collect();
        bag.write("/scan", at_ns, &PoseArray { header, poses }).unwrap();
    }
    bag.finish().unwrap();
}

#[test]
fn what_no_replay_made_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let bags = folder.path().join("bags");
    arrays(&bags.join("run"), "base_link", &[(1, 100)]);
    let other = bags.join("run.mcap");
    arrays(&other, "base_link", &[(1, 50)]);
    let before = fs::read(&other).unwrap();
    let run = bags.join("run");
    for output in [&bags, &other] {
        let (code, said, _) = replay(&[run.to_str().unwrap(), "-o", output.to_str().unwrap()]);
        let sentence = "already there, and not made by a replay of this version: choose another place, or remove it";
        assert_eq!((code, said), (2, format!("reorder: {}: {sentence}\n", other.display())));
        assert!(fs::read(&other).unwrap() == before);
    }
    let own = folder.path().join("own.mcap");
    for _ in 0..2 {
        assert_eq!(replay(&[run.to_str().unwrap(), "-o", own.to_str().unwrap(), "--score"]).0, 0);
        assert_eq!(replay(&[run.to_str().unwrap(), "-o", own.to_str().unwrap()]).0, 0, "ours may be replaced");
    }
}

#[test]
fn an_output_is_made_anew_where_what_was_lost_may_be_found_now() {
    let folder = tempfile::tempdir().unwrap();
    let (cut, split) = (folder.path().join("cut.mcap"), folder.path().join("split"));
    arrays(&cut, "base_link", &[(1, 100), (2, 200)]);
    let whole = fs::read(&cut).unwrap();
    fs::write(&cut, &whole[..whole.len() - 20]).unwrap();
    arrays(&split, "base_link", &[(1, 100)]);
    let metadata = fs::read_to_string(split.join("metadata.yaml")).unwrap();
    let twice = metadata.replacen("- split_0.mcap", "- split_0.mcap\n  - split_1.mcap", 1);
    assert_ne!(twice, metadata);
    fs::write(split.join("metadata.yaml"), twice).unwrap();
    for (bag, again) in [(&cut, "kept"), (&split, "done")] {
        let output = folder.path().join("out.mcap");
        for status in ["done", again] {
            let (code, said, found) = replay(&[bag.to_str().unwrap(), "-o", output.to_str().unwrap()]);
            assert_eq!((code, found["bags"][0]["status"].as_str().unwrap()), (2, status), "{said}");
            assert_eq!(found["bags"][0]["lost"].as_array().unwrap().len(), 1, "{said}");
        }
    }
}

#[test]
fn no_trajectory_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, frame: &str, n| {
        let bag = folder.path().join(name);
        arrays(&bag, frame, &[(1, n)]);
        bag.to_str().unwrap().to_owned()
    };
    let (single, elsewhere, good) =
        (of("a.mcap", "base_link", 1), of("b.mcap", "map", 100), of("c.mcap", "base_link", ALL));
    assert_eq!(replay(&[&single]).0, 0, "nothing was planned");
    for bag in [&single, &elsewhere] {
        let (code, said, _) = replay(&[bag, "--robot", "ur5e"]);
        assert_eq!(code, 2, "{said}");
        assert!(said.ends_with("reorder: 1 set without trajectory\n"), "{said}");
    }
    assert_eq!(replay(&[&good, "--robot", "ur5e"]).0, 0);
    // A doubtful order is no fault of the input.
    assert_eq!(replay(&[&of("d.mcap", "base_link", 100), "--robot", "ur5e"]).0, 1);
}

#[test]
fn one_arm_plays_one_motion_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, output) = (folder.path().join("two.mcap"), folder.path().join("out.mcap"));
    let second = 1_000_000_000;
    arrays(&bag, "base_link", &[(second, ALL), (2 * second, ALL)]);
    let (code, said, _) = replay(&[bag.to_str().unwrap(), "--robot", "ur5e", "-o", output.to_str().unwrap()]);
    assert_eq!(code, 0, "{said}");
    let (mut states, mut begins) = (Vec::new(), Vec::new());
    BagReader::open(&output)
        .unwrap()
        .for_each(&mut |message| {
            match message.topic() {
                "/joint_states" => states.push(message.log_time_ns()),
                "/joint_trajectory" => begins.push(message.decode::<JointTrajectory>()?.header.stamp.to_nanos()),
                _ => {}
            }
            Ok(())
        })
        .unwrap();
    assert!(states.len() > 100 && states.is_sorted());
    assert_eq!(begins.len(), 2);
    assert!(begins[1] > 2 * second as i64, "the first motion takes longer than a second: {begins:?}");
    assert!(states.contains(&(begins[1] as u64)));
}

#[test]
fn a_message_has_one_number_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("late_first.mcap");
    arrays(&bag, "base_link", &[(20, 100), (10, 200)]);
    let sets = replay(&[bag.to_str().unwrap()]).2["bags"][0]["sets"].clone();
    for set in sets.as_array().unwrap() {
        let message = set["message"].to_string();
        let ordered: Value =
            serde_json::from_str(&out(&reorder(&["order", bag.to_str().unwrap(), "--message", &message]))).unwrap();
        assert_eq!((&ordered["n"], &ordered["order"]), (&set["n"], &set["order"]), "message {message}");
        assert_eq!(set["n"], if message == "0" { 100 } else { 200 });
    }
}

#[test]
fn bags_behind_links_are_found_once() {
    let folder = tempfile::tempdir().unwrap();
    let (bags, away) = (folder.path().join("bags"), folder.path().join("away"));
    arrays(&bags.join("here"), "base_link", &[(1, 50)]);
    arrays(&away.join("there"), "base_link", &[(1, 60)]);
    arrays(&away.join("day/then"), "base_link", &[(1, 70)]);
    symlink(away.join("there"), bags.join("linked")).unwrap();
    symlink(bags.join("here"), bags.join("a_latest")).unwrap();
    // What links lead to that are no bags may hold anything, outputs too.
    symlink(away.join("day"), bags.join("day")).unwrap();
    symlink(&bags, bags.join("round")).unwrap();
    let (code, said, found) = replay(&[bags.to_str().unwrap()]);
    assert_eq!(code, 0, "{said}");
    let name = |bag: &Value| bag["bag"].as_str().unwrap().rsplit('/').next().unwrap().to_owned();
    let bags: Vec<_> =
        found["bags"].as_array().unwrap().iter().map(|bag| (name(bag), bag["sets"][0]["n"].clone())).collect();
    assert_eq!(bags, [("here".to_owned(), 50.into()), ("linked".to_owned(), 60.into())]);
}
