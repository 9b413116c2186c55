//! `reorder replay` as users call it: orders, scores, outputs, broken bags, and runs that were stopped.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

mod support;

use planner::pose_bag::msg::{Header, JointState, MarkerArray, PoseArray, PoseStamped, Time};
use planner::pose_bag::{BagMessage, BagReader, BagWriter, read_poses};
use planner::se3_geom::Pose;
use serde_json::{Value, json};
use support::*;
use tempfile::TempDir;

const SHAPES: [&str; 4] = ["lasa_angle", "lasa_gshape", "lasa_sine", "lasa_zshape"];

fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

fn indices(value: &Value) -> Vec<usize> {
    value.as_array().unwrap().iter().map(|i| i.as_u64().unwrap() as usize).collect()
}

/// Poses of a recording and their true order.
fn recording(shape: &str) -> (Vec<Pose>, Vec<usize>) {
    let truth: Value =
        serde_json::from_str(&fs::read_to_string(format!("{BAGS}/{shape}.truth.json")).unwrap()).unwrap();
    (read_poses(format!("{BAGS}/{shape}"), None).unwrap().remove(0).poses, indices(&truth["order"]))
}

fn header(nanos: i64) -> Header {
    Header { stamp: Time::from_nanos(nanos).unwrap(), frame_id: "base_link".into() }
}

/// A bag of single poses as they were drawn, 10 ms apart; what is recorded and what the stamps say go opposite ways.
fn drawn(path: &Path, shape: &str) {
    let (poses, order) = recording(shape);
    let mut bag = BagWriter::create(path).unwrap();
    let last = order.len() as i64 - 1;
    for (k, &row) in (0..).zip(&order) {
        let stamped =
            PoseStamped { header: header(1_000_000_000 + 10_000_000 * (last - k)), pose: (&poses[row]).into() };
        bag.write("/tool", 1_000_000_000 + 10_000_000 * k as u64, &stamped).unwrap();
    }
    bag.finish().unwrap();
}

fn topics(path: &Path) -> BTreeMap<String, String> {
    let (topics, losses) = BagReader::open(path).unwrap().topics().unwrap();
    assert!(losses.is_empty());
    topics
}

#[test]
fn the_order_is_that_of_reorder_order_and_so_is_the_output() {
    let folder = tempfile::tempdir().unwrap();
    for shape in SHAPES {
        let bag = format!("{BAGS}/{shape}");
        let output = folder.path().join(format!("{shape}.mcap"));
        let replayed = json_of(&reorder(&["replay", &bag, "--format", "json", "-o", output.to_str().unwrap()]));
        let ordered: Value = serde_json::from_str(&out(&reorder(&["order", &bag]))).unwrap();
        let set = &replayed["bags"][0]["sets"][0];
        for key in ["order", "topology", "verdict", "n"] {
            assert_eq!(set[key], ordered[key], "{shape}: {key}");
        }
        assert_eq!(set["score"], Value::Null);
        let (poses, _) = recording(shape);
        let expected: Vec<Pose> = indices(&ordered["order"]).iter().map(|&row| poses[row]).collect();
        let written = read_poses(&output, Some("/reorder/ordered_poses")).unwrap().remove(0);
        assert_eq!(written.poses.len(), expected.len());
        for (a, b) in written.poses.iter().zip(&expected) {
            assert_eq!(a.translation, b.translation);
        }
    }
}

#[test]
fn scores_ignore_how_a_bag_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    for shape in SHAPES {
        let bag = folder.path().join(shape);
        drawn(&bag, shape);
        let replayed =
            json_of(&reorder(&["replay", bag.to_str().unwrap(), "--topic", "/tool", "--score", "--format", "json"]));
        let score = &replayed["bags"][0]["sets"][0]["score"];
        let exact = json!({"adjacency": 1.0, "exact": true, "kendall_tau": 1.0, "first_difference": null});
        assert_eq!(*score, exact, "{shape}");
        // A recording that was shuffled agrees with itself nowhere, which a score that looks at nothing would not see.
        let shuffled = json_of(&reorder(&["replay", &format!("{BAGS}/{shape}"), "--score", "--format", "json"]));
        let set = &shuffled["bags"][0]["sets"][0];
        assert!(set["score"]["adjacency"].as_f64().unwrap() < 0.1, "{set}");
        assert!(set["score"]["kendall_tau"].as_f64().unwrap() < 0.3, "{set}");
        let order = indices(&set["order"]);
        let place = |row: usize| order.iter().position(|&other| other == row).unwrap();
        let [a, b] = indices(&set["score"]["first_difference"])[..] else { panic!("{set}") };
        assert_eq!(b, a + 1);
        assert!(place(a).abs_diff(place(b)) > 1);
        assert!((0..a).all(|row| place(row).abs_diff(place(row + 1)) == 1));
    }
}

#[test]
fn windows_and_gaps_are_sets_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag.mcap");
    drawn(&bag, "lasa_sine");
    let n = recording("lasa_sine").0.len();
    let counts = |option: &str, seconds: &str| -> Vec<u64> {
        let replayed =
            json_of(&reorder(&["replay", bag.to_str().unwrap(), option, seconds, "--score", "--format", "json"]));
        replayed["bags"][0]["sets"].as_array().unwrap().iter().map(|set| set["n"].as_u64().unwrap()).collect()
    };
    let windows = counts("--window", "1");
    assert!(windows[..windows.len() - 1].iter().all(|&count| count == 100), "{windows:?}");
    assert_eq!(windows.iter().sum::<u64>(), n as u64);
    assert_eq!(counts("--gap", "0.02"), [n as u64]);
    let (code, said) = refusal_of_replay(&[bag.to_str().unwrap(), "--window", "0"]);
    assert_eq!((code, said.contains("not a positive time")), (2, true), "{said}");
}

#[test]
fn a_robot_gets_trajectories_and_the_layout_finds_its_topics() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.mcap");
    let arguments =
        ["replay", &format!("{BAGS}/lasa_sine"), "--robot", "ur5e", "-o", output.to_str().unwrap(), "--format", "json"];
    let replayed = json_of(&reorder(&arguments));
    let set = &replayed["bags"][0]["sets"][0];
    let points = set["trajectory"]["points"].as_u64().unwrap();
    let mut states = 0;
    let mut markers = 0;
    BagReader::open(&output)
        .unwrap()
        .for_each(&mut |message| {
            match message.topic() {
                "/joint_states" => {
                    let state: JointState = message.decode()?;
                    assert_eq!((state.name.len(), state.position.len(), state.velocity.len()), (6, 6, 6));
                    states += 1;
                }
                "/reorder/markers" => markers += message.decode::<MarkerArray>()?.markers.len(),
                _ => {}
            }
            Ok(())
        })
        .unwrap();
    // Of the markers one removes those before; the others are poses, their three axes, curve and order.
    assert_eq!((states, markers), (points, 7));
    // Every topic that the layout shows is there, with the type that its panel can draw.
    let layout = fs::read_to_string(format!("{BAGS}/../../config/foxglove.json")).unwrap();
    let layout: Value = serde_json::from_str(&layout).unwrap();
    let topics = topics(&output);
    let mut shown = Vec::new();
    for (panel, config) in layout["configById"].as_object().unwrap() {
        if let Some(of_panel) = config["topics"].as_object() {
            shown.extend(of_panel.keys().cloned());
        }
        for path in config["paths"].as_array().into_iter().flatten() {
            let value = path["value"].as_str().unwrap();
            let (topic, field) = value.split_once('.').unwrap();
            assert!(field.starts_with("position[") || field.starts_with("velocity["), "{panel}: {value}");
            shown.push(topic.to_owned());
        }
        if let Some(topic) = config["topicPath"].as_str() {
            shown.push(topic.to_owned());
        }
    }
    shown.sort();
    shown.dedup();
    assert_eq!(
        shown,
        ["/joint_states", "/reorder/markers", "/reorder/ordered_poses", "/reorder/path", "/reorder/report"]
    );
    assert!(shown.iter().all(|topic| topics.contains_key(topic)), "{topics:?}");
    let (ids, text) = (layout["configById"].as_object().unwrap(), layout["layout"].to_string());
    assert!(ids.keys().all(|id| text.contains(&format!("\"{id}\""))), "{text}");
}

/// Bags in a folder, one of them a folder itself and one in a folder.
fn many(folder: &TempDir, count: usize) -> PathBuf {
    let bags = folder.path().join("bags");
    fs::create_dir_all(bags.join("day")).unwrap();
    for k in 0..count {
        let shape = SHAPES[k % SHAPES.len()];
        let name = if k == 1 {
            "day/run".to_owned()
        } else if k == 0 {
            "folder".to_owned()
        } else {
            format!("run_{k}.mcap")
        };
        drawn(&bags.join(name), shape);
    }
    bags
}

fn outputs(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_broken_bag_is_reported_and_the_others_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let bags = many(&folder, 4);
    let whole = fs::read(bags.join("run_2.mcap")).unwrap();
    fs::write(bags.join("bad.mcap"), "no bag at all").unwrap();
    fs::write(bags.join("cut.mcap"), &whole[..whole.len() - 2000]).unwrap();
    let target = folder.path().join("out");
    let arguments = ["replay", bags.to_str().unwrap(), "-o", target.to_str().unwrap(), "--score"];
    let output = reorder(&arguments);
    let (said, table) = (String::from_utf8(output.stderr).unwrap(), String::from_utf8(output.stdout).unwrap());
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("bad.mcap is not an MCAP file"), "{said}");
    assert!(said.contains("cut.mcap is cut off"), "{said}");
    assert!(said.ends_with("reorder: 1 of 6 bags could not be replayed\n"), "{said}");
    assert_eq!(outputs(&target), ["cut.mcap", "day_run.mcap", "folder.mcap", "run_2.mcap", "run_3.mcap"]);
    assert_eq!(table.lines().count(), 7, "{table}");
    let line =
        |name: &str| table.lines().find(|line| line.contains(name)).unwrap().split_whitespace().collect::<Vec<_>>();
    let run_3 = bags.join("run_3.mcap");
    let ordered: Value = serde_json::from_str(&out(&reorder(&["order", run_3.to_str().unwrap()]))).unwrap();
    assert_eq!(
        line("run_3.mcap")[1..],
        [
            "done",
            "/tool",
            "1",
            &recording("lasa_zshape").0.len().to_string(),
            ordered["verdict"].as_str().unwrap(),
            "1.0000",
            "1.0000",
            "-",
            "-"
        ]
    );
    assert_eq!(line("bad.mcap")[1], "broken");
    assert_eq!(line("cut.mcap")[1..3], ["done,", "damaged"]);
    // A single one has its sentence as the last word.
    let (code, said) = refusal_of_replay(&[bags.join("bad.mcap").to_str().unwrap()]);
    assert_eq!((code, said.lines().count()), (2, 1), "{said}");
}

fn refusal_of_replay(arguments: &[&str]) -> (i32, String) {
    let output = reorder(&[&["replay"], arguments].concat());
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn what_cannot_be_is_said_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    let bag = format!("{BAGS}/lasa_sine");
    let copy = folder.path().join("copy.mcap");
    drawn(&copy, "lasa_sine");
    let cases: [(&[&str], &str); 6] = [
        (&[empty.to_str().unwrap()], "there is no bag in this folder"),
        (&["nowhere"], "nowhere: No such file or directory"),
        (&[&bag, &bag], "would both be written as lasa_sine.mcap"),
        (&[&bag, copy.to_str().unwrap(), "-o", "one.mcap"], "one.mcap is one file for 2 bags: name a folder"),
        (&[copy.to_str().unwrap(), "-o", copy.to_str().unwrap()], "copy.mcap: already an input or another output"),
        (&[&bag, "--topic", "/none"], "has no poses on topic /none"),
    ];
    for (arguments, expected) in cases {
        let (code, said) = refusal_of_replay(arguments);
        assert!(code == 2 && said.contains(expected) && said.lines().count() == 1, "{arguments:?}: {said}");
    }
}

/// Every file below, by its bytes.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let of =
        |path: PathBuf| if path.is_dir() { contents(&path) } else { [(path.clone(), fs::read(path).unwrap())].into() };
    entries.flat_map(of).collect()
}

#[test]
fn no_output_takes_the_place_of_a_file_of_any_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    drawn(&folder.path().join("bag"), "lasa_sine");
    fs::create_dir_all(folder.path().join("d/sub")).unwrap();
    drawn(&folder.path().join("d/run.mcap"), "lasa_sine");
    drawn(&folder.path().join("d/sub/run.mcap"), "lasa_zshape");
    let before = contents(folder.path());
    for (input, output, named) in [
        (path("bag"), path("bag/bag_0.mcap"), path("bag/bag_0.mcap")),
        (path("bag"), path("d/../bag/bag_0.mcap"), path("d/../bag/bag_0.mcap")),
        (path("d"), path("d/sub"), String::new()),
        (path("d"), path("d/new"), String::new()),
    ] {
        let (code, said) = refusal_of_replay(&[&input, "-o", &output]);
        assert_eq!(code, 2, "{said}");
        let sentence = match named.as_str() {
            "" => format!("{output} lies in {input}: outputs go where no bags are looked for"),
            named => format!("{named}: already an input or another output of this command"),
        };
        assert_eq!(said, format!("reorder: {sentence}\n"));
        assert!(contents(folder.path()) == before, "{output}");
    }
}

#[test]
fn a_topic_that_is_named_twice_is_taken_once() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag.mcap");
    drawn(&bag, "lasa_sine");
    let output = folder.path().join("out.mcap");
    let arguments = ["replay", bag.to_str().unwrap(), "--topic", "/tool", "--topic", "/tool", "--format", "json"];
    let replayed = json_of(&reorder(&[&arguments[..], &["-o", output.to_str().unwrap()]].concat()));
    assert_eq!(replayed["bags"][0]["sets"].as_array().unwrap().len(), 1);
    assert!(topics(&output).contains_key("/reorder/ordered_poses"), "{:?}", topics(&output));
}

#[test]
fn times_at_the_end_of_the_clock_are_replayed_like_others() {
    let folder = tempfile::tempdir().unwrap();
    let (bags, target) = (folder.path().join("bags"), folder.path().join("out"));
    fs::create_dir(&bags).unwrap();
    drawn(&bags.join("early.mcap"), "lasa_sine");
    let poses = recording("lasa_sine").0.iter().map(Into::into).collect();
    let mut bag = BagWriter::create(bags.join("late.mcap")).unwrap();
    bag.write("/scan", u64::MAX, &PoseArray { header: header(0), poses }).unwrap();
    bag.finish().unwrap();
    let arguments = ["replay", bags.to_str().unwrap(), "--robot", "ur5e", "-o", target.to_str().unwrap()];
    let output = reorder(&[&arguments[..], &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(statuses(&json_of(&output)), ["done"; 2]);
    let mut times = Vec::new();
    let note = &mut |message: &BagMessage<'_>| {
        times.push(message.log_time_ns());
        Ok(())
    };
    assert!(BagReader::open(target.join("late.mcap")).unwrap().for_each(note).unwrap().is_empty());
    assert!(times.len() > 100 && times.iter().all(|&time| time == u64::MAX));
}

fn statuses(value: &Value) -> Vec<&str> {
    value["bags"].as_array().unwrap().iter().map(|bag| bag["status"].as_str().unwrap()).collect()
}

#[test]
fn finished_bags_are_kept_until_the_bag_or_the_settings_change() {
    let folder = tempfile::tempdir().unwrap();
    let bags = many(&folder, 3);
    let target = folder.path().join("out");
    let run = |extra: &[&str]| {
        let output = reorder(
            &[&["replay", bags.to_str().unwrap(), "-o", target.to_str().unwrap(), "--format", "json"], extra].concat(),
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        json_of(&output)
    };
    let first = run(&["--score"]);
    assert_eq!(statuses(&first), ["done"; 3]);
    let bytes = fs::read(target.join("folder.mcap")).unwrap();
    let again = run(&["--score"]);
    assert_eq!(statuses(&again), ["kept"; 3]);
    assert_eq!(again["bags"][0]["sets"], first["bags"][0]["sets"], "the summary is whole");
    assert_eq!(statuses(&run(&[])), ["done"; 3], "without score");
    drawn(&bags.join("run_2.mcap"), "lasa_zshape");
    assert_eq!(statuses(&run(&[])), ["kept", "kept", "done"], "another bag of that name");
    fs::write(target.join("folder.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(statuses(&run(&[])), ["kept", "done", "kept"], "half an output is none");
}

/// xorshift64*, S. Vigna 2016.
fn random(state: &mut u64) -> f64 {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
}

/// `cargo xtask soak replay 50` runs more.
#[test]
fn stopped_at_any_moment_nothing_half_written_passes_for_whole() {
    use std::process::{Command, Stdio};
    use std::time::Instant;
    let cases: usize = std::env::var("REORDER_SOAK_CASES").map_or(4, |cases| cases.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let bags = many(&folder, 12);
    let target = folder.path().join("out");
    let arguments = ["replay", bags.to_str().unwrap(), "-o", target.to_str().unwrap(), "--score", "--format", "json"];
    let started = Instant::now();
    assert!(reorder(&arguments).status.success());
    let whole_run = started.elapsed();
    let names = outputs(&target);
    assert_eq!(names.len(), 12);
    let expected: Vec<_> = names.iter().map(|name| topics(&target.join(name))).collect();
    let (mut state, mut midway) = (7_u64, 0);
    for case in 0..cases {
        fs::remove_dir_all(&target).unwrap();
        fs::create_dir(&target).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_reorder"))
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(whole_run.mul_f64(random(&mut state)));
        child.kill().unwrap();
        child.wait().unwrap();
        let left: Vec<String> = outputs(&target).into_iter().filter(|name| !name.starts_with(".pose-bag-")).collect();
        midway += usize::from(!left.is_empty() && left.len() < names.len());
        for name in &left {
            let at = names.iter().position(|other| other == name).unwrap_or_else(|| panic!("case {case}: {name}"));
            assert_eq!(topics(&target.join(name)), expected[at], "case {case}: {name}");
        }
        let finished: Vec<_> =
            left.iter().map(|name| fs::metadata(target.join(name)).unwrap().modified().unwrap()).collect();
        let resumed = reorder(&arguments);
        assert!(resumed.status.success(), "{}", String::from_utf8_lossy(&resumed.stderr));
        let kept = statuses(&json_of(&resumed)).iter().filter(|&&status| status == "kept").count();
        assert_eq!(kept, left.len(), "case {case}");
        assert_eq!(outputs(&target), names, "case {case}: complete, and nothing beside it");
        for (name, time) in left.iter().zip(finished) {
            assert_eq!(fs::metadata(target.join(name)).unwrap().modified().unwrap(), time, "case {case}: {name}");
        }
    }
    println!("{cases} runs stopped, {midway} of them with some but not all bags finished");
    assert!(cases < 20 || midway > cases / 4, "{midway} of {cases}: the moments are not spread");
}

#[test]
fn several_messages_are_several_sets() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arrays.mcap");
    let (poses, _) = recording("lasa_sine");
    let mut bag = BagWriter::create(&path).unwrap();
    for (k, n) in [100, 0, 200].into_iter().enumerate() {
        let poses = poses.iter().take(n).map(Into::into).collect();
        bag.write("/scan", k as u64, &PoseArray { header: header(0), poses }).unwrap();
    }
    bag.finish().unwrap();
    let output = reorder(&["replay", path.to_str().unwrap(), "--format", "json"]);
    let sets = json_of(&output)["bags"][0]["sets"].clone();
    let summary: Vec<_> = sets
        .as_array()
        .unwrap()
        .iter()
        .map(|set| (set["message"].clone(), set["order"].as_array().unwrap().len()))
        .collect();
    assert_eq!(summary, [(json!(0), 100), (json!(1), 0), (json!(2), 200)]);
    assert!(sets[1]["error"].as_str().unwrap().contains("there are 0 points to order"), "{}", sets[1]);
    for (message, n) in [("0", 100), ("2", 200)] {
        let ordered: Value =
            serde_json::from_str(&out(&reorder(&["order", path.to_str().unwrap(), "--message", message]))).unwrap();
        assert_eq!(
            (ordered["n"].as_u64().unwrap(), &ordered["order"]),
            (n, &sets[message.parse::<usize>().unwrap()]["order"])
        );
    }
}
