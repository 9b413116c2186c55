//! Sentences for people: on the console, and on `/rosout`, which r2r leaves out.

use std::fmt::Display;
use std::time::{Duration, SystemTime};

use r2r::rcl_interfaces::msg::Log as Message;
use r2r::{Node, Publisher, QosProfile};

use crate::message::time;

/// As of every ROS 2 node.
const KEPT: usize = 1000;
const KEPT_FOR: Duration = Duration::from_secs(10);

/// The node's own log.
#[derive(Clone)]
pub(crate) struct Log {
    name: String,
    rosout: Publisher<Message>,
}

impl Log {
    pub(crate) fn create(node: &mut Node) -> r2r::Result<Self> {
        let qos = QosProfile::default().reliable().transient_local().keep_last(KEPT).lifespan(KEPT_FOR);
        Ok(Self { name: node.logger().to_owned(), rosout: node.create_publisher("/rosout", qos)? })
    }

    pub(crate) fn info(&self, sentence: impl Display) {
        r2r::log_info!(&self.name, "{sentence}");
        self.publish(Message::INFO as u8, &sentence);
    }

    pub(crate) fn warn(&self, sentence: impl Display) {
        r2r::log_warn!(&self.name, "{sentence}");
        self.publish(Message::WARN as u8, &sentence);
    }

    pub(crate) fn error(&self, sentence: impl Display) {
        r2r::log_error!(&self.name, "{sentence}");
        self.publish(Message::ERROR as u8, &sentence);
    }

    fn publish(&self, level: u8, sentence: &dyn Display) {
        let since_epoch = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let stamp = time(i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX));
        let message =
            Message { stamp, level, name: self.name.clone(), msg: sentence.to_string(), ..Message::default() };
        // Where even this fails, the console has it.
        let _ = self.rosout.publish(&message);
    }
}
