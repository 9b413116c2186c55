//! `pose-bag`: reading beside rosbags, both storages, and a bag larger than the memory it may take.

use std::fs;

use crate::bench::figure::{Bound, Figure, Peer};
use crate::bench::peers::Peers;
use crate::bench::programs::{Program, run_in_turn};
use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;
use crate::python::output;

const REQUIREMENTS: &str = include_str!("bags/requirements.txt");
const ROSBAGS: &str = include_str!("bags/rosbags_reading.py");
const PEER: &str = "rosbags 0.11.9";
const OURS: &str = "reading";

pub(crate) fn measure(layout: &Layout) -> Outcome<Vec<Figure>> {
    let peers = Peers::of(layout, "bags", REQUIREMENTS)?;
    let ours = build_executables(layout, &["bench", "--no-run", "--package", "pose-bag", "--bench", OURS])?;
    let ours = ours.first().ok_or_else(|| Failure::step("cargo bench", "no program reading was built".to_owned()))?;
    let folder = layout.root().join("target/bench/bags");
    fs::create_dir_all(&folder).map_err(Failure::io("create", &folder))?;
    output(PEER, peers.python(layout, ROSBAGS).arg("write").arg(&folder))?;
    let large = folder.join("large.mcap");
    output(OURS, layout.command(ours).arg("write").arg(&large))?;

    let mut all = layout.command(ours);
    all.arg("all").arg(&folder);
    let mut one = layout.command(ours);
    one.arg("large").arg(&large);
    let mut theirs = peers.python(layout, ROSBAGS);
    theirs.arg("read").arg(&folder);
    let mut programs = [
        Program { name: OURS, command: all },
        Program { name: OURS, command: one },
        Program { name: PEER, command: theirs },
    ];
    let measured = run_in_turn(&mut programs);
    fs::remove_file(&large).map_err(Failure::io("remove", &large))?;
    let costs = measured?;
    let cost = |program: usize, name: &str| {
        let missing = || Failure::step(OURS, format!("nobody printed {name}"));
        costs.get(program).and_then(|costs| costs.get(name).copied()).ok_or_else(missing)
    };
    let beside = |name: &'static str, of: &str| {
        let peer = Some(Peer { name: PEER, value: cost(2, of)? });
        Ok(Figure { name, unit: "s", ours: cost(0, of)?, peer, bound: Bound::Ratio(0.2) })
    };
    let alone = |name: &'static str, unit, of: &str, most| {
        Ok(Figure { name, unit, ours: cost(1, of)?, peer: None, bound: Bound::Ours(most) })
    };
    Ok(vec![
        beside("1e5 PoseStamped, MCAP, decoded", "mcap s")?,
        beside("1e5 PoseStamped, SQLite, decoded", "sqlite3 s")?,
        alone("18 million PoseStamped, 2 GiB, decoded", "s", "large s", 60.0)?,
        alone("the same: peak memory", "MiB", "large MiB", 200.0)?,
    ])
}
