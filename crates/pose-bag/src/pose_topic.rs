//! The topic that is meant.

use std::collections::BTreeMap;

use crate::BagError;
use crate::bag_reader::BagReader;
use crate::msg::{self, Message};
use crate::pose_set::Selection;

/// The topic of a selection: the one that is named, the one with the transforms that are named, or the only one there is.
pub(crate) fn topic_of(bag: &BagReader, selection: &Selection) -> Result<String, BagError> {
    match (&selection.topic, &selection.frames) {
        (Some(topic), _) => Ok(topic.clone()),
        (None, Some(frames)) => choose_transforms(bag, frames),
        (None, None) => choose(bag),
    }
}

pub(crate) fn not_poses(bag: &BagReader, topic: &str) -> Result<BagError, BagError> {
    let topics = list(&bag.topics()?.0, |_| true);
    Ok(BagError::NotAPoseTopic { file: bag.name().to_owned(), topic: topic.to_owned(), topics })
}

/// What a message with poses is. Where no topic is named, a later kind is chosen only where there is none of an earlier: a path is
/// mostly made of the poses, and transforms are everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Array,
    Single(Single),
    Path,
    Transforms,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Single {
    Stamped,
    WithCovariance,
    Odometry,
}

impl Kind {
    pub(crate) fn of(message_type: &str) -> Option<Self> {
        Some(match message_type {
            msg::PoseArray::TYPE => Self::Array,
            msg::PoseStamped::TYPE => Self::Single(Single::Stamped),
            msg::PoseWithCovarianceStamped::TYPE => Self::Single(Single::WithCovariance),
            msg::Odometry::TYPE => Self::Single(Single::Odometry),
            msg::Path::TYPE => Self::Path,
            msg::TfMessage::TYPE => Self::Transforms,
            _ => return None,
        })
    }

    fn rank(self) -> u8 {
        match self {
            Self::Array | Self::Single(_) => 0,
            Self::Path => 1,
            Self::Transforms => 2,
        }
    }
}

fn choose(bag: &BagReader) -> Result<String, BagError> {
    let (topics, losses) = bag.topics()?;
    let kinds: Vec<_> = topics.iter().filter_map(|(topic, of)| Some((topic, Kind::of(of)?))).collect();
    let file = || bag.name().to_owned();
    let Some(rank) = kinds.iter().map(|(_, kind)| kind.rank()).min() else {
        let none = || BagError::NoPoseTopic { file: file(), topics: list(&topics, |_| true) };
        return Err(losses.into_iter().next().unwrap_or_else(none));
    };
    let mut foremost = kinds.iter().filter(|(_, kind)| kind.rank() == rank);
    match (foremost.next(), foremost.next()) {
        (Some((topic, _)), None) => Ok((*topic).clone()),
        _ => Err(BagError::SeveralPoseTopics { file: file(), topics: list(&topics, |of| Kind::of(of).is_some()) }),
    }
}

/// The topic with the transforms between two frames.
fn choose_transforms(bag: &BagReader, frames: &(String, String)) -> Result<String, BagError> {
    let (mut topics, losses) = bag.topics()?;
    topics.retain(|_, message_type| message_type == msg::TfMessage::TYPE);
    let mut found = topics.clone();
    // Of a single one it is said later which pairs it has.
    if topics.len() > 1 {
        found.clear();
        bag.for_each(&mut |message| {
            let Some((topic, of)) =
                topics.get_key_value(message.topic()).filter(|(topic, _)| !found.contains_key(*topic))
            else {
                return Ok(());
            };
            if message.decode::<msg::TfMessage>()?.transforms.iter().any(|transform| pair(transform) == *frames) {
                found.insert(topic.clone(), of.clone());
            }
            Ok(())
        })?;
    }
    let file = bag.name().to_owned();
    match found.len() {
        0 => Err(losses.into_iter().next().unwrap_or_else(|| {
            let (frames, topics) = (format!("{}:{}", frames.0, frames.1), list(&topics, |_| true));
            BagError::NoTransforms { file, frames, topics }
        })),
        1 => Ok(found.into_keys().collect()),
        _ => Err(BagError::SeveralPoseTopics { file, topics: list(&found, |_| true) }),
    }
}

/// Parent and child frame, without the leading slashes of old.
pub(crate) fn pair(transform: &msg::TransformStamped) -> (String, String) {
    let bare = |frame: &str| frame.trim_start_matches('/').to_owned();
    (bare(&transform.header.frame_id), bare(&transform.child_frame_id))
}

fn list(topics: &BTreeMap<String, String>, is_listed: impl Fn(&str) -> bool) -> String {
    let listed = topics.iter().filter(|(_, message_type)| is_listed(message_type));
    let listed: Vec<_> = listed.map(|(topic, message_type)| format!("{topic} ({message_type})")).collect();
    if listed.is_empty() { "none".to_owned() } else { listed.join(", ") }
}
