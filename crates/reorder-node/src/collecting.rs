//! Poses that arrive one by one, until they make a set.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use r2r::geometry_msgs::msg::{Pose, PoseArray, PoseStamped};
use r2r::std_msgs::msg::Header;

use crate::message::stamp_ns;

/// The poses of one set so far.
#[derive(Default)]
pub(crate) struct Collecting {
    /// The frame of all of them, and the latest stamp.
    header: Header,
    poses: Vec<Pose>,
    /// Where the pose of a stamp in ns is; stamps of zero say nothing.
    stamped: HashMap<i64, usize>,
    /// When the last arrived.
    arrived: Option<Instant>,
}

/// What became of a pose.
#[derive(Debug, PartialEq)]
pub(crate) enum Taken {
    Added,
    /// It was there already: same stamp, same pose.
    Repeated,
    /// Another pose had its stamp; the later message is the correction of the earlier.
    Corrected,
    /// It is in another frame than those before, which no set can be.
    OtherFrame,
    /// There are more already than a set may have. Nothing says where another set would begin: all are ignored until none comes for a while.
    TooMany,
}

impl Collecting {
    /// Takes a pose; stamps may come in any order, and one of zero says nothing.
    /// One pose more than `most` is kept, so that the set is refused as too large.
    pub(crate) fn take(&mut self, at: Instant, message: PoseStamped, most: usize) -> Taken {
        let PoseStamped { header, pose } = message;
        if !self.poses.is_empty() && header.frame_id != self.header.frame_id {
            return Taken::OtherFrame;
        }
        self.arrived = Some(at);
        let stamp = stamp_ns(&header.stamp);
        if self.poses.is_empty() || stamp > stamp_ns(&self.header.stamp) {
            self.header = header;
        }
        let is_full = self.poses.len() > most;
        match self.stamped.get(&stamp).map(|&place| &mut self.poses[place]) {
            Some(known) if *known == pose => Taken::Repeated,
            Some(known) => {
                *known = pose;
                Taken::Corrected
            }
            None if is_full => Taken::TooMany,
            None => {
                if stamp != 0 {
                    self.stamped.insert(stamp, self.poses.len());
                }
                self.poses.push(pose);
                Taken::Added
            }
        }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.poses.len()
    }

    /// When nothing more is waited for, if nothing more comes.
    pub(crate) fn deadline(&self, quiet_s: f64) -> Option<Instant> {
        let last = self.arrived?;
        (quiet_s > 0.0).then(|| last + Duration::from_secs_f64(quiet_s))
    }

    /// The set, with when its last pose arrived; the next pose begins another.
    pub(crate) fn finish(&mut self) -> Option<(Instant, PoseArray)> {
        let Self { header, poses, arrived, .. } = std::mem::take(self);
        Some((arrived?, PoseArray { header, poses }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::header;

    fn pose(frame: &str, stamp_ns: i64, x: f64) -> PoseStamped {
        let mut message = PoseStamped { header: header(frame, stamp_ns), ..PoseStamped::default() };
        message.pose.position.x = x;
        message
    }

    #[test]
    fn odd_messages_are_told_from_new_poses() {
        let (mut set, now) = (Collecting::default(), Instant::now());
        assert!(set.finish().is_none() && set.deadline(1.0).is_none());
        for (message, taken) in [
            (pose("base", 5, 0.5), Taken::Added),
            (pose("base", 3, 0.3), Taken::Added),
            (pose("base", 5, 0.5), Taken::Repeated),
            (pose("base", 3, 0.4), Taken::Corrected),
            (pose("tool", 6, 0.6), Taken::OtherFrame),
            (pose("base", 0, 1.0), Taken::Added),
            (pose("base", 0, 1.0), Taken::Added),
        ] {
            assert_eq!(set.take(now, message, 10), taken);
        }
        assert_eq!((set.len(), set.deadline(0.0)), (4, None));
        assert_eq!(set.deadline(2.0), Some(now + Duration::from_secs(2)));
        let (_, array) = set.finish().unwrap();
        assert_eq!(array.poses.iter().map(|pose| pose.position.x).collect::<Vec<_>>(), [0.5, 0.4, 1.0, 1.0]);
        assert_eq!((array.header.frame_id.as_str(), stamp_ns(&array.header.stamp)), ("base", 5));
        assert_eq!((set.len(), set.take(now, pose("tool", 1, 0.0), 10)), (0, Taken::Added));
    }

    /// What comes after a set that is too large belongs to it: it must not become a set, and a motion, of its own.
    #[test]
    fn the_tail_of_a_set_that_is_too_large_is_no_set() {
        let (mut set, start) = (Collecting::default(), Instant::now());
        let at = |k: i64| start + Duration::from_millis(k as u64);
        let taken: Vec<Taken> = (1..=9).map(|k| set.take(at(k), pose("base", k, 0.1 * k as f64), 3)).collect();
        assert!(taken[..4].iter().all(|t| *t == Taken::Added) && taken[4..].iter().all(|t| *t == Taken::TooMany));
        // It is waited for until the last of them was quiet, and still refused as one of more than three.
        assert_eq!(set.deadline(1.0), Some(at(9) + Duration::from_secs(1)));
        assert_eq!(set.finish().unwrap().1.poses.len(), 4);
        assert!(set.finish().is_none());
    }
}
