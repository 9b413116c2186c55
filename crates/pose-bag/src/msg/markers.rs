//! What RViz and Foxglove draw.

use serde::{Deserialize, Serialize};

use super::{Duration, Header, Message, Point, Pose, Quaternion, Vector3, definition_text};

/// `std_msgs/msg/ColorRGBA`, each part from 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct ColorRgba {
    pub r: f32,
    pub g: f32,
    pub b: f32,
    pub a: f32,
}

/// `sensor_msgs/msg/CompressedImage`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct CompressedImage {
    pub header: Header,
    pub format: String,
    pub data: Vec<u8>,
}

/// `visualization_msgs/msg/UVCoordinate`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct UvCoordinate {
    pub u: f32,
    pub v: f32,
}

/// `visualization_msgs/msg/MeshFile`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct MeshFile {
    pub filename: String,
    pub data: Vec<u8>,
}

/// `visualization_msgs/msg/Marker`: a shape at `pose`, sized by `scale` in m; which fields count depends on `kind`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Marker {
    pub header: Header,
    pub ns: String,
    pub id: i32,
    #[serde(rename = "type")]
    pub kind: i32,
    pub action: i32,
    pub pose: Pose,
    pub scale: Vector3,
    pub color: ColorRgba,
    pub lifetime: Duration,
    pub frame_locked: bool,
    pub points: Vec<Point>,
    pub colors: Vec<ColorRgba>,
    pub texture_resource: String,
    pub texture: CompressedImage,
    pub uv_coordinates: Vec<UvCoordinate>,
    pub text: String,
    pub mesh_resource: String,
    pub mesh_file: MeshFile,
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// A line through all points.
    pub const LINE_STRIP: i32 = 4;
    /// A line between each two points.
    pub const LINE_LIST: i32 = 5;
    /// A ball at each point.
    pub const SPHERE_LIST: i32 = 7;
    /// Text that faces the viewer.
    pub const TEXT_VIEW_FACING: i32 = 9;
    /// The action that removes everything drawn before.
    pub const DELETEALL: i32 = 3;

    /// A marker at the origin of the frame in `header`, without size, colour or points.
    pub fn new(header: Header, ns: &str, id: i32, kind: i32) -> Self {
        let position = Point { x: 0.0, y: 0.0, z: 0.0 };
        let orientation = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        Self {
            header,
            ns: ns.to_owned(),
            id,
            kind,
            action: 0,
            pose: Pose { position, orientation },
            scale: Vector3::default(),
            color: ColorRgba::default(),
            lifetime: Duration::default(),
            frame_locked: false,
            points: Vec::new(),
            colors: Vec::new(),
            texture_resource: String::new(),
            texture: CompressedImage::default(),
            uv_coordinates: Vec::new(),
            text: String::new(),
            mesh_resource: String::new(),
            mesh_file: MeshFile::default(),
            mesh_use_embedded_materials: false,
        }
    }
}

/// `visualization_msgs/msg/MarkerArray`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// The markers.
    pub markers: Vec<Marker>,
}

impl Message for MarkerArray {
    const TYPE: &'static str = "visualization_msgs/msg/MarkerArray";
    const DEFINITION: &'static str = definition_text!(
        "MarkerArray",
        "visualization_msgs" / "Marker",
        "std_msgs" / "Header",
        "builtin_interfaces" / "Time",
        "geometry_msgs" / "Pose",
        "geometry_msgs" / "Point",
        "geometry_msgs" / "Quaternion",
        "geometry_msgs" / "Vector3",
        "std_msgs" / "ColorRGBA",
        "builtin_interfaces" / "Duration",
        "sensor_msgs" / "CompressedImage",
        "visualization_msgs" / "UVCoordinate",
        "visualization_msgs" / "MeshFile"
    );
    const TYPE_HASH: &'static str = "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf";
}
