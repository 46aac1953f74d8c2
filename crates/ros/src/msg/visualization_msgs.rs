//! `visualization_msgs`: shapes for RViz and Foxglove.

use super::{
    builtin_interfaces::Duration,
    geometry_msgs::{Point, Pose, Vector3},
    sensor_msgs::CompressedImage,
    std_msgs::{ColorRGBA, Header},
};
use serde::{Deserialize, Serialize};

/// A place on a texture, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UVCoordinate {
    /// Across.
    pub u: f32,
    /// Down.
    pub v: f32,
}

/// A mesh sent along with a marker.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshFile {
    /// Its name.
    pub filename: String,
    /// Its bytes.
    pub data: Vec<u8>,
}

/// A shape to draw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// When and in which frame.
    pub header: Header,
    /// Namespace; with `id` it names the shape.
    pub ns: String,
    /// Number within the namespace.
    pub id: i32,
    /// Which shape, see the constants.
    #[serde(rename = "type")]
    pub kind: i32,
    /// What to do with it, see the constants.
    pub action: i32,
    /// Where.
    pub pose: Pose,
    /// How large, metres.
    pub scale: Vector3,
    /// Colour of the whole shape.
    pub color: ColorRGBA,
    /// How long it stays without being sent again.
    pub lifetime: Duration,
    /// Whether it moves with its frame until sent again.
    pub frame_locked: bool,
    /// Points of lines and lists.
    pub points: Vec<Point>,
    /// Colours of points; unused.
    pub colors: Vec<ColorRGBA>,
    /// Name of a texture; unused.
    pub texture_resource: String,
    /// A texture; unused.
    pub texture: CompressedImage,
    /// Places on the texture; unused.
    pub uv_coordinates: Vec<UVCoordinate>,
    /// Text of a label.
    pub text: String,
    /// Name of a mesh; unused.
    pub mesh_resource: String,
    /// A mesh; unused.
    pub mesh_file: MeshFile,
    /// Whether the mesh brings its own colours; unused.
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// `kind` of an arrow along x.
    pub const ARROW: i32 = 0;
    /// Points joined by a line.
    pub const LINE_STRIP: i32 = 4;
    /// `kind` of a box.
    pub const CUBE: i32 = 1;
    /// `kind` of a text that faces the viewer.
    pub const TEXT_VIEW_FACING: i32 = 9;
    /// `action` that draws or redraws.
    pub const ADD: i32 = 0;
    /// `action` that removes everything the topic has drawn.
    pub const DELETE_ALL: i32 = 3;
}

/// Shapes to draw together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// In order.
    pub markers: Vec<Marker>,
}
