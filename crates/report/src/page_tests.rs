use super::*;
use crate::{Points, explain};
use planner::reorder::{EdgeFigures, Options, Ordering, order_poses};
use planner::se3_geom::{Pose, Se3, nalgebra};

const LIBRARY: &str = "/* Three.js Authors */ exports.WebGLRenderer = 1;";

fn poses() -> Vec<Pose> {
    (0..12).map(|k| Pose::translation(0.01 * f64::from((5 * k) % 12), 0.0, 0.1)).collect()
}

fn ordered(poses: &[Pose]) -> (Ordering, Vec<EdgeFigures>) {
    let ordering = order_poses(poses, 0.1, &Options::default()).unwrap();
    let edges = ordering.edges(&Se3::default(), poses);
    (ordering, edges)
}

fn page_named(name: &str, why: Option<&str>) -> String {
    page_of(&poses(), name, why)
}

fn page_of(poses: &[Pose], name: &str, why: Option<&str>) -> String {
    let (mut ordering, edges) = ordered(poses);
    if let Some(why) = why {
        ordering.doubts.push(planner::reorder::Doubt { at: [0, 1], why: why.to_owned() });
    }
    let points = Points::of_poses(poses);
    let report = Report {
        name,
        points: &points,
        ordering: &ordering,
        edges: &edges,
        spline: None,
        robot: None,
        outcome: None,
        simulation: None,
    };
    page(&report, &DrawingLibrary::new(LIBRARY).unwrap()).unwrap()
}

fn data_of(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once(r#"<script type="application/json" id="data">"#).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn what_a_user_writes_stays_data() {
    let hostile = "</script><script>alert(1)</script><!--\u{2028}&\"'";
    let page = page_named(hostile, Some(hostile));
    let plain = page_named("plain", Some("plain"));
    for mark in ["<script", "</script", "<!--", "-->"] {
        assert_eq!(page.matches(mark).count(), plain.matches(mark).count(), "{mark}");
    }
    let data = data_of(&page);
    assert_eq!(data["name"], hostile);
    let doubts = data["doubts"].as_array().unwrap();
    assert_eq!(doubts[doubts.len() - 1]["why"], hostile);
    // A name that is a placeholder of the template is a name.
    assert_eq!(data_of(&page_named("{{script}}", None))["name"], "{{script}}");
}

#[test]
fn the_same_input_gives_the_same_page_with_nothing_left_open() {
    let page = page_named("twice", None);
    assert_eq!(page, page_named("twice", None));
    assert!(!page.contains("{{"), "a placeholder is left");
    let allowed = page.matches("'sha256-").count();
    assert_eq!(allowed, 3, "two scripts and a style");
    for address in ["http://", "https://", "//cdn"] {
        // three.js itself names pages in its comments; what is ours names none but that of SVG, which is no address.
        assert_eq!(page.replace("http://www.w3.org/2000/svg", "").matches(address).count(), 0, "{address}");
    }
}

#[test]
fn numbers_come_back_to_seven_digits() {
    let data = data_of(&page_named("numbers", None));
    let bytes = STANDARD.decode(data["places"].as_str().unwrap()).unwrap();
    let places: Vec<f32> = bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
    let expected = poses();
    assert_eq!(places.len(), 3 * expected.len());
    for (place, pose) in places.chunks(3).zip(&expected) {
        for (drawn, exact) in place.iter().zip(pose.translation.vector.iter()) {
            assert!((f64::from(*drawn) - exact).abs() <= 6e-8 * exact.abs(), "{drawn} for {exact}");
        }
    }
}

/// On a map in UTM coordinates single numbers are half a metre apart.
#[test]
fn points_far_from_zero_keep_their_shape() {
    let far = nalgebra::Vector3::new(4.3e5, 5.4e6, 0.0);
    let mapped: Vec<Pose> =
        poses().iter().map(|pose| Pose::from_parts((pose.translation.vector + far).into(), pose.rotation)).collect();
    let data = data_of(&page_of(&mapped, "map", None));
    let bytes = STANDARD.decode(data["places"].as_str().unwrap()).unwrap();
    let xs = bytes.chunks(12).map(|place| f64::from(f32::from_le_bytes(place[..4].try_into().unwrap())));
    let around = data["around"][0].as_f64().unwrap();
    for (x, pose) in xs.zip(&mapped) {
        // Of the difference of two numbers of 4e5, and of its seven digits.
        assert!((x - (pose.translation.vector.x - around)).abs() < 1e-10 + 6e-8 * 0.12, "{x}");
    }
    assert!(data_of(&page_named("near", None))["around"].is_null());
}

#[test]
fn only_the_library_itself_is_taken_for_it() {
    for (text, why) in [
        ("", "Authors"),
        ("// Three.js Authors", "WebGLRenderer"),
        ("// Three.js Authors\nexports.WebGLRenderer = '</SCRIPT>';", "end the script"),
    ] {
        let sentence = DrawingLibrary::new(text).unwrap_err().to_string();
        assert!(sentence.contains(why) && sentence.contains("three.cjs"), "{sentence}");
    }
}

#[test]
fn the_page_says_what_the_command_says() {
    let poses = poses();
    let (ordering, edges) = ordered(&poses);
    let data = data_of(&page_named("said", None));
    let said = explain(&ordering, &edges);
    assert!(said.starts_with(data["shape"].as_str().unwrap()));
    let certificate = data["certificate"].as_array().unwrap();
    assert!(certificate.len() > 3);
    for statement in certificate {
        let line = format!("{:<12}{}", statement["about"].as_str().unwrap(), statement["says"].as_str().unwrap());
        assert!(said.lines().any(|said| said == line), "{line}\nis not in\n{said}");
    }
}
