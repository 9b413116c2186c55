//! How bags are replayed.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use planner::manipulator::Robot;
use planner::pose_bag::{Grouping, Selection};
use planner::reorder::{Options, TopologyChoice, Verdict, Weight};

/// What is done with every bag.
#[derive(Debug, Clone)]
pub struct Task {
    /// The topics with poses, each once; where none is named, the only one of a bag.
    pub topics: Vec<String>,
    /// Parent and child of the transforms that are meant, without leading slash, where a topic holds transforms.
    pub frames: Option<(String, String)>,
    /// Which messages with one pose each belong together.
    pub grouping: Grouping,
    /// Open curves, closed ones, or told from the poses.
    pub topology: TopologyChoice,
    /// How many metres count as much as one radian.
    pub weight: Weight,
    /// Whether orders are compared with the recorded ones.
    pub score: bool,
    /// The robot that trajectories are planned for.
    pub robot: Option<Robot>,
    /// The least certain order that is planned.
    pub minimum_verdict: Verdict,
}

impl Default for Task {
    /// The order of the only topic, by the weight that its poses tell; nothing is planned.
    fn default() -> Self {
        Self {
            topics: Vec::new(),
            frames: None,
            grouping: Grouping::Whole,
            topology: TopologyChoice::Auto,
            weight: Weight::Auto,
            score: false,
            robot: None,
            minimum_verdict: Verdict::Plausible,
        }
    }
}

impl Task {
    /// One for each topic.
    pub(crate) fn selections(&self) -> Vec<Selection> {
        let selection = |topic: Option<&String>| Selection {
            topic: topic.cloned(),
            frames: self.frames.clone(),
            grouping: self.grouping,
        };
        if self.topics.is_empty() {
            return vec![selection(None)];
        }
        let mut seen = HashSet::new();
        self.topics.iter().filter(|topic| seen.insert(*topic)).map(|topic| selection(Some(topic))).collect()
    }

    pub(crate) fn options(&self) -> Options {
        Options { topology: self.topology, ..Options::default() }
    }

    /// All of it, and what the program was built from, in words: an output that was made by other settings is made again.
    pub(crate) fn settings(&self) -> String {
        let of_robot = self.robot.as_ref().map(|robot| {
            let mut hasher = DefaultHasher::new();
            format!("{robot:?}").hash(&mut hasher);
            format!("{} {:016x}", robot.name, hasher.finish())
        });
        let (sources, selections, options) = (env!("REORDER_SOURCES"), self.selections(), self.options());
        let (weight, score, minimum_verdict) = (self.weight, self.score, self.minimum_verdict);
        format!("{sources} {selections:?} {options:?} {weight:?} {score} {minimum_verdict:?} {of_robot:?}")
    }
}
