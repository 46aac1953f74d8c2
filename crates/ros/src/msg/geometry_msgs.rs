//! `geometry_msgs`: points, poses and transforms.

use super::std_msgs::Header;
use nalgebra::{Isometry3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// A position, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// First coordinate.
    pub x: f64,
    /// Second coordinate.
    pub y: f64,
    /// Third coordinate.
    pub z: f64,
}

impl From<nalgebra::Point3<f64>> for Point {
    fn from(point: nalgebra::Point3<f64>) -> Self {
        Self {
            x: point.x,
            y: point.y,
            z: point.z,
        }
    }
}

/// A free vector or three extents, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// Along the first axis.
    pub x: f64,
    /// Along the second axis.
    pub y: f64,
    /// Along the third axis.
    pub z: f64,
}

/// A rotation as a unit quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// First imaginary part.
    pub x: f64,
    /// Second imaginary part.
    pub y: f64,
    /// Third imaginary part.
    pub z: f64,
    /// Real part.
    pub w: f64,
}

impl Default for Quaternion {
    /// No rotation: the all-zero quaternion is not one, and tools complain about it.
    fn default() -> Self {
        UnitQuaternion::identity().into()
    }
}

impl From<UnitQuaternion<f64>> for Quaternion {
    /// Normalised once more: rotations that went through decimal text are off by their rounding.
    fn from(rotation: UnitQuaternion<f64>) -> Self {
        let unit = UnitQuaternion::new_normalize(rotation.into_inner());
        Self {
            x: unit.i,
            y: unit.j,
            z: unit.k,
            w: unit.w,
        }
    }
}

/// A position and a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Where.
    pub position: Point,
    /// Turned how.
    pub orientation: Quaternion,
}

impl From<&Isometry3<f64>> for Pose {
    fn from(isometry: &Isometry3<f64>) -> Self {
        Self {
            position: nalgebra::Point3::from(isometry.translation.vector).into(),
            orientation: isometry.rotation.into(),
        }
    }
}

impl From<&Pose> for Isometry3<f64> {
    /// What is no rotation stays none, so that it is refused where it is used.
    fn from(pose: &Pose) -> Self {
        let Point { x, y, z } = pose.position;
        isometry(Vector3 { x, y, z }, pose.orientation)
    }
}

impl From<&Transform> for Isometry3<f64> {
    fn from(transform: &Transform) -> Self {
        isometry(transform.translation, transform.rotation)
    }
}

fn isometry(place: Vector3, rotation: Quaternion) -> Isometry3<f64> {
    let Quaternion { x, y, z, w } = rotation;
    Isometry3::from_parts(
        nalgebra::Translation3::new(place.x, place.y, place.z),
        UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z)),
    )
}

/// A pose and how sure it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseWithCovariance {
    /// The pose.
    pub pose: Pose,
    /// Row by row: x, y, z (square metres), then rotation about x, y, z (square radians).
    pub covariance: [[f64; 6]; 6],
}

/// A translation and a rotation between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Origin of the child frame in the parent frame, metres.
    pub translation: Vector3,
    /// Axes of the child frame in the parent frame.
    pub rotation: Quaternion,
}

impl From<&Isometry3<f64>> for Transform {
    fn from(isometry: &Isometry3<f64>) -> Self {
        let translation = &isometry.translation;
        Self {
            translation: Vector3 {
                x: translation.x,
                y: translation.y,
                z: translation.z,
            },
            rotation: isometry.rotation.into(),
        }
    }
}

/// Takes coordinates in the child frame to coordinates in the header's frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// Parent frame.
    pub header: Header,
    /// Child frame.
    pub child_frame_id: String,
    /// The child frame as seen from the parent frame.
    pub transform: Transform,
}

/// A velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// Metres per second.
    pub linear: Vector3,
    /// Radians per second.
    pub angular: Vector3,
}

/// A velocity with its covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwistWithCovariance {
    /// The velocity.
    pub twist: Twist,
    /// Row by row, as of a pose.
    pub covariance: [[f64; 6]; 6],
}

/// A point of less precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point32 {
    /// First coordinate.
    pub x: f32,
    /// Second coordinate.
    pub y: f32,
    /// Third coordinate.
    pub z: f32,
}

/// A polygon.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// Its corners.
    pub points: Vec<Point32>,
}

/// An acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accel {
    /// Metres per second squared.
    pub linear: Vector3,
    /// Radians per second squared.
    pub angular: Vector3,
}

/// An acceleration with its covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AccelWithCovariance {
    /// The acceleration.
    pub accel: Accel,
    /// Row by row, as of a pose.
    pub covariance: [[f64; 6]; 6],
}
