//! Poses out of bags.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use se3_geom::Pose;
use serde::de::DeserializeOwned;

use crate::BagError;
use crate::cdr::decode;
use crate::mcap_messages::{RawMessage, for_each_message};
use crate::msg::{self, Message};
use crate::pose_set::{Origin, PoseSet};

/// Type of the messages of every topic that has messages.
type Topics = BTreeMap<String, String>;

/// Poses of one topic of a bag, which consists of MCAP files; `bag` names it in errors.
///
/// Messages are taken in the order in which they were recorded.
pub(crate) fn read_bag(bag: &Path, files: &[PathBuf], topic: Option<&str>) -> Result<Vec<PoseSet>, BagError> {
    let name = bag.display().to_string();
    let mut topics = Topics::new();
    for file in files {
        for_each_message(file, &mut |message| {
            topics.entry(message.channel.topic.clone()).or_insert_with(|| message.channel.message_type.clone());
            Ok(())
        })?;
    }
    let topic = choose(&name, &topics, topic)?;
    let mut collector = Collector { topic, messages: 0, sets: Vec::new() };
    for file in files {
        for_each_message(file, &mut |message| collector.take(file, &message))?;
    }
    if collector.sets.iter().all(|(_, set)| set.poses.is_empty()) {
        return Err(BagError::Empty { file: name });
    }
    Ok(collector.into_sets())
}

fn is_pose_type(message_type: &str) -> bool {
    [msg::PoseArray::TYPE, msg::PoseStamped::TYPE].contains(&message_type)
}

fn choose(bag: &str, topics: &Topics, wanted: Option<&str>) -> Result<String, BagError> {
    let file = || bag.to_owned();
    let list = |only_poses: bool| {
        let listed = topics.iter().filter(|(_, message_type)| !only_poses || is_pose_type(message_type));
        let listed: Vec<_> = listed.map(|(topic, message_type)| format!("{topic} ({message_type})")).collect();
        if listed.is_empty() { "none".to_owned() } else { listed.join(", ") }
    };
    if let Some(topic) = wanted {
        return match topics.get(topic) {
            Some(message_type) if is_pose_type(message_type) => Ok(topic.to_owned()),
            _ => Err(BagError::NotAPoseTopic { file: file(), topic: topic.into(), topics: list(false) }),
        };
    }
    let mut with_poses = topics.iter().filter(|(_, message_type)| is_pose_type(message_type));
    match (with_poses.next(), with_poses.next()) {
        (Some((topic, _)), None) => Ok(topic.clone()),
        (None, _) => Err(BagError::NoPoseTopic { file: file(), topics: list(false) }),
        (Some(_), Some(_)) => Err(BagError::SeveralPoseTopics { file: file(), topics: list(true) }),
    }
}

struct Collector {
    topic: String,
    /// Messages of the topic so far.
    messages: usize,
    /// With the log time of each set; the poses of stamped messages are sets of one until the end.
    sets: Vec<(u64, PoseSet)>,
}

impl Collector {
    fn take(&mut self, file: &Path, message: &RawMessage<'_>) -> Result<(), BagError> {
        if message.channel.topic != self.topic {
            return Ok(());
        }
        let place = Place { file, topic: &self.topic, message: self.messages };
        let encoding = &message.channel.encoding;
        if encoding != "cdr" {
            let (file, topic) = (place.file(), self.topic.clone());
            return Err(BagError::MessageEncoding { file, topic, encoding: encoding.clone() });
        }
        let (header, poses, stamps_ns) = if message.channel.message_type == msg::PoseArray::TYPE {
            let array: msg::PoseArray = place.decode(message.data)?;
            (array.header, place.poses(&array.poses)?, None)
        } else {
            let stamped: msg::PoseStamped = place.decode(message.data)?;
            let stamps_ns = vec![stamped.header.stamp.to_nanos()];
            (stamped.header, place.poses(&[stamped.pose])?, Some(stamps_ns))
        };
        let origin = Origin { file: file.to_path_buf(), topic: Some(self.topic.clone()), message: Some(self.messages) };
        let set = PoseSet { frame_id: header.frame_id, poses, stamps_ns, origin };
        if let Some((_, first)) = self.sets.first().filter(|_| set.stamps_ns.is_some())
            && first.frame_id != set.frame_id
        {
            return Err(BagError::MixedFrames {
                file: place.file(),
                topic: self.topic.clone(),
                message: self.messages,
                expected: first.frame_id.clone(),
                found: set.frame_id,
            });
        }
        self.sets.push((message.log_time_ns, set));
        self.messages += 1;
        Ok(())
    }

    fn into_sets(mut self) -> Vec<PoseSet> {
        self.sets.sort_by_key(|(log_time_ns, _)| *log_time_ns);
        let mut sets: Vec<PoseSet> = Vec::new();
        for (_, set) in self.sets {
            match (sets.last_mut(), set.stamps_ns) {
                (Some(PoseSet { poses, stamps_ns: Some(stamps), origin, .. }), Some(more)) => {
                    poses.extend(set.poses);
                    stamps.extend(more);
                    origin.message = None;
                }
                (_, stamps_ns) => sets.push(PoseSet { stamps_ns, ..set }),
            }
        }
        sets
    }
}

/// Where a message was found.
struct Place<'a> {
    file: &'a Path,
    topic: &'a str,
    message: usize,
}

impl Place<'_> {
    fn file(&self) -> String {
        self.file.display().to_string()
    }

    fn decode<M: DeserializeOwned>(&self, data: &[u8]) -> Result<M, BagError> {
        let (file, topic) = (self.file(), self.topic.to_owned());
        decode(data).map_err(|reason| BagError::Cdr { file, topic, message: self.message, reason })
    }

    fn poses(&self, poses: &[msg::Pose]) -> Result<Vec<Pose>, BagError> {
        let convert = |(index, pose): (usize, &msg::Pose)| {
            pose.to_pose().map_err(|reason| BagError::InvalidPoseInMessage {
                file: self.file(),
                topic: self.topic.to_owned(),
                message: self.message,
                pose: index,
                reason,
            })
        };
        poses.iter().enumerate().map(convert).collect()
    }
}
