//! Our figures beside those of the libraries that others would use, measured in one run on this machine.
//!
//! Each area is one file here that names its figures, its programs and their bounds. Every program prints one JSON object of
//! costs by name; the programs take turns for some rounds, so that a busy spell of the machine falls on all of them, and the
//! median over the rounds counts.

mod bags;
mod figure;
mod geometry;
mod manipulator;
mod node;
mod ordering;
mod peers;
mod programs;
mod python;

use std::fs;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use figure::Figure;

type Measure = fn(&Layout) -> Outcome<Vec<Figure>>;

/// What can be measured. A new area is a file and a line here.
const AREAS: [(&str, Measure); 6] = [
    ("bags", bags::measure),
    ("geometry", geometry::measure),
    ("manipulator", manipulator::measure),
    ("node", node::measure),
    ("ordering", ordering::measure),
    ("python", python::measure),
];

/// Measures an area, writes `target/bench/AREA.json` and prints it as a table. A bound that is missed is a figure, not a failure.
pub(crate) fn run(layout: &Layout, area: &str) -> Outcome {
    let Some((_, measure)) = AREAS.iter().find(|(name, _)| *name == area) else {
        let known = AREAS.map(|(name, _)| name).join(", ");
        return Err(Failure::UnknownArea { area: area.to_owned(), known });
    };
    let folder = layout.root().join("target/bench");
    fs::create_dir_all(&folder).map_err(Failure::io("create", &folder))?;
    let figures = measure(layout)?;
    let file = folder.join(area).with_extension("json");
    fs::write(&file, format!("{:#}\n", figure::json(&figures))).map_err(Failure::io("write", &file))?;
    println!("\n{}", file.display());
    println!("{}", figure::table(&figures));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_area_is_refused_in_one_sentence_that_names_the_known_ones() {
        let folder = tempfile::tempdir().unwrap();
        let failure = run(&Layout::at(folder.path()), "astrology").unwrap_err().to_string();
        assert_eq!(
            failure,
            "there is no benchmark of astrology: choose one of bags, geometry, manipulator, node, ordering, python"
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing was made for it");
    }
}
