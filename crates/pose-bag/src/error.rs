//! What can be wrong with a file of poses.

use se3_geom::InvalidPose;

use crate::cdr::CdrError;

/// Why a file of poses could not be read or written. Every message is one sentence that names the file and the place in it.
///
/// Lines are counted from 1, as editors do; messages of a topic, and poses of a message, are counted from 0, as `order` does.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// The operating system refused.
    #[error("{file}: {source}")]
    Io {
        /// The file or folder.
        file: String,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Neither the extension nor the first bytes tell the format.
    #[error("{file} is not a pose file: expected .csv, .tum, .txt, .kitti, .mcap, .db3 or the folder of a rosbag2 bag")]
    UnknownFormat {
        /// The file.
        file: String,
    },
    /// A table without rows.
    #[error("{file} holds no rows")]
    NoRows {
        /// File name.
        file: String,
    },
    /// There is no pose in the file.
    #[error("{file} holds no poses")]
    Empty {
        /// The file.
        file: String,
    },
    /// A text file holds bytes that are no text.
    #[error("{file}, line {line}: this is not UTF-8 text")]
    NotText {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
    },
    /// A line is so long that the file cannot be a table.
    #[error("{file}, line {line}: the line is longer than {limit} bytes")]
    LineTooLong {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Longest line accepted, in bytes.
        limit: usize,
    },
    /// The first line of a CSV file holds numbers instead of column names.
    #[error("{file}, line {line}: the header is missing; the first line names the columns, such as x,y,z,qx,qy,qz,qw")]
    NoHeader {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
    },
    /// Two columns have the same name.
    #[error("{file}, line {line}: column {column} occurs twice")]
    DuplicateColumn {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The name that occurs twice.
        column: String,
    },
    /// A column that is needed is not there.
    #[error("{file} has no column {column}; its columns are {present}")]
    MissingColumn {
        /// The file.
        file: String,
        /// The name that is needed.
        column: String,
        /// The names that are there.
        present: String,
    },
    /// A line has too few or too many fields.
    #[error("{file}, line {line}: {found} fields instead of {expected}")]
    FieldCount {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Fields a line has to have.
        expected: usize,
        /// Fields it has.
        found: usize,
    },
    /// A field is not a number.
    #[error("{file}, line {line}: {column} is not a number: {text:?}")]
    NotANumber {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// A field is NaN or infinite.
    #[error("{file}, line {line}: {column} is not finite: {value}")]
    NotFinite {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// A stamp of a track is out of range.
    #[error(
        "{file}, line {line}: the stamp {stamp} does not fit into 64 bits of nanoseconds (TUM has seconds, EuRoC nanoseconds)"
    )]
    StampRange {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What stands there.
        stamp: String,
    },
    /// A line is no pose.
    #[error("{file}, line {line}: {reason}")]
    InvalidPoseInLine {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Why it is none.
        reason: InvalidPose,
    },
    /// Twelve numbers that are no pose.
    #[error("{file}, line {line}: the 3 x 3 block is no rotation: it is {deviation:.6} away from one")]
    NotARotation {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Greatest entry of R Rᵀ − I, or 2 for a reflection.
        deviation: f64,
    },
    /// A pose in a message is none.
    #[error("{file}, topic {topic}, message {message}, pose {pose} (counted from 0): {reason}")]
    InvalidPoseInMessage {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0.
        message: usize,
        /// Pose in the message, from 0.
        pose: usize,
        /// Why it is none.
        reason: InvalidPose,
    },
    /// The bytes of a message do not follow its definition.
    #[error("{file}, topic {topic}, message {message} (counted from 0): {reason}")]
    Cdr {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0.
        message: usize,
        /// What is wrong with the bytes.
        reason: CdrError,
    },
    /// The messages of a topic are of another type than the one asked for.
    #[error("{file}, topic {topic}: the messages are {found}, not {expected}")]
    WrongType {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// The type asked for.
        expected: &'static str,
        /// The type that is there.
        found: String,
    },
    /// The bag's own definition of a type differs from the one that is read here.
    #[error("{file}, topic {topic}: the bag's {message_type} is not the standard one: {difference}")]
    OtherDefinition {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// The type.
        message_type: String,
        /// What differs, with the name of the field.
        difference: String,
    },
    /// A channel is encoded in something else than CDR.
    #[error("{file}, topic {topic}: the messages are encoded as {encoding:?} instead of cdr")]
    MessageEncoding {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Its encoding.
        encoding: String,
    },
    /// A topic changes its frame of reference.
    #[error("{file}, topic {topic}, message {message} (counted from 0): the frame is {found:?} after {expected:?}")]
    MixedFrames {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0.
        message: usize,
        /// Frame of the messages before.
        expected: String,
        /// Frame of this message.
        found: String,
    },
    /// A topic changes the frame whose poses it tells.
    #[error(
        "{file}, topic {topic}, message {message} (counted from 0): the child frame is {found:?} after {expected:?}"
    )]
    MixedChildFrames {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0.
        message: usize,
        /// Child frame of the messages before.
        expected: String,
        /// Child frame of this message.
        found: String,
    },
    /// A pose of a path is given in another frame than the path.
    #[error(
        "{file}, topic {topic}, message {message}, pose {pose} (counted from 0): the frame is {found:?} in a path of {expected:?}"
    )]
    MixedPath {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0.
        message: usize,
        /// Pose in the message, from 0.
        pose: usize,
        /// Frame of the path, or of its poses before where the path names none.
        expected: String,
        /// Frame of this pose.
        found: String,
    },
    /// A topic changes the type of its messages, so that what belongs together is unknown.
    #[error("{file}, topic {topic}, message {message} (counted from 0): it is a {found} after those of {expected}")]
    MixedTypes {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0.
        message: usize,
        /// Type of the messages before.
        expected: String,
        /// Type of this message.
        found: String,
    },
    /// The file does not begin like an MCAP file.
    #[error("{file} is not an MCAP file: its first bytes are not the MCAP magic")]
    NotMcap {
        /// The file.
        file: String,
    },
    /// The file ends before its end.
    #[error("{file} is cut off: it ends in the middle of a record after {messages_read} readable messages")]
    Truncated {
        /// The file.
        file: String,
        /// Messages, of all topics, that are whole before the cut.
        messages_read: u64,
    },
    /// The file is whole but its records contradict each other.
    #[error("{file} is damaged after {messages_read} readable messages: {reason}")]
    Corrupt {
        /// The file.
        file: String,
        /// Messages, of all topics, before the damage.
        messages_read: u64,
        /// What is wrong.
        reason: String,
    },
    /// The folder is no bag, or its `metadata.yaml` does not say what it has to.
    #[error("{file} is not the folder of a rosbag2 bag: {reason}")]
    NotABag {
        /// The folder.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// The bag is stored in a way that is not read here.
    #[error("{file}: bags with {feature} are not supported; `ros2 bag convert` makes an MCAP bag of it")]
    Unsupported {
        /// The file.
        file: String,
        /// What is not supported.
        feature: String,
    },
    /// No topic of the bag carries poses.
    #[error(
        "{file} has no topic with poses (PoseArray, PoseStamped, PoseWithCovarianceStamped, Odometry, Path, TFMessage); \
         its topics: {topics}"
    )]
    NoPoseTopic {
        /// The bag.
        file: String,
        /// Topics and types that are there.
        topics: String,
    },
    /// Several topics carry poses and none was chosen.
    #[error("{file} has several topics with poses, name one of them: {topics}")]
    SeveralPoseTopics {
        /// The bag.
        file: String,
        /// Topics and types to choose from.
        topics: String,
    },
    /// The topic asked for carries no poses, or is not there.
    #[error("{file} has no poses on topic {topic}; its topics: {topics}")]
    NotAPoseTopic {
        /// The bag.
        file: String,
        /// The topic asked for.
        topic: String,
        /// Topics and types that are there.
        topics: String,
    },
    /// Transforms between several pairs of frames were recorded, and none was chosen.
    #[error("{file}, topic {topic}: name one of the frame pairs {pairs}")]
    FramePair {
        /// The bag.
        file: String,
        /// The topic.
        topic: String,
        /// The pairs that are there, as `parent:child`.
        pairs: String,
    },
    /// No topic has the transforms that were asked for.
    #[error("{file} has no transforms {frames}; its topics of transforms: {topics}")]
    NoTransforms {
        /// The bag.
        file: String,
        /// The pair asked for, as `parent:child`.
        frames: String,
        /// Topics of type TFMessage that are there.
        topics: String,
    },
    /// What should be written is already there.
    #[error("{file} already exists and is not overwritten")]
    AlreadyExists {
        /// The bag.
        file: String,
    },
    /// A topic was declared with one type and is written with another.
    #[error("{file}, topic {topic}: a {written} is written to a topic of {declared}")]
    TopicType {
        /// The bag.
        file: String,
        /// The topic.
        topic: String,
        /// Type it was declared with.
        declared: String,
        /// Type of the message.
        written: String,
    },
    /// More poses than are held in memory.
    #[error(
        "{file}, topic {topic}, message {message} (counted from 0): here are more than the {limit} poses that are held of a bag"
    )]
    TooManyPoses {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// Message on the topic, from 0, with the first pose too many.
        message: usize,
        /// Most poses that are held.
        limit: usize,
    },
    /// The MCAP writer refused.
    #[error("{file} could not be written: {reason}")]
    Write {
        /// The bag.
        file: String,
        /// What it said.
        reason: String,
    },
}

impl BagError {
    /// Whether it says what part of a bag is lost, the rest being readable.
    pub fn is_loss(&self) -> bool {
        matches!(self, Self::Truncated { .. } | Self::Corrupt { .. } | Self::Io { .. })
    }

    /// Whether the operating system refused: that may pass, and reading again later may give more. All else is wrong with the
    /// file itself and stays so.
    pub fn may_pass(&self) -> bool {
        matches!(self, Self::Io { .. })
    }

    pub(crate) fn io(file: impl Into<String>) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.into();
        move |source| Self::Io { file, source }
    }
}
