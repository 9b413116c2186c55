//! How many recorded trajectories `reorder order` puts back in order, and what its verdicts are worth.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::process::build_executables;

/// Where there is no folder of one's own: handwriting of the LASA data set.
const OURS: &str = "tests/data/handwriting";
/// Columns that tell the order, or that no manifold has.
const LEFT_OUT: [&str; 2] = ["t", "alt_m"];

/// What came of one recording.
struct Score {
    kind: String,
    /// Share of the true neighbours that are neighbours in the answer too; equal rows count as one point.
    adjacency: f64,
    verdict: String,
    /// Whether a doubt names a point that has a wrong neighbour in the answer.
    doubted_where_wrong: bool,
    seconds: f64,
}

impl Score {
    fn exact(&self) -> bool {
        self.adjacency == 1.0
    }
    fn is_vouched_for(&self) -> bool {
        self.verdict != "ambiguous"
    }
    /// A silent wrong order: certified and not exact, or plausible and wrong at more than one pair in fifty.
    fn is_false(&self) -> bool {
        self.verdict == "certified" && !self.exact() || self.verdict == "plausible" && self.adjacency < 0.98
    }
}

/// Shuffles every recording that `manifest.json` of a folder lists as `{"file", "kind"}`, rows in true order, has it ordered by the
/// released command, and prints how many came out right.
pub(crate) fn run(layout: &Layout, folder: Option<&Path>, most_rows: usize, seed: u64) -> Outcome {
    let ours = layout.root().join(OURS);
    let folder = folder.unwrap_or(&ours);
    let programs = build_executables(layout, &["build", "--release", "--package", "reorder-cli"])?;
    let program = programs.first().ok_or_else(|| Failure::step("cargo build", "no program was built".to_owned()))?;
    let manifest = folder.join("manifest.json");
    let text = fs::read_to_string(&manifest).map_err(Failure::io("read", &manifest))?;
    let bad = |why: String| Failure::step("reading", format!("{}: {why}", manifest.display()));
    let recordings: Vec<Value> = serde_json::from_str(&text).map_err(|error| bad(error.to_string()))?;
    let shuffled = layout.root().join("target/score.csv");
    let mut scores = Vec::new();
    for recording in &recordings {
        let field =
            |name: &str| recording[name].as_str().ok_or_else(|| bad(format!("an entry has no {name}: {recording}")));
        let (file, kind) = (field("file")?, field("kind")?);
        let rows = Rows::read(&folder.join(file), most_rows)?;
        let order = permutation(rows.lines.len(), seed);
        fs::write(&shuffled, rows.shuffled(&order)).map_err(Failure::io("write", &shuffled))?;
        let clock = Instant::now();
        let answer = ordered(layout, program, kind, &shuffled)?;
        let score = judged(kind, &rows, &order, &answer, clock.elapsed().as_secs_f64())
            .ok_or_else(|| Failure::step("reorder order", format!("its answer for {file} lacks something")))?;
        let claim = if score.is_false() { "  FALSE" } else { "" };
        println!(
            "{file:<44} {kind:<5} n={:<5} adjacency {:.4} {:<10} {:.2} s{claim}",
            order.len(),
            score.adjacency,
            score.verdict,
            score.seconds
        );
        scores.push(score);
    }
    print!("{}", summary(&scores));
    Ok(())
}

/// The text of the cells of every row that is kept.
struct Rows {
    header: String,
    lines: Vec<String>,
}

impl Rows {
    /// Evenly thinned to at most so many.
    fn read(file: &Path, most: usize) -> Outcome<Self> {
        let text = fs::read_to_string(file).map_err(Failure::io("read", file))?;
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let kept: Vec<usize> = (0..header.len()).filter(|&k| !LEFT_OUT.contains(&header[k])).collect();
        let cells = |line: &str| {
            let all: Vec<&str> = line.split(',').collect();
            kept.iter().filter_map(|&k| all.get(k).copied()).collect::<Vec<_>>().join(",")
        };
        let lines: Vec<String> = lines.filter(|line| !line.is_empty()).map(cells).collect();
        let stride = lines.len().div_ceil(most.max(1)).max(1);
        Ok(Self { header: cells(&header.join(",")), lines: lines.into_iter().step_by(stride).collect() })
    }
    fn shuffled(&self, order: &[usize]) -> String {
        let lines = order.iter().map(|&k| self.lines[k].as_str());
        std::iter::once(self.header.as_str()).chain(lines).collect::<Vec<_>>().join("\n") + "\n"
    }
    /// The same number for equal rows.
    fn names(&self) -> Vec<usize> {
        let mut known = HashMap::new();
        self.lines
            .iter()
            .map(|line| {
                let next = known.len();
                *known.entry(line).or_insert(next)
            })
            .collect()
    }
}

/// By Fisher and Yates, from numbers of the generator xorshift64* (S. Vigna, 2016).
fn permutation(count: usize, seed: u64) -> Vec<usize> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut rows: Vec<usize> = (0..count).collect();
    for k in (1..count).rev() {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        let random = state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33;
        rows.swap(k, random as usize % (k + 1));
    }
    rows
}

fn ordered(layout: &Layout, program: &Path, kind: &str, file: &Path) -> Outcome<Value> {
    let mut command: Command = layout.command(program);
    let output = command.args(["order", "--manifold", kind, "--format", "json"]).arg(file).output();
    let output = output.map_err(Failure::io("run", program))?;
    let said = || String::from_utf8_lossy(&output.stderr).trim().to_owned();
    if !output.status.success() {
        return Err(Failure::step("reorder order", said()));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| Failure::step("reorder order", error.to_string()))
}

/// Unordered pairs of consecutive points that differ.
fn neighbours(points: &[usize], closed: bool) -> HashSet<[usize; 2]> {
    let closing = closed.then(|| [points[points.len() - 1], points[0]]);
    let pairs = points.windows(2).map(|w| [w[0], w[1]]).chain(closing);
    pairs.filter(|[a, b]| a != b).map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

/// `None` where the answer lacks something.
fn judged(kind: &str, rows: &Rows, order: &[usize], answer: &Value, seconds: f64) -> Option<Score> {
    let names = rows.names();
    let named = |row: &Value| Some(names[*order.get(row.as_u64()? as usize)?]);
    let found: Vec<usize> = answer["order"].as_array()?.iter().map(named).collect::<Option<_>>()?;
    if found.len() != order.len() || found.is_empty() {
        return None;
    }
    let drawn = neighbours(&found, answer["topology"] == "closed");
    let truth = neighbours(&names, false);
    let kept = truth.iter().filter(|pair| drawn.contains(*pair)).count();
    // Of a closed curve the recording has no closing pair, so that a single pair too many is none.
    let wrong: HashSet<usize> = truth.symmetric_difference(&drawn).flatten().copied().collect();
    let names_wrong = |doubt: &Value| {
        doubt["at"].as_array().is_some_and(|at| at.iter().filter_map(named).any(|point| wrong.contains(&point)))
    };
    Some(Score {
        kind: kind.to_owned(),
        adjacency: kept as f64 / truth.len().max(1) as f64,
        verdict: answer["verdict"].as_str()?.to_owned(),
        doubted_where_wrong: answer["doubts"].as_array()?.iter().any(names_wrong),
        seconds,
    })
}

fn summary(scores: &[Score]) -> String {
    let mut by_kind: BTreeMap<&str, Vec<&Score>> = BTreeMap::new();
    for score in scores {
        by_kind.entry(&score.kind).or_default().push(score);
    }
    let mut text = String::new();
    for (kind, of_kind) in by_kind.into_iter().chain([("all", scores.iter().collect())]) {
        let count = |which: &dyn Fn(&Score) -> bool| of_kind.iter().filter(|score| which(score)).count();
        let mean = of_kind.iter().map(|score| score.adjacency).sum::<f64>() / of_kind.len().max(1) as f64;
        text += &format!(
            "{kind:<5} {:>3} recordings, {} exact, mean adjacency {mean:.4}; of the exact {} vouched for ({} certified); of {} wrong {} \
             doubted where they are; false claims {}; slowest {:.1} s\n",
            of_kind.len(),
            count(&Score::exact),
            count(&|s| s.exact() && s.is_vouched_for()),
            count(&|s| s.exact() && s.verdict == "certified"),
            count(&|s| !s.exact()),
            count(&|s| !s.exact() && s.doubted_where_wrong),
            count(&Score::is_false),
            of_kind.iter().map(|score| score.seconds).fold(0.0, f64::max),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn rows(lines: &[&str]) -> Rows {
        Rows { header: "x,y".to_owned(), lines: lines.iter().map(|&line| line.to_owned()).collect() }
    }

    fn judge(answer: &Value) -> Score {
        // Row k of what was ordered is the true row 4 − k; the true rows 1 and 3 are equal.
        judged("r2", &rows(&["0,0", "1,0", "2,0", "1,0", "1,1"]), &[4, 3, 2, 1, 0], answer, 0.5).unwrap()
    }

    #[test]
    fn an_exact_order_keeps_every_pair_whichever_of_equal_rows_comes_first() {
        let answer = json!({"order": [4, 1, 2, 3, 0], "topology": "open", "verdict": "certified", "doubts": []});
        let score = judge(&answer);
        assert!(score.exact() && score.is_vouched_for() && !score.is_false());
    }

    #[test]
    fn a_wrong_order_that_is_vouched_for_is_a_false_claim() {
        let line = rows(&["0,0", "1,0", "2,0", "3,0", "4,0", "5,0"]);
        let wrong = |verdict: &str, at: [usize; 2]| {
            let doubts = json!([{"at": at, "why": ""}]);
            let answer = json!({"order": [0, 1, 2, 4, 3, 5], "topology": "open", "verdict": verdict, "doubts": doubts});
            judged("r2", &line, &[0, 1, 2, 3, 4, 5], &answer, 0.5).unwrap()
        };
        let score = wrong("plausible", [2, 4]);
        assert_eq!(score.adjacency, 3.0 / 5.0);
        assert!(score.is_false() && score.doubted_where_wrong);
        assert!(wrong("certified", [0, 1]).is_false() && !wrong("certified", [0, 1]).doubted_where_wrong);
        assert!(!wrong("ambiguous", [2, 4]).is_false());
    }

    #[test]
    fn an_answer_that_lacks_rows_is_none() {
        let answer = json!({"order": [4, 1], "topology": "open", "verdict": "certified", "doubts": []});
        assert!(judged("r2", &rows(&["0,0", "1,0", "2,0"]), &[2, 1, 0], &answer, 0.0).is_none());
    }

    #[test]
    fn permutations_hold_every_row_once_and_differ_by_seed() {
        let mut sorted = permutation(100, 7);
        assert_ne!(sorted, permutation(100, 8));
        sorted.sort_unstable();
        assert_eq!(sorted, (0..100).collect::<Vec<_>>());
    }

    #[test]
    fn time_is_left_out_and_rows_are_thinned_evenly() {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), "t,x,y\n0,1,2\n1,3,4\n2,5,6\n3,7,8\n").unwrap();
        let rows = Rows::read(file.path(), 2).unwrap();
        assert_eq!((rows.header.as_str(), rows.lines), ("x,y", vec!["1,2".to_owned(), "5,6".to_owned()]));
    }
}
