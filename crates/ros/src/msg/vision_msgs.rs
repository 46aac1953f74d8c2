//! `vision_msgs` 4: what is where, in the image and in space.

use super::{
    geometry_msgs::{Pose, PoseWithCovariance, Vector3},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// A place in an image, pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point2D {
    /// Column.
    pub x: f64,
    /// Row.
    pub y: f64,
}

/// A place in an image and a rotation about it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose2D {
    /// Where, pixels.
    pub position: Point2D,
    /// Turned by, radians.
    pub theta: f64,
}

/// A box in an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingBox2D {
    /// Its middle.
    pub center: Pose2D,
    /// Columns covered.
    pub size_x: f64,
    /// Rows covered.
    pub size_y: f64,
}

/// A box in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingBox3D {
    /// Its middle and axes.
    pub center: Pose,
    /// Extents along its own axes: length, width, height, metres.
    pub size: Vector3,
}

/// What an object may be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectHypothesis {
    /// Name of the class.
    pub class_id: String,
    /// How sure that is, 0 to 1.
    pub score: f64,
}

/// What an object may be, and where it is then.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectHypothesisWithPose {
    /// What.
    pub hypothesis: ObjectHypothesis,
    /// Where, in the frame of the enclosing header.
    pub pose: PoseWithCovariance,
}

/// An object found in an image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection2D {
    /// Capture time, optical frame.
    pub header: Header,
    /// Never empty: viewers read the first without looking.
    pub results: Vec<ObjectHypothesisWithPose>,
    /// The box as detected.
    pub bbox: BoundingBox2D,
    /// The track; empty for a detection without a place.
    pub id: String,
}

/// All objects found in one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection2DArray {
    /// Capture time, optical frame.
    pub header: Header,
    /// Empty when nothing was seen.
    pub detections: Vec<Detection2D>,
}

/// An object found in space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection3D {
    /// Capture time, base frame.
    pub header: Header,
    /// Never empty: viewers read the first without looking.
    pub results: Vec<ObjectHypothesisWithPose>,
    /// The box in space.
    pub bbox: BoundingBox3D,
    /// The track.
    pub id: String,
}

/// All objects found in space at one moment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection3DArray {
    /// Capture time, base frame.
    pub header: Header,
    /// Empty when nothing was seen.
    pub detections: Vec<Detection3D>,
}
