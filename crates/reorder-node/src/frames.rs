//! Where frames are to each other over time, as told on `/tf` and `/tf_static`.

use std::collections::{HashMap, VecDeque};

use planner::se3_geom::Pose;

/// How far back transforms are remembered, as in tf2.
const MEMORY_NS: i64 = 10_000_000_000;
/// Between two samples at half a turn the way round is not defined.
const HALF_TURN_RAD: f64 = 1e-6;

/// Every frame that has a parent, by name.
#[derive(Debug, Default)]
pub(crate) struct Frames(HashMap<String, Edge>);

#[derive(Debug)]
struct Edge {
    parent: String,
    /// `parent_from_child`, by ascending stamp; one alone, whatever its stamp, where it is fixed.
    samples: VecDeque<(i64, Pose)>,
    fixed: bool,
}

/// Why there is no transform; the sentence ends at the frames.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum NoTransform {
    /// More may come, so it is worth waiting.
    #[error("nothing on /tf connects '{from}' with '{to}'")]
    NotConnected { from: String, to: String },
    /// Worth waiting too.
    #[error("the stamp is {ahead_s:.3} s later than the last transform of '{frame}' on /tf")]
    TooNew { frame: String, ahead_s: f64 },
    #[error("the stamp is {behind_s:.3} s earlier than the first transform of '{frame}' that is remembered")]
    TooOld { frame: String, behind_s: f64 },
}

impl NoTransform {
    /// Whether a later message may still bring it.
    pub(crate) fn may_come(&self) -> bool {
        !matches!(self, Self::TooOld { .. })
    }
}

impl Frames {
    /// Takes up `parent_from_child` at a time.
    pub(crate) fn insert(&mut self, parent: &str, child: &str, stamp_ns: i64, pose: Pose, fixed: bool) {
        let new = || Edge { parent: parent.to_owned(), samples: VecDeque::new(), fixed };
        let edge = self.0.entry(child.to_owned()).or_insert_with(new);
        let newest = edge.samples.back().map_or(i64::MIN, |(newest, _)| *newest);
        // A clock that was set back (a bag that starts again) makes all that was known worthless.
        if fixed || edge.fixed || edge.parent != parent || stamp_ns < newest.saturating_sub(MEMORY_NS) {
            *edge = new();
        }
        let place = edge.samples.partition_point(|(known, _)| *known < stamp_ns);
        match edge.samples.get_mut(place).filter(|(known, _)| *known == stamp_ns) {
            Some(known) => known.1 = pose,
            None => edge.samples.insert(place, (stamp_ns, pose)),
        }
        let newest = edge.samples.back().map_or(stamp_ns, |(newest, _)| *newest);
        while edge.samples.front().is_some_and(|(oldest, _)| *oldest < newest - MEMORY_NS) {
            edge.samples.pop_front();
        }
    }

    /// `to_from_from` at a time: the transform that takes coordinates in `from` to coordinates in `to`. A stamp of 0 asks for the latest.
    pub(crate) fn lookup(&self, to: &str, from: &str, stamp_ns: i64) -> Result<Pose, NoTransform> {
        let (up_from, up_to) = (self.ancestors(from), self.ancestors(to));
        let meeting = up_from.iter().find_map(|frame| Some((*frame, up_to.iter().position(|other| other == frame)?)));
        let Some((common, in_to)) = meeting else {
            return Err(NoTransform::NotConnected { from: from.to_owned(), to: to.to_owned() });
        };
        let in_from = up_from.iter().position(|frame| *frame == common).unwrap_or(0);
        let (climb, descend) = (&up_from[..in_from], &up_to[..in_to]);
        let stamp_ns = match stamp_ns {
            0 => self.latest_common(climb.iter().chain(descend)),
            stamp => stamp,
        };
        let along = |frames: &[&str]| {
            frames.iter().try_fold(Pose::identity(), |so_far, frame| Ok(self.at(frame, stamp_ns)? * so_far))
        };
        let common_from_from = along(climb)?;
        let common_from_to = along(descend)?;
        Ok(common_from_to.inverse() * common_from_from)
    }

    /// The frame, its parent, and so on; each once, so that a circle ends.
    fn ancestors<'a>(&'a self, frame: &'a str) -> Vec<&'a str> {
        let mut chain = vec![frame];
        while let Some(edge) = chain.last().and_then(|last| self.0.get(*last)) {
            if chain.contains(&edge.parent.as_str()) {
                break;
            }
            chain.push(&edge.parent);
        }
        chain
    }

    /// The latest time for which every moving edge has a sample.
    fn latest_common<'a>(&self, frames: impl Iterator<Item = &'a &'a str>) -> i64 {
        let newest = |frame: &&str| {
            let edge = self.0.get(*frame).filter(|edge| !edge.fixed)?;
            edge.samples.back().map(|(stamp, _)| *stamp)
        };
        frames.filter_map(newest).min().unwrap_or(0)
    }

    /// `parent_from_child` at a time, between samples along the straight line and the great circle.
    fn at(&self, child: &str, stamp_ns: i64) -> Result<Pose, NoTransform> {
        let edge = &self.0[child];
        let samples = &edge.samples;
        if edge.fixed {
            return Ok(samples[0].1);
        }
        let seconds = |ns: i64| ns as f64 * 1e-9;
        let next = samples.partition_point(|(known, _)| *known < stamp_ns);
        match (next.checked_sub(1).map(|before| samples[before]), samples.get(next)) {
            (_, Some((at, pose))) if *at == stamp_ns => Ok(*pose),
            (Some((before, a)), Some((after, b))) => {
                let part = (stamp_ns - before) as f64 / (after - before) as f64;
                // Half a turn between two samples: the nearer of them is as good as any way round.
                let nearer = if part < 0.5 { a } else { *b };
                Ok(a.try_lerp_slerp(b, part, HALF_TURN_RAD).unwrap_or(nearer))
            }
            (Some((newest, _)), None) => {
                Err(NoTransform::TooNew { frame: child.to_owned(), ahead_s: seconds(stamp_ns - newest) })
            }
            (None, first) => {
                let behind_s = first.map_or(0.0, |(first, _)| seconds(first - stamp_ns));
                Err(NoTransform::TooOld { frame: child.to_owned(), behind_s })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use planner::manipulator::nalgebra::{Isometry3, Vector3};

    use super::*;

    const SECOND: i64 = 1_000_000_000;

    fn pose(x: f64, about_z: f64) -> Pose {
        Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::new(0.0, 0.0, about_z))
    }

    /// base ← world → table → camera; the table turns, the rest is fixed.
    fn cell() -> Frames {
        let mut frames = Frames::default();
        frames.insert("world", "base", 0, pose(1.0, 0.0), true);
        frames.insert("table", "camera", 0, pose(0.5, 0.0), true);
        frames.insert("world", "table", SECOND, pose(2.0, 0.0), false);
        frames.insert("world", "table", 2 * SECOND, pose(4.0, 1.0), false);
        frames
    }

    #[test]
    fn a_transform_is_taken_at_its_time_between_samples() {
        let frames = cell();
        let found = frames.lookup("base", "camera", SECOND + SECOND / 4).unwrap();
        // A quarter of the way: the table at 2.5 m, turned by 0.25 rad.
        let expected = pose(1.0, 0.0).inverse() * pose(2.5, 0.25) * pose(0.5, 0.0);
        assert!((found.to_homogeneous() - expected.to_homogeneous()).norm() < 1e-15, "{found}");
        let back = frames.lookup("camera", "base", SECOND + SECOND / 4).unwrap();
        assert!((back * found).translation.vector.norm() < 1e-15);
        assert_eq!(frames.lookup("base", "base", 7).unwrap(), Pose::identity());
        let latest = frames.lookup("world", "camera", 0).unwrap();
        assert!((latest.translation.vector - (pose(4.0, 1.0) * pose(0.5, 0.0)).translation.vector).norm() < 1e-15);
    }

    #[test]
    fn what_is_not_known_is_said() {
        let frames = cell();
        let why = |to, from, at| frames.lookup(to, from, at).unwrap_err();
        assert_eq!(why("base", "moon", 0).to_string(), "nothing on /tf connects 'moon' with 'base'");
        let late = why("base", "camera", 3 * SECOND);
        assert_eq!(late.to_string(), "the stamp is 1.000 s later than the last transform of 'table' on /tf");
        let early = why("base", "camera", SECOND / 2);
        assert!(early.to_string().contains("0.500 s earlier") && !early.may_come() && late.may_come(), "{early}");
    }

    /// Ten seconds are remembered, circles end, and a clock that is set back starts afresh.
    #[test]
    fn odd_messages_do_no_harm() {
        let mut frames = Frames::default();
        for second in 0..100 {
            frames.insert("a", "b", second * SECOND, pose(second as f64, 0.0), false);
        }
        assert!(frames.0["b"].samples.len() == 11 && frames.lookup("a", "b", 50 * SECOND).is_err());
        frames.insert("a", "b", 3 * SECOND, pose(-1.0, 0.0), false);
        assert_eq!(frames.lookup("a", "b", 3 * SECOND).unwrap(), pose(-1.0, 0.0));
        let mut circle = Frames::default();
        circle.insert("a", "b", 0, pose(1.0, 0.0), true);
        circle.insert("b", "a", 0, pose(1.0, 0.0), true);
        assert!(circle.lookup("a", "nowhere", 0).is_err() && circle.lookup("a", "b", 0).is_ok());
        // Out of order, and twice.
        for (second, x) in [(5, 5.0), (4, 4.0), (5, 6.0)] {
            frames.insert("a", "b", second * SECOND, pose(x, 0.0), false);
        }
        assert_eq!(frames.lookup("a", "b", 5 * SECOND).unwrap(), pose(6.0, 0.0));
    }
}
