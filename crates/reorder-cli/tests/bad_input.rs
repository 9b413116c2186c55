//! Input that is no set of points of a manifold: exit code 2 and one sentence with file and line, or a defined answer.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::process::Output;

use tempfile::TempDir;

mod support;

use support::*;

const COLUMNS: &str = "name one with --manifold to use its columns and ignore the others";

#[test]
fn bad_input_exits_with_2_and_names_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let pose = "x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n0.1,0,0,0,0,0,1\n";
    for (name, content, sentence) in [
        ("nan.csv", format!("{pose}NaN,0,0,0,0,0,1\n"), "nan.csv, line 4: x is not finite: NaN"),
        (
            "zero.csv",
            format!("{pose}0.2,0,0,0,0,0,0\n"),
            "zero.csv, line 4: the quaternion is zero, so there is no orientation",
        ),
        (
            "norm.csv",
            format!("{pose}0.2,0,0,0,0,0,2\n"),
            "norm.csv, line 4: the quaternion has norm 2.000000 instead of 1",
        ),
        ("word.csv", format!("{pose}a,0,0,0,0,0,1\n"), "word.csv, line 4: x is not a number: \"a\""),
        ("short.csv", format!("{pose}0,0\n"), "short.csv, line 4: 2 fields instead of 7"),
        ("empty.csv", String::new(), "empty.csv holds no rows"),
        (
            "one.csv",
            "x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,1\n".into(),
            "one.csv: there is 1 point to order, but at least 2 are needed",
        ),
        (
            "equal.csv",
            "x,y\n1,2\n1,2\n1,2\n".into(),
            "equal.csv: all 3 points are equal up to rounding, so there is nothing to order",
        ),
        ("columns.csv", "a,b\n1,2\n".into(), COLUMNS),
        ("far.csv", "lat,lon\n0,0\n91,0\n".into(), "far.csv, line 3: lat is beyond 90 degrees: 91"),
        ("flat.csv", "x,y,theta,scale\n0,0,1,1\n1,0,2,0\n".into(), "flat.csv, line 3: scale is not positive: 0"),
        ("columns.csv", "x,y,qx\n0,0,1\n1,0,2\n".into(), COLUMNS),
    ] {
        let path = file(&folder, name, &content);
        let (code, said) = refusal(&["order", &path]);
        assert_eq!(code, 2, "{said}");
        assert!(said.ends_with(sentence) && said.starts_with("reorder: "), "{said}");
    }
    let table = file(&folder, "wide.csv", "x,y,z,w\n0,0,0,1\n1,0,0,2\n2,0,0,3\n");
    assert_eq!(out(&reorder(&["order", &table, "--manifold", "rn", "--format", "indices"])), "0\n1\n2\n");
    let (code, said) = refusal(&["order", &table]);
    assert!(code == 2 && said.ends_with(COLUMNS), "{said}");
    assert_eq!(out(&reorder(&["order", &table, "--manifold", "r3", "--format", "indices"])), "0\n1\n2\n");
    let (code, said) = refusal(&["order", "/nowhere/at/all.csv"]);
    assert_eq!((code, said.as_str()), (2, "reorder: /nowhere/at/all.csv: No such file or directory (os error 2)"));
    let path = file(&folder, "plan.csv", &format!("{pose}NaN,0,0,0,0,0,1\n"));
    let (code, said) = refusal(&["plan", &path, "--robot", "ur5e"]);
    assert_eq!(code, 2);
    assert!(said.ends_with("plan.csv, line 4: x is not finite: NaN"), "{said}");
    let (code, said) = refusal(&["plan", &format!("{BAGS}/lasa_sine"), "--robot", "hal9000"]);
    assert!(code == 2 && said.contains("hal9000") && said.contains("ur5e"), "{said}");
}

#[test]
fn a_truncated_bag_is_refused_with_what_could_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let whole = fs::read(format!("{BAGS}/lasa_sine/lasa_sine.mcap")).unwrap();
    let path = folder.path().join("cut.mcap");
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let (code, said) = refusal(&["order", path.to_str().unwrap()]);
    assert_eq!(code, 2);
    assert!(said.contains("cut.mcap is cut off") && said.contains("readable messages"), "{said}");
}

/// A manifold by its columns, with three different points of it.
struct Space {
    name: &'static str,
    columns: &'static str,
    rows: [&'static str; 3],
    has_quaternion: bool,
}

const fn space(name: &'static str, columns: &'static str, rows: [&'static str; 3]) -> Space {
    Space { name, columns, rows, has_quaternion: false }
}

const SPACES: [Space; 8] = [
    space("r2", "x,y", ["0,0", "1,0", "2,0.5"]),
    space("r3", "x,y,z", ["0,0,0", "1,0,0", "2,0,0.5"]),
    space("rn", "a,b,c,d", ["0,0,0,0", "1,0,0,0", "2,0,0,0.5"]),
    space("s2", "lat,lon", ["0,0", "0,10", "5,20"]),
    space("se2", "x,y,theta", ["0,0,0", "1,0,0", "2,0,0.5"]),
    space("sim2", "x,y,theta,scale", ["0,0,0,1", "1,0,0,1", "2,0,0,1.5"]),
    Space { has_quaternion: true, ..space("so3", "qx,qy,qz,qw", ["0,0,0,1", "0,0,0.6,0.8", "0,0,0.8,0.6"]) },
    Space {
        has_quaternion: true,
        ..space("se3", "x,y,z,qx,qy,qz,qw", ["0,0,0,0,0,0,1", "1,0,0,0,0,0,1", "2,0,0,0,0,0.6,0.8"])
    },
];

impl Space {
    fn order(&self, folder: &TempDir, columns: &str, rows: &[&str]) -> Output {
        let path = file(folder, "in.csv", &format!("{columns}\n{}\n", rows.join("\n")));
        reorder(&["order", &path, "--manifold", self.name, "--format", "indices"])
    }
    fn refuses(&self, folder: &TempDir, columns: &str, rows: &[&str], sentence: &str) {
        let output = self.order(folder, columns, rows);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{}: {said}", self.name);
        assert!(output.stdout.is_empty() && said.lines().count() == 1, "{}: {said}", self.name);
        assert!(said.starts_with("reorder: ") && said.trim_end().ends_with(sentence), "{}: {said}", self.name);
    }
    /// The rows with one field of the last one replaced.
    fn with_last(&self, field: usize, value: &str) -> Vec<String> {
        let mut fields: Vec<&str> = self.rows[2].split(',').collect();
        fields[field] = value;
        vec![self.rows[0].into(), self.rows[1].into(), fields.join(",")]
    }
}

#[test]
fn every_manifold_refuses_numbers_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    for space in &SPACES {
        for (field, column) in space.columns.split(',').enumerate() {
            for (value, shown) in [("NaN", "NaN"), ("inf", "inf"), ("-inf", "-inf"), ("1e999", "inf")] {
                let rows = space.with_last(field, value);
                let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
                let sentence = format!("in.csv, line 4: {column} is not finite: {shown}");
                space.refuses(&folder, space.columns, &rows, &sentence);
            }
        }
    }
}

#[test]
fn every_manifold_with_quaternions_refuses_the_zero_quaternion() {
    let folder = tempfile::tempdir().unwrap();
    for space in SPACES.iter().filter(|space| space.has_quaternion) {
        let fields = space.rows[2].split(',').count();
        let zero = vec!["0"; fields].join(",");
        let sentence = "in.csv, line 4: the quaternion is zero, so there is no orientation";
        space.refuses(&folder, space.columns, &[space.rows[0], space.rows[1], &zero], sentence);
    }
}

#[test]
fn every_manifold_answers_for_none_one_two_and_equal_points() {
    let folder = tempfile::tempdir().unwrap();
    for space in &SPACES {
        let [a, b, c] = space.rows;
        space.refuses(&folder, space.columns, &[], "in.csv holds no rows");
        space.refuses(&folder, space.columns, &[a], "in.csv: there is 1 point to order, but at least 2 are needed");
        let equal = "in.csv: all 3 points are equal up to rounding, so there is nothing to order";
        space.refuses(&folder, space.columns, &[c, c, c], equal);
        for rows in [[a, b], [c, a]] {
            assert_eq!(out(&space.order(&folder, space.columns, &rows)), "0\n1\n", "{}", space.name);
        }
        assert_eq!(out(&space.order(&folder, space.columns, &[a, c, b])), "0\n2\n1\n", "{}", space.name);
    }
}

#[test]
fn every_manifold_names_the_column_that_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    for space in SPACES.iter().filter(|space| space.name != "rn") {
        let names: Vec<&str> = space.columns.split(',').collect();
        for missing in &names {
            let present: Vec<&str> = names.iter().map(|name| if name == missing { "other" } else { name }).collect();
            let sentence = format!("in.csv has no column {missing}; its columns are {}", present.join(", "));
            space.refuses(&folder, &present.join(","), &space.rows, &sentence);
        }
    }
    // Here any columns will do, but one alone is no curve to order along.
    let sentence = "in.csv: the 1 columns a are not 2 to 8 coordinates";
    SPACES[2].refuses(&folder, "a", &["0", "1", "2"], sentence);
}
