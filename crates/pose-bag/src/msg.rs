//! The ROS 2 messages that are read and written here, field for field as their `.msg` files (folder `msg/`) define them.

use se3_geom::{InvalidPose, Pose as SpatialPose, pose_from_xyzw, xyzw_from_rotation};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

mod markers;
mod states;

pub use markers::{ColorRgba, CompressedImage, Marker, MarkerArray, MeshFile, UvCoordinate};
pub use states::{
    JointState, Odometry, PoseWithCovariance, PoseWithCovarianceStamped, TfMessage, Transform, TransformStamped, Twist,
    TwistWithCovariance, Vector3,
};

/// A message type that a bag can hold: its CDR form is the one `serde` derives from the order of the fields.
pub trait Message: Serialize + DeserializeOwned {
    /// Full name, such as `geometry_msgs/msg/Pose`.
    const TYPE: &'static str;
    /// The `.msg` text with the text of every type it is made of, as MCAP stores it under `ros2msg`.
    const DEFINITION: &'static str;
    /// Hash of the type description (REP 2016), as ROS 2 Jazzy computes it.
    const TYPE_HASH: &'static str;
}

/// `builtin_interfaces/msg/Time`: a moment since the epoch.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds, rounded down.
    pub sec: i32,
    /// Nanoseconds from there, below 10⁹.
    pub nanosec: u32,
}

const NANOSECONDS: i64 = 1_000_000_000;

impl Time {
    /// The moment that many nanoseconds after the epoch; `None` where the seconds leave an `i32` (before 1901, after 2038).
    pub fn from_nanos(nanos: i64) -> Option<Self> {
        let sec = i32::try_from(nanos.div_euclid(NANOSECONDS)).ok()?;
        let nanosec = u32::try_from(nanos.rem_euclid(NANOSECONDS)).ok()?;
        Some(Self { sec, nanosec })
    }

    /// Nanoseconds since the epoch.
    pub fn to_nanos(self) -> i64 {
        i64::from(self.sec) * NANOSECONDS + i64::from(self.nanosec)
    }
}

/// `builtin_interfaces/msg/Duration`: a span of time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds, rounded down.
    pub sec: i32,
    /// Nanoseconds from there, below 10⁹.
    pub nanosec: u32,
}

/// `std_msgs/msg/Header`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// When.
    pub stamp: Time,
    /// In which frame.
    pub frame_id: String,
}

/// `geometry_msgs/msg/Point`, in metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// `geometry_msgs/msg/Quaternion`, in the order x, y, z, w.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// `geometry_msgs/msg/Pose`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Where.
    pub position: Point,
    /// Turned how.
    pub orientation: Quaternion,
}

impl Pose {
    /// The pose these numbers describe.
    ///
    /// # Errors
    /// [`InvalidPose`] where a number is not finite or the quaternion is no rotation.
    pub fn to_pose(&self) -> Result<SpatialPose, InvalidPose> {
        let (p, q) = (self.position, self.orientation);
        pose_from_xyzw([p.x, p.y, p.z], [q.x, q.y, q.z, q.w])
    }
}

impl From<&SpatialPose> for Pose {
    fn from(pose: &SpatialPose) -> Self {
        let translation = pose.translation;
        let [x, y, z, w] = xyzw_from_rotation(&pose.rotation);
        Self {
            position: Point { x: translation.x, y: translation.y, z: translation.z },
            orientation: Quaternion { x, y, z, w },
        }
    }
}

/// `geometry_msgs/msg/PoseArray`: poses that share frame and stamp.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseArray {
    /// Frame and stamp of them all.
    pub header: Header,
    /// The poses.
    pub poses: Vec<Pose>,
}

/// `geometry_msgs/msg/PoseStamped`: one pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseStamped {
    /// Its frame and stamp.
    pub header: Header,
    /// The pose.
    pub pose: Pose,
}

/// `nav_msgs/msg/Path`: poses in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Frame of the path and stamp of the message.
    pub header: Header,
    /// The poses, each with its own stamp.
    pub poses: Vec<PoseStamped>,
}

/// `std_msgs/msg/String`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// The text.
    pub data: String,
}

/// `trajectory_msgs/msg/JointTrajectoryPoint`, in rad (m for prismatic joints) and seconds; a field that is not given is empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct JointTrajectoryPoint {
    pub positions: Vec<f64>,
    pub velocities: Vec<f64>,
    pub accelerations: Vec<f64>,
    pub effort: Vec<f64>,
    pub time_from_start: Duration,
}

/// `trajectory_msgs/msg/JointTrajectory`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct JointTrajectory {
    /// Stamp of the start.
    pub header: Header,
    /// Names in the order of every point's values.
    pub joint_names: Vec<String>,
    /// The points.
    pub points: Vec<JointTrajectoryPoint>,
}

/// The definition of a type that is read here.
pub(crate) fn definition(message_type: &str) -> Option<&'static str> {
    const KNOWN: [(&str, &str); 10] = [
        (PoseArray::TYPE, PoseArray::DEFINITION),
        (PoseStamped::TYPE, PoseStamped::DEFINITION),
        (PoseWithCovarianceStamped::TYPE, PoseWithCovarianceStamped::DEFINITION),
        (Odometry::TYPE, Odometry::DEFINITION),
        (Path::TYPE, Path::DEFINITION),
        (TfMessage::TYPE, TfMessage::DEFINITION),
        (JointState::TYPE, JointState::DEFINITION),
        (JointTrajectory::TYPE, JointTrajectory::DEFINITION),
        (MarkerArray::TYPE, MarkerArray::DEFINITION),
        (Text::TYPE, Text::DEFINITION),
    ];
    KNOWN.iter().find(|(name, _)| *name == message_type).map(|(_, definition)| *definition)
}

/// Concatenates `.msg` files the way MCAP wants `ros2msg` schemas: the root, then every part behind a ruler and its name.
macro_rules! definition_text {
    ($root:literal $(, $package:literal / $part:literal)*) => {
        concat!(
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/msg/", $root, ".msg")),
            $(
                "================================================================================\n",
                "MSG: ", $package, "/", $part, "\n",
                include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/msg/", $part, ".msg")),
            )*
        )
    };
}
use definition_text;

impl Message for PoseArray {
    const TYPE: &'static str = "geometry_msgs/msg/PoseArray";
    const DEFINITION: &'static str = definition_text!(
        "PoseArray",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "Pose",
        "geometry_msgs" / "Point",
        "geometry_msgs" / "Quaternion"
    );
    const TYPE_HASH: &'static str = "RIHS01_af0cc36d190e104d546d168d6b39df04fa4b4ccecf59cb4c9ed328d3d5004aa0";
}

impl Message for PoseStamped {
    const TYPE: &'static str = "geometry_msgs/msg/PoseStamped";
    const DEFINITION: &'static str = definition_text!(
        "PoseStamped",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "Pose",
        "geometry_msgs" / "Point",
        "geometry_msgs" / "Quaternion"
    );
    const TYPE_HASH: &'static str = "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8";
}

impl Message for Path {
    const TYPE: &'static str = "nav_msgs/msg/Path";
    const DEFINITION: &'static str = definition_text!(
        "Path",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "PoseStamped",
        "geometry_msgs" / "Pose",
        "geometry_msgs" / "Point",
        "geometry_msgs" / "Quaternion"
    );
    const TYPE_HASH: &'static str = "RIHS01_1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b";
}

impl Message for JointTrajectory {
    const TYPE: &'static str = "trajectory_msgs/msg/JointTrajectory";
    const DEFINITION: &'static str = definition_text!(
        "JointTrajectory",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "trajectory_msgs" / "JointTrajectoryPoint",
        "builtin_interfaces" / "Duration"
    );
    const TYPE_HASH: &'static str = "RIHS01_179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e";
}

impl Message for Text {
    const TYPE: &'static str = "std_msgs/msg/String";
    const DEFINITION: &'static str = definition_text!("String");
    const TYPE_HASH: &'static str = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";
}
