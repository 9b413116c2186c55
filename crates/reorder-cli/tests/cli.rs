//! The command as users and scripts call it: output, exit codes, and one clear sentence for everything that is wrong.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

mod support;

use support::*;

fn truth(name: &str) -> Vec<u64> {
    let text = fs::read_to_string(format!("{BAGS}/{name}.truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    truth["order"].as_array().unwrap().iter().map(|i| i.as_u64().unwrap()).collect()
}

fn is_truth_up_to_direction(order: &[u64], name: &str) -> bool {
    let truth = truth(name);
    order == truth || order.iter().rev().copied().eq(truth)
}

#[test]
fn order_prints_the_whole_object_for_a_recorded_bag() {
    for name in ["lasa_angle", "lasa_gshape", "lasa_sine", "lasa_zshape"] {
        let text = out(&reorder(&["order", &format!("{BAGS}/{name}")]));
        let object: serde_json::Value = serde_json::from_str(&text).unwrap();
        let order: Vec<u64> = object["order"].as_array().unwrap().iter().map(|i| i.as_u64().unwrap()).collect();
        assert!(is_truth_up_to_direction(&order, name), "{name}");
        assert_eq!(object["n"], order.len());
        assert_eq!(object["topology"], "open");
        assert_eq!(object["method"], "mst");
        assert_ne!(object["verdict"], "ambiguous", "{}", object["doubts"]);
        assert!(object["metres_per_radian"].as_f64().unwrap() > 0.0);
        assert_eq!(object["weight_stable"], true);
        for key in ["components", "duplicates", "doubts"] {
            assert!(object[key].is_array(), "{key}");
        }
        for key in ["max_gap", "reach", "epsilon", "injectivity_radius", "margin"] {
            assert!(object["certificate"].get(key).is_some(), "{key}");
        }
    }
}

#[test]
fn order_reads_every_manifold_it_offers_by_its_columns() {
    let folder = tempfile::tempdir().unwrap();
    // Line i of the file is place 3i mod 10, so place k is line 7k mod 10.
    let expected: String = (0..10).map(|k| format!("{}\n", (7 * k) % 10)).collect();
    let half = |a: f64| ((0.5 * a).sin(), (0.5 * a).cos());
    let tables = [
        ("r2", arc("x,y", |a| format!("{},{}", a.cos(), a.sin()))),
        ("r3", arc("x,y,z", |a| format!("{},{},{}", a.cos(), a.sin(), a))),
        ("rn", arc("t,x,y", |a| format!("junk,{},{}", a.cos(), a.sin()))),
        ("so3", arc("qx,qy,qz,qw", |a| format!("0,{},0,{}", half(a).0, half(a).1))),
        ("s2", arc("lat,lon", |a| format!("{},{}", 20.0 * a.sin(), 179.0 + 20.0 * a))),
        ("se2", arc("x,y,theta", |a| format!("{},{},{a}", a.cos(), a.sin()))),
        ("sim2", arc("x,y,theta,scale", |a| format!("{},{},{a},{}", a.cos(), a.sin(), a.exp()))),
        ("se3", arc("x,y,z,qx,qy,qz,qw", |a| format!("{},0,{},0,{},0,{}", a.cos(), a.sin(), half(a).0, half(a).1))),
    ];
    for (manifold, table) in &tables {
        let path = file(&folder, &format!("{manifold}.csv"), table);
        for extra in [&["--manifold", manifold][..], &[]] {
            let arguments = [&["order", &path, "--format", "indices"], extra].concat();
            assert_eq!(out(&reorder(&arguments)), expected, "{manifold}");
        }
    }
    let path = file(&folder, "r2.csv", &tables[0].1);
    let csv = out(&reorder(&["order", &path, "--format", "csv", "--start", "3"]));
    // Place 9 is line 3: the order from that end.
    assert_eq!(csv.lines().next(), Some("x,y"));
    let first: Vec<f64> = csv.lines().nth(1).unwrap().split(',').map(|f| f.parse().unwrap()).collect();
    let angle = 9.0 * 0.15_f64;
    assert_eq!(first, [angle.cos(), angle.sin()], "numbers come back to the last bit");
}

#[test]
fn order_reads_standard_input() {
    use std::io::Write;
    let mut child = Command::new(env!("CARGO_BIN_EXE_reorder"))
        .args(["order", "-", "--format", "indices"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(b"x,y\n0,0\n2,0.1\n1,0\n").unwrap();
    assert_eq!(out(&child.wait_with_output().unwrap()), "0\n2\n1\n");
}

#[test]
fn plan_writes_csv_and_mcap() {
    let folder = tempfile::tempdir().unwrap();
    let bag = format!("{BAGS}/lasa_sine");
    let csv = folder.path().join("plan.csv").display().to_string();
    let run = reorder(&["plan", &bag, "--robot", "ur5e", "--rate", "125", "-o", &csv]);
    assert!(out(&run).is_empty());
    let text = fs::read_to_string(&csv).unwrap();
    let header = text.lines().next().unwrap();
    assert!(header.starts_with("t,shoulder_pan_joint.position,shoulder_lift_joint.position,"), "{header}");
    assert_eq!(header.split(',').count(), 1 + 3 * 6);
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|f| f.parse().unwrap()).collect()).collect();
    assert!(rows.windows(2).all(|r| r[0][0] < r[1][0]));
    // Points come at least as often as asked for.
    assert!(rows.windows(2).all(|r| r[1][0] - r[0][0] <= 1.0 / 125.0 + 1e-9));
    assert!(rows[0][7..].iter().chain(&rows[rows.len() - 1][7..]).all(|x| x.abs() < 1e-9), "at rest at both ends");

    let mcap = folder.path().join("plan.mcap").display().to_string();
    out(&reorder(&["plan", &bag, "--robot", "ur5e", "-o", &mcap]));
    let sets = pose_bag::read_poses(&mcap, Some("/reorder/ordered_poses")).unwrap();
    assert_eq!(sets[0].poses.len(), truth("lasa_sine").len());

    let from = "--from=-1.5708,-1.5708,1.5708,-1.5708,-1.5708,0.0";
    let text = out(&reorder(&["plan", &bag, "--robot", "ur5e", from]));
    let first: Vec<&str> = text.lines().nth(1).unwrap().split(',').take(3).collect();
    assert_eq!(
        first,
        ["0", "-1.5708", "-1.5708"],
        "without -o the CSV goes to standard output, from where the robot stands"
    );
}

/// A pose two metres away is no input error: the poses are fine, this robot cannot reach them.
#[test]
fn refusals_exit_with_1_and_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let far = arc("x,y,z,qx,qy,qz,qw", |a| format!("{},0,{},0,0,0,1", 2.0 + 0.1 * a, 0.1 * a));
    let path = file(&folder, "far.csv", &far);
    let output = folder.path().join("out.csv");
    let (code, said) = refusal(&["plan", &path, "--robot", "ur5e", "-o", output.to_str().unwrap()]);
    assert_eq!(code, 1, "{said}");
    assert!(said.starts_with("reorder: refused: ") && said.contains("far.csv: ur5e: pose"), "{said}");
    assert!(said.contains("out of reach") && said.contains("recovered order; input poses "), "{said}");
    assert_eq!(names_in(folder.path()), [PathBuf::from("far.csv")], "nothing half-written stays");
}

fn names_in(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into()).collect()
}

#[test]
fn order_explains_itself_and_takes_a_weight() {
    let bag = format!("{BAGS}/lasa_sine");
    let text = out(&reorder(&["order", &bag, "--explain", "--metres-per-radian", "0.1"]));
    assert!(text.lines().any(|line| line.starts_with("verdict     ")), "{text}");
    assert!(text.contains("one radian counts as 0.100000 m"), "{text}");
    let refused = reorder(&["order", &bag, "--metres-per-radian", "much"]);
    assert_eq!(refused.status.code(), Some(2));
    let (code, said) = refusal(&["order", &bag, "--metres-per-radian=-1"]);
    assert!(
        code == 2 && said.ends_with("metres_per_radian is -1, but it, its half, its double and their squares must be positive finite numbers"),
        "{said}"
    );
}

fn object(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&out(&reorder(arguments))).unwrap()
}

#[test]
fn order_by_every_method() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "arc.csv", &arc("x,y", |a| format!("{},{}", a.cos(), a.sin())));
    let expected: Vec<u64> = (0..10).map(|k| (7 * k) % 10).collect();
    for method in ["auto", "mst", "nn-crust", "crust", "nearest"] {
        let found = object(&["order", &path, "--method", method]);
        assert_eq!(found["method"], if method == "auto" { "mst" } else { method });
        assert_eq!(found["order"], serde_json::json!(expected), "{method}");
    }
    // Row 5 is place 5, from where the chain runs to one end and jumps back.
    let chain = object(&["order", &path, "--method", "nearest", "--start", "5"]);
    assert_eq!((&chain["order"][0], &chain["verdict"]), (&5.into(), &"ambiguous".into()));
    let near = object(&["order", &path, "--method", "nearest", "--start-at=-1,9"]);
    assert_eq!(near["order"], serde_json::json!(expected.iter().rev().collect::<Vec<_>>()));
    let poses = format!("{BAGS}/lasa_sine");
    let (code, said) = refusal(&["order", &poses, "--method", "crust"]);
    assert!(code == 2 && said.ends_with("lasa_sine: CRUST orders points of the plane only"), "{said}");
}

#[test]
fn order_tells_several_curves_apart() {
    let folder = tempfile::tempdir().unwrap();
    let row = |x: f64, k: u32| format!("{},{}\n", x + f64::from(k), (0.1 * f64::from(k)).sin());
    let rows: String = (0..20).map(|k| row(0.0, k) + &row(100.0, k)).collect();
    let path = file(&folder, "two.csv", &format!("x,y\n{rows}-500,0\n"));
    let [evens, odds] = [0, 1].map(|first| (0..20).map(|k| first + 2 * k).collect::<Vec<_>>());
    let back = |rows: &[i32]| rows.iter().rev().copied().collect::<Vec<_>>();
    // As one, the order starts at row 39 and ends at the outlier.
    let expected = [[back(&evens), back(&odds)], [evens.clone(), odds.clone()]];
    for ((choice, parts), expected) in [("one", 0), ("auto", 2)].into_iter().zip(expected) {
        let found = object(&["order", &path, "--components", choice]);
        assert_eq!(found["components"], serde_json::json!(expected), "{choice}");
        assert_eq!(found["outliers"], serde_json::json!([40]));
        assert_eq!(found["parts"].as_array().unwrap().len(), parts);
        // The jump to the outlier is no part of any curve.
        assert_eq!(found["verdict"], "ambiguous");
    }
    let text = out(&reorder(&["order", &path, "--components", "auto", "--explain"]));
    assert!(text.starts_with("41 points on 2 curves, 1 point on none\n"), "{text}");
    assert!(text.contains("curve       20 points from point 0 on: an open curve, certified\n"), "{text}");
    assert!(text.contains("apart       1 point on no curve: 40\n"), "{text}");
    let (code, said) = refusal(&["order", &path, "--components", "auto", "--start", "40"]);
    assert!(code == 2 && said.ends_with("the start 40 stands apart from every curve"), "{said}");
}

#[test]
fn order_starts_near_a_pose_and_prints_its_edges() {
    let half = |a: f64| ((0.5 * a).sin(), (0.5 * a).cos());
    let folder = tempfile::tempdir().unwrap();
    let columns = "x,y,z,qx,qy,qz,qw";
    let table = arc(columns, |a| format!("{},0,{},0,{},0,{}", a.cos(), a.sin(), half(a).0, half(a).1));
    let path = file(&folder, "arc.csv", &table);
    let from = "--start-at=0,0,2,0,0.7071067811865476,0,0.7071067811865476";
    let found = object(&["order", &path, from, "--edges"]);
    let expected: Vec<u64> = (0..10).rev().map(|k| (7 * k) % 10).collect();
    assert_eq!(found["order"], serde_json::json!(expected));
    let edges = found["edges"].as_array().unwrap();
    assert_eq!(edges.len(), 9);
    for (k, edge) in edges.iter().enumerate() {
        assert_eq!(edge["at"], serde_json::json!(expected[k..k + 2]));
        assert!(edge["gap"].as_f64().unwrap() > 0.0 && edge["epsilon"].as_f64().unwrap() >= 0.0);
    }
    assert!(object(&["order", &path])["edges"].is_null());
    let text = out(&reorder(&["order", &path, "--explain"]));
    assert!(text.lines().filter(|line| line.starts_with("edge        points ")).count() == 5, "{text}");
    let (code, said) = refusal(&["order", &path, "--start-at=1,2"]);
    assert!(code == 2 && said.ends_with("finite numbers, for the columns x,y,z,qx,qy,qz,qw, not 1,2"), "{said}");
    let (code, said) = refusal(&["order", &path, "--start-at=1,2,3,0,0,0,0"]);
    assert!(code == 2 && said.contains("--start-at: the quaternion is zero"), "{said}");
    assert_eq!(reorder(&["order", &path, "--start-at=1,2", "--start", "0"]).status.code(), Some(2));
}

#[test]
fn order_says_nothing_on_standard_error_when_nobody_watches() {
    let output = reorder(&["order", &format!("{BAGS}/lasa_sine")]);
    assert!(output.status.success() && output.stderr.is_empty());
}

#[test]
fn order_writes_the_rows_of_a_table_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "rows.csv", "t,x,y,quality\n0.10,2,0,good\n0.2,0,0,\"poor\"\n0.3,1.0,0,\n");
    let csv = out(&reorder(&["order", &path, "--manifold", "r2", "--format", "csv", "--start", "1"]));
    assert_eq!(csv, "t,x,y,quality\n0.2,0,0,\"poor\"\n0.3,1.0,0,\n0.10,2,0,good\n");
}

#[test]
fn a_weight_for_points_that_have_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "plane.csv", "x,y\n0,0\n1,0\n2,0\n");
    let (code, said) = refusal(&["order", &path, "--metres-per-radian", "0.3"]);
    let sentence = "--metres-per-radian weighs rotations against translations, and these points do not have both";
    assert!(code == 2 && said.ends_with(sentence), "{said}");
    let found: serde_json::Value = serde_json::from_str(&out(&reorder(&["order", &path]))).unwrap();
    assert!(found["weight_stable"].is_null(), "a weight that does not exist was never tried");
}

#[test]
fn order_reads_kitti_euroc_and_transforms_as_it_reads_csv() {
    let folder = tempfile::tempdir().unwrap();
    // Line i of each file is place 3i mod 10 on a quarter circle, turned about z by its angle.
    let angles: Vec<f64> = (0..10).map(|i| f64::from((i * 3) % 10) * 0.15).collect();
    let half = |a: f64| ((0.5 * a).sin(), (0.5 * a).cos());
    let csv = arc("x,y,z,qx,qy,qz,qw", |a| format!("{},{},0.5,0,0,{},{}", a.cos(), a.sin(), half(a).0, half(a).1));
    let euroc = arc(
        "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z [],v_RS_R_x [m s^-1]",
        |a| format!("1403636580838555648,{},{},0.5,{},0,0,{},7", a.cos(), a.sin(), half(a).1, half(a).0),
    );
    let kitti = |a: f64| {
        let (s, c) = a.sin_cos();
        format!("{c} {} 0 {c} {s} {c} 0 {s} 0 0 1 0.5\n", -s)
    };
    let kitti: String = angles.iter().map(|&a| kitti(a)).collect();
    let bag = folder.path().join("tf.mcap");
    write_transforms(&bag, &angles);
    let expected = out(&reorder(&["order", &file(&folder, "poses.csv", &csv), "--format", "indices"]));
    assert_eq!(expected.lines().count(), 10);
    let inputs = [file(&folder, "data.csv", &euroc), file(&folder, "00.txt", &kitti), bag.display().to_string()];
    for input in &inputs {
        let frames: &[&str] = if input.ends_with(".mcap") { &["--frames", "base:tool"] } else { &[] };
        let arguments = [&["order", input.as_str(), "--format", "indices"], frames].concat();
        assert_eq!(out(&reorder(&arguments)), expected, "{input}");
    }
    let (code, said) = refusal(&["order", &inputs[2]]);
    assert!(code == 2 && said.ends_with("name one of the frame pairs map:odom, base:tool"), "{said}");
    // The columns that no pose has stay in the rows.
    let ordered = out(&reorder(&["order", &inputs[0], "--format", "csv"]));
    assert!(ordered.starts_with("t,x,y,z,qw,qx,qy,qz,v_RS_R_x\n1403636580838555648,"), "{ordered}");
}

fn write_transforms(path: &Path, angles: &[f64]) {
    use planner::pose_bag::BagWriter;
    use planner::pose_bag::msg::{Header, Quaternion, TfMessage, Transform, TransformStamped, Vector3};
    let mut bag = BagWriter::create(path).unwrap();
    for (k, a) in (0..).zip(angles) {
        let transform = |parent: &str, child: &str, a: f64| TransformStamped {
            header: Header { frame_id: parent.into(), ..Header::default() },
            child_frame_id: child.into(),
            transform: Transform {
                translation: Vector3 { x: a.cos(), y: a.sin(), z: 0.5 },
                rotation: Quaternion { x: 0.0, y: 0.0, z: (0.5 * a).sin(), w: (0.5 * a).cos() },
            },
        };
        let transforms = vec![transform("map", "odom", 1.0), transform("base", "tool", *a)];
        bag.write("/tf", k, &TfMessage { transforms }).unwrap();
    }
    bag.finish().unwrap();
}
