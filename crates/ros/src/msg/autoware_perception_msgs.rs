//! `autoware_perception_msgs`: objects as Autoware's perception passes them on.

use super::{
    geometry_msgs::{
        AccelWithCovariance, Polygon, PoseWithCovariance, TwistWithCovariance, Vector3,
    },
    std_msgs::Header,
    unique_identifier_msgs::UUID,
};
use serde::{Deserialize, Serialize};

/// One of the classes an object may be of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectClassification {
    /// One of the constants.
    pub label: u8,
    /// 0 to 1.
    pub probability: f32,
}

impl ObjectClassification {
    /// None of the others.
    pub const UNKNOWN: u8 = 0;
    /// A car.
    pub const CAR: u8 = 1;
    /// A lorry.
    pub const TRUCK: u8 = 2;
    /// A bus.
    pub const BUS: u8 = 3;
    /// A motorcycle.
    pub const MOTORCYCLE: u8 = 5;
    /// A bicycle.
    pub const BICYCLE: u8 = 6;
    /// Somebody on foot.
    pub const PEDESTRIAN: u8 = 7;
}

/// Where an object is and how it moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DetectedObjectKinematics {
    /// The centre of its box.
    pub pose_with_covariance: PoseWithCovariance,
    /// Whether the covariance of the position means anything.
    pub has_position_covariance: bool,
    /// One of the constants.
    pub orientation_availability: u8,
    /// How it moves.
    pub twist_with_covariance: TwistWithCovariance,
    /// Whether that means anything.
    pub has_twist: bool,
    /// Whether its covariance does.
    pub has_twist_covariance: bool,
}

impl DetectedObjectKinematics {
    /// Nothing is known of the orientation.
    pub const UNAVAILABLE: u8 = 0;
    /// Front and back may be mistaken.
    pub const SIGN_UNKNOWN: u8 = 1;
    /// It is known.
    pub const AVAILABLE: u8 = 2;
}

/// The extent of an object.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// One of the constants.
    #[serde(rename = "type")]
    pub kind: u8,
    /// Corners on the ground, for polygons.
    pub footprint: Polygon,
    /// Length, width, height, metres.
    pub dimensions: Vector3,
}

impl Shape {
    /// A cuboid.
    pub const BOUNDING_BOX: u8 = 0;
    /// An upright cylinder.
    pub const CYLINDER: u8 = 1;
}

/// One object.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DetectedObject {
    /// How likely it is there at all, 0 to 1.
    pub existence_probability: f32,
    /// What it may be.
    pub classification: Vec<ObjectClassification>,
    /// Where it is.
    pub kinematics: DetectedObjectKinematics,
    /// Its extent.
    pub shape: Shape,
}

/// What was seen at one moment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DetectedObjects {
    /// When, and the frame of all poses.
    pub header: Header,
    /// The objects.
    pub objects: Vec<DetectedObject>,
}

/// Where a tracked object is and how it moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrackedObjectKinematics {
    /// The centre of its box.
    pub pose_with_covariance: PoseWithCovariance,
    /// One of the constants of [`DetectedObjectKinematics`].
    pub orientation_availability: u8,
    /// How it moves, along its own axes.
    pub twist_with_covariance: TwistWithCovariance,
    /// How that changes, along its own axes.
    pub acceleration_with_covariance: AccelWithCovariance,
    /// Whether it stands.
    pub is_stationary: bool,
}

/// One object with its identity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrackedObject {
    /// Who it is.
    pub object_id: UUID,
    /// How likely it is there at all, 0 to 1.
    pub existence_probability: f32,
    /// What it may be.
    pub classification: Vec<ObjectClassification>,
    /// Where it is.
    pub kinematics: TrackedObjectKinematics,
    /// Its extent.
    pub shape: Shape,
}

/// What was there at one moment, by all that was seen before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrackedObjects {
    /// When, and the frame of all poses.
    pub header: Header,
    /// The objects.
    pub objects: Vec<TrackedObject>,
}
