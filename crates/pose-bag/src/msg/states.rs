//! Messages that say where something is: odometry, transforms, joints.

use serde::{Deserialize, Serialize};

use super::{Header, Message, Pose, Quaternion, definition_text};

/// `geometry_msgs/msg/Vector3`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// `geometry_msgs/msg/PoseWithCovariance`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseWithCovariance {
    /// The pose.
    pub pose: Pose,
    /// Its 6 × 6 covariance, row by row: x, y, z in m, and rotations about them in rad.
    #[serde(with = "six_by_six")]
    pub covariance: [f64; 36],
}

/// `geometry_msgs/msg/PoseWithCovarianceStamped`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseWithCovarianceStamped {
    /// Frame and stamp.
    pub header: Header,
    /// The pose.
    pub pose: PoseWithCovariance,
}

/// `geometry_msgs/msg/Twist`, in m/s and rad/s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Twist {
    pub linear: Vector3,
    pub angular: Vector3,
}

/// `geometry_msgs/msg/TwistWithCovariance`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TwistWithCovariance {
    /// The twist.
    pub twist: Twist,
    /// Its 6 × 6 covariance, row by row.
    #[serde(with = "six_by_six")]
    pub covariance: [f64; 36],
}

/// `nav_msgs/msg/Odometry`: the pose of `child_frame_id` in the frame of the header, and its twist in its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// Frame of the pose, and stamp.
    pub header: Header,
    /// What moves.
    pub child_frame_id: String,
    /// Where it is.
    pub pose: PoseWithCovariance,
    /// How it moves.
    pub twist: TwistWithCovariance,
}

/// `geometry_msgs/msg/Transform`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Transform {
    pub translation: Vector3,
    pub rotation: Quaternion,
}

/// `geometry_msgs/msg/TransformStamped`: the pose of `child_frame_id` in the frame of the header.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// Parent frame and stamp.
    pub header: Header,
    /// The frame that is placed.
    pub child_frame_id: String,
    /// Where.
    pub transform: Transform,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TfMessage {
    /// The transforms.
    pub transforms: Vec<TransformStamped>,
}

/// `sensor_msgs/msg/JointState`, in rad (m for prismatic joints) and seconds; a field that is not given is empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct JointState {
    pub header: Header,
    pub name: Vec<String>,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub effort: Vec<f64>,
}

/// serde knows arrays up to 32; CDR writes any fixed array as its elements alone.
mod six_by_six {
    use serde::ser::SerializeTuple;
    use serde::{Deserializer, Serializer, de};

    pub(super) fn serialize<S: Serializer>(values: &[f64; 36], serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(36)?;
        values.iter().try_for_each(|value| tuple.serialize_element(value))?;
        tuple.end()
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 36], D::Error> {
        deserializer.deserialize_tuple(36, Elements)
    }

    struct Elements;

    impl<'de> de::Visitor<'de> for Elements {
        type Value = [f64; 36];

        fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            formatter.write_str("36 numbers")
        }

        fn visit_seq<A: de::SeqAccess<'de>>(self, mut elements: A) -> Result<Self::Value, A::Error> {
            let mut values = [0.0; 36];
            for (at, value) in values.iter_mut().enumerate() {
                *value = elements.next_element()?.ok_or_else(|| de::Error::invalid_length(at, &self))?;
            }
            Ok(values)
        }
    }
}

impl Message for PoseWithCovarianceStamped {
    const TYPE: &'static str = "geometry_msgs/msg/PoseWithCovarianceStamped";
    const DEFINITION: &'static str = definition_text!(
        "PoseWithCovarianceStamped",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "PoseWithCovariance",
        "geometry_msgs" / "Pose",
        "geometry_msgs" / "Point",
        "geometry_msgs" / "Quaternion"
    );
    const TYPE_HASH: &'static str = "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e";
}

impl Message for Odometry {
    const TYPE: &'static str = "nav_msgs/msg/Odometry";
    const DEFINITION: &'static str = definition_text!(
        "Odometry",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "PoseWithCovariance",
        "geometry_msgs" / "Pose",
        "geometry_msgs" / "Point",
        "geometry_msgs" / "Quaternion",
        "geometry_msgs" / "TwistWithCovariance",
        "geometry_msgs" / "Twist",
        "geometry_msgs" / "Vector3"
    );
    const TYPE_HASH: &'static str = "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0";
}

impl Message for TfMessage {
    const TYPE: &'static str = "tf2_msgs/msg/TFMessage";
    const DEFINITION: &'static str = definition_text!(
        "TFMessage",
        "geometry_msgs" / "TransformStamped",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "Transform",
        "geometry_msgs" / "Vector3",
        "geometry_msgs" / "Quaternion"
    );
    const TYPE_HASH: &'static str = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087";
}

impl Message for JointState {
    const TYPE: &'static str = "sensor_msgs/msg/JointState";
    const DEFINITION: &'static str =
        definition_text!("JointState", "std_msgs" / "Header", "builtin_interfaces" / "Time");
    const TYPE_HASH: &'static str = "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e";
}
