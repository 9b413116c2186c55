//! Sets of poses out of the messages of a bag.

use std::path::PathBuf;

use se3_geom::Pose;

use crate::BagError;
use crate::bag_reader::BagReader;
use crate::channel::BagMessage;
use crate::msg;
use crate::pose_set::{Grouping, Origin, PoseSet, Selection};
use crate::pose_topic::{Kind, Single, not_poses, pair, topic_of};

/// Frame pairs to choose from that are told.
const MAX_PAIRS: usize = 100;

/// Poses that are held of a bag, some 4 GB: a file of megabytes may unfold to any number of them.
const MAX_POSES: usize = 50_000_000;
/// What a set takes beside its poses, in poses: names, and the allocations that hold them.
const SET_IN_POSES: usize = 8;

/// Poses of one topic of a bag, and what of the bag is lost.
///
/// Messages are taken in the order in which they were recorded.
pub(crate) fn read_bag(bag: &BagReader, selection: &Selection) -> Result<(Vec<PoseSet>, Vec<BagError>), BagError> {
    read_at_most(MAX_POSES, bag, selection)
}

fn read_at_most(
    limit: usize,
    bag: &BagReader,
    selection: &Selection,
) -> Result<(Vec<PoseSet>, Vec<BagError>), BagError> {
    let topic = topic_of(bag, selection)?;
    let mut collector = Collector {
        selection,
        limit,
        held: 0,
        sets: Vec::new(),
        singles: Vec::new(),
        frame: None,
        child_frame: None,
        pairs: Vec::new(),
    };
    let mut topic_type: Option<String> = None;
    let losses = bag.for_each(&mut |message| {
        if message.topic() != topic {
            return Ok(());
        }
        let found = message.message_type();
        let expected = topic_type.get_or_insert_with(|| found.to_owned());
        if expected != found {
            return Err(BagError::MixedTypes {
                file: message.file.to_owned(),
                topic: topic.clone(),
                message: message.index(),
                expected: expected.clone(),
                found: found.to_owned(),
            });
        }
        let Some(kind) = Kind::of(found) else { return Err(not_poses(bag, &topic)?) };
        collector.take(kind, message)
    })?;
    if topic_type.is_none() {
        return Err(losses.into_iter().next().map_or_else(|| not_poses(bag, &topic), Ok)?);
    }
    let sets = collector.into_sets(bag, &topic)?;
    if sets.iter().all(|set| set.poses.is_empty()) {
        return Err(losses.into_iter().next().unwrap_or_else(|| BagError::Empty { file: bag.name().to_owned() }));
    }
    Ok((sets, losses))
}

/// A pose from a message that holds one.
struct Stamped {
    log_time_ns: u64,
    stamp_ns: i64,
    pose: Pose,
}

struct Collector<'a> {
    selection: &'a Selection,
    /// Most poses that may be held.
    limit: usize,
    held: usize,
    /// Of messages that hold many poses.
    sets: Vec<PoseSet>,
    singles: Vec<Stamped>,
    /// Frame of the poses of `singles`, and the file of the first.
    frame: Option<(String, PathBuf)>,
    /// Frame whose poses odometry tells.
    child_frame: Option<String>,
    /// Frame pairs of transforms, parent first, as they first came.
    pairs: Vec<(String, String)>,
}

impl Collector<'_> {
    fn take(&mut self, kind: Kind, message: &BagMessage<'_>) -> Result<(), BagError> {
        match kind {
            Kind::Array => {
                let array: msg::PoseArray = message.decode()?;
                self.take_set(message, array.header, &array.poses, None)
            }
            Kind::Path => {
                let mut path: msg::Path = message.decode()?;
                path.header.frame_id = frame_of(message, &path)?;
                let stamps_ns = path.poses.iter().map(|pose| pose.header.stamp.to_nanos()).collect();
                let poses: Vec<_> = path.poses.iter().map(|pose| pose.pose).collect();
                self.take_set(message, path.header, &poses, Some(stamps_ns))
            }
            Kind::Single(Single::Stamped) => {
                let stamped: msg::PoseStamped = message.decode()?;
                self.take_single(message, stamped.header, &stamped.pose, 0)
            }
            Kind::Single(Single::WithCovariance) => {
                let stamped: msg::PoseWithCovarianceStamped = message.decode()?;
                self.take_single(message, stamped.header, &stamped.pose.pose, 0)
            }
            Kind::Single(Single::Odometry) => {
                let odometry: msg::Odometry = message.decode()?;
                self.same_child_frame(message, odometry.child_frame_id)?;
                self.take_single(message, odometry.header, &odometry.pose.pose, 0)
            }
            Kind::Transforms => self.take_transforms(message),
        }
    }

    fn hold(&mut self, message: &BagMessage<'_>, poses: usize) -> Result<(), BagError> {
        self.held += poses;
        if self.held <= self.limit {
            return Ok(());
        }
        Err(BagError::TooManyPoses {
            file: message.file.to_owned(),
            topic: message.topic().to_owned(),
            message: message.index(),
            limit: self.limit,
        })
    }

    fn take_set(
        &mut self,
        message: &BagMessage<'_>,
        header: msg::Header,
        poses: &[msg::Pose],
        stamps_ns: Option<Vec<i64>>,
    ) -> Result<(), BagError> {
        // A set takes room without poses too, and its frame may have a long name.
        self.hold(message, poses.len() + SET_IN_POSES + header.frame_id.len() / size_of::<Pose>())?;
        let convert = |(index, pose)| checked(message, index, pose);
        let poses = poses.iter().enumerate().map(convert).collect::<Result<_, _>>()?;
        let origin = Origin {
            file: message.file.into(),
            topic: Some(message.topic().to_owned()),
            message: Some(message.index()),
        };
        let log_time_ns = message.log_time_ns;
        self.sets.push(PoseSet { frame_id: header.frame_id, poses, stamps_ns, log_time_ns, origin });
        Ok(())
    }

    fn take_single(
        &mut self,
        message: &BagMessage<'_>,
        header: msg::Header,
        pose: &msg::Pose,
        index: usize,
    ) -> Result<(), BagError> {
        self.hold(message, 1)?;
        let pose = checked(message, index, pose)?;
        let (expected, _) = self.frame.get_or_insert_with(|| (header.frame_id.clone(), message.file.into()));
        if *expected != header.frame_id {
            return Err(BagError::MixedFrames {
                file: message.file.to_owned(),
                topic: message.topic().to_owned(),
                message: message.index(),
                expected: expected.clone(),
                found: header.frame_id,
            });
        }
        let (log_time_ns, stamp_ns) = (message.log_time_ns, header.stamp.to_nanos());
        self.singles.push(Stamped { log_time_ns, stamp_ns, pose });
        Ok(())
    }

    /// Of a topic that tells of two things in turn no curve is made.
    fn same_child_frame(&mut self, message: &BagMessage<'_>, found: String) -> Result<(), BagError> {
        let expected = self.child_frame.get_or_insert_with(|| found.clone());
        if *expected == found {
            return Ok(());
        }
        Err(BagError::MixedChildFrames {
            file: message.file.to_owned(),
            topic: message.topic().to_owned(),
            message: message.index(),
            expected: expected.clone(),
            found,
        })
    }

    fn take_transforms(&mut self, message: &BagMessage<'_>) -> Result<(), BagError> {
        let transforms = message.decode::<msg::TfMessage>()?.transforms;
        for (index, transform) in transforms.into_iter().enumerate() {
            let pair = pair(&transform);
            if self.pairs.len() < MAX_PAIRS && !self.pairs.contains(&pair) {
                self.pairs.push(pair.clone());
            }
            if self.selection.frames.as_ref().or(self.pairs.first()) == Some(&pair) {
                let (t, orientation) = (transform.transform.translation, transform.transform.rotation);
                let pose = msg::Pose { position: msg::Point { x: t.x, y: t.y, z: t.z }, orientation };
                let header = msg::Header { stamp: transform.header.stamp, frame_id: pair.0 };
                self.take_single(message, header, &pose, index)?;
            }
        }
        Ok(())
    }

    fn into_sets(mut self, bag: &BagReader, topic: &str) -> Result<Vec<PoseSet>, BagError> {
        let is_undecided = match &self.selection.frames {
            None => self.pairs.len() > 1,
            Some(_) => !self.pairs.is_empty() && self.singles.is_empty(),
        };
        if is_undecided {
            let pairs: Vec<_> = self.pairs.iter().map(|(parent, child)| format!("{parent}:{child}")).collect();
            let (file, topic) = (bag.name().to_owned(), topic.to_owned());
            return Err(BagError::FramePair { file, topic, pairs: pairs.join(", ") });
        }
        let mut sets = self.sets;
        sets.sort_by_key(|set| set.log_time_ns);
        self.singles.sort_by_key(|stamped| stamped.log_time_ns);
        let (frame_id, file) = self.frame.unwrap_or_default();
        let (mut begun_ns, mut last_ns) = (0, 0);
        for Stamped { log_time_ns, stamp_ns, pose } in self.singles {
            let begins = sets.is_empty()
                || match self.selection.grouping {
                    Grouping::Whole => false,
                    Grouping::Window { length_ns } => log_time_ns - begun_ns >= length_ns,
                    Grouping::Gap { longest_ns } => log_time_ns - last_ns > longest_ns,
                };
            if begins {
                begun_ns = log_time_ns;
                let origin = Origin { file: file.clone(), topic: Some(topic.to_owned()), message: None };
                let (frame_id, stamps_ns) = (frame_id.clone(), Some(Vec::new()));
                sets.push(PoseSet { frame_id, poses: Vec::new(), stamps_ns, log_time_ns, origin });
            }
            last_ns = log_time_ns;
            if let Some(PoseSet { poses, stamps_ns: Some(stamps_ns), .. }) = sets.last_mut() {
                poses.push(pose);
                stamps_ns.push(stamp_ns);
            }
        }
        Ok(sets)
    }
}

/// The frame of a path and of every pose in it; an empty one says nothing.
fn frame_of(message: &BagMessage<'_>, path: &msg::Path) -> Result<String, BagError> {
    let of_poses = || path.poses.iter().map(|pose| &pose.header.frame_id);
    let mut named = [&path.header.frame_id].into_iter().chain(of_poses()).filter(|frame| !frame.is_empty());
    let expected = named.next().cloned().unwrap_or_default();
    match of_poses().enumerate().find(|(_, frame)| !frame.is_empty() && **frame != expected) {
        None => Ok(expected),
        Some((pose, found)) => Err(BagError::MixedPath {
            file: message.file.to_owned(),
            topic: message.topic().to_owned(),
            message: message.index(),
            pose,
            expected,
            found: found.clone(),
        }),
    }
}

fn checked(message: &BagMessage<'_>, index: usize, pose: &msg::Pose) -> Result<Pose, BagError> {
    pose.to_pose().map_err(|reason| BagError::InvalidPoseInMessage {
        file: message.file.to_owned(),
        topic: message.topic().to_owned(),
        message: message.index(),
        pose: index,
        reason,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BagWriter;

    #[test]
    fn no_more_poses_are_held_than_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("many.mcap");
        let pose = msg::Pose::from(&Pose::identity());
        let mut bag = BagWriter::create(&path).unwrap();
        for time_ns in 0..5 {
            bag.write("/arrays", time_ns, &msg::PoseArray { header: msg::Header::default(), poses: vec![pose; 9] })
                .unwrap();
            bag.write("/tool", time_ns, &msg::PoseStamped { header: msg::Header::default(), pose }).unwrap();
        }
        bag.finish().unwrap();
        let bag = BagReader::open(&path).unwrap();
        let read = |topic: &str, limit| {
            read_at_most(limit, &bag, &Selection { topic: Some(topic.into()), ..Selection::default() })
        };
        // An array counts as some poses more than it holds: 17.
        assert_eq!(read("/arrays", 85).unwrap().0.len(), 5);
        assert_eq!(read("/tool", 5).unwrap().0[0].poses.len(), 5);
        for (topic, limit, message) in [("/arrays", 84, 4), ("/arrays", 35, 2), ("/tool", 4, 4)] {
            let place = format!("{}, topic {topic}, message {message} (counted from 0)", path.display());
            let expected = format!("{place}: here are more than the {limit} poses that are held of a bag");
            assert_eq!(read(topic, limit).unwrap_err().to_string(), expected);
        }
    }
}
