//! `roadwatch_msgs`: everything that is known. `msgs/roadwatch_msgs/msg` is the source.

use super::{
    builtin_interfaces::Time,
    geometry_msgs::{Point, Pose, Vector3},
    std_msgs::Header,
    unique_identifier_msgs::UUID,
};
use nalgebra::Isometry3;
use roadwatch_core::EgoKnowledge;
use serde::{Deserialize, Serialize};

/// A key component of an object, where the image shows it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyComponent {
    /// What it is.
    pub name: String,
    /// Column, pixels.
    pub x_px: f32,
    /// Row, pixels.
    pub y_px: f32,
    /// How sure the model is, 0 to 1.
    pub score: f32,
}

/// One object and everything that is known about it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// The moment that the position is of, and its frame.
    pub header: Header,
    /// Capture time of the newest frame that it was seen in.
    pub seen_at: Time,
    /// Who it is.
    pub track_id: u64,
    /// The same as a name that no other run gives; all zero without tracking.
    pub uuid: UUID,
    /// How far it is believed in.
    pub state: String,
    /// Whether the position is a prediction.
    pub predicted: bool,
    /// Seconds since it was first seen.
    pub age: f32,
    /// What it is.
    pub class_id: String,
    /// How sure the detector is, 0 to 1.
    pub score: f32,
    /// The box as detected: x_min, y_min, x_max, y_max, pixels.
    pub box_px: [f32; 4],
    /// Centre of its box, metres.
    pub position: Point,
    /// Covariance of the position, row by row, square metres.
    pub position_covariance: [f64; 9],
    /// Length, width, height, metres.
    pub size: Vector3,
    /// Along the optical axis, metres.
    pub depth_m: f64,
    /// Horizontal distance from the camera, metres.
    pub range_m: f64,
    /// How the position was found.
    pub method: String,
    /// Whether the position is an earlier one.
    pub held: bool,
    /// Whether anything says which way it points.
    pub heading_known: bool,
    /// Heading, radians; 0 when unknown.
    pub yaw_rad: f64,
    /// Variance of the heading, square radians.
    pub yaw_variance: f64,
    /// How likely it points the other way, 0 to 0.5.
    pub flip_probability: f32,
    /// Seconds since the heading was found.
    pub heading_age: f32,
    /// Whether what follows is known.
    pub motion_known: bool,
    /// Velocity, metres per second.
    pub velocity: Vector3,
    /// Its covariance along x and y.
    pub velocity_covariance: [f64; 4],
    /// Acceleration, metres per second squared.
    pub acceleration: Vector3,
    /// Its covariance along x and y.
    pub acceleration_covariance: [f64; 4],
    /// About z, radians per second.
    pub turn_rate: f32,
    /// Its variance.
    pub turn_rate_variance: f32,
    /// Key components found in this frame.
    pub components: Vec<KeyComponent>,
    /// Names of the cameras that saw it.
    pub seen_by: Vec<String>,
}

/// All objects of one frame of one camera, or of one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectArray {
    /// Capture time, base frame.
    pub header: Header,
    /// Name of the camera; empty for the scene.
    pub camera: String,
    /// How the vehicle's own motion is known.
    pub ego_motion: String,
    /// Where base_link stands in odom.
    pub ego_pose: Pose,
    /// Empty when nothing was seen.
    pub objects: Vec<Object>,
}

impl ObjectArray {
    /// Where base_link stands in odom; `None` while nobody tells.
    #[must_use]
    pub fn odom_from_base(&self) -> Option<Isometry3<f64>> {
        let told = self.ego_motion != EgoKnowledge::None.as_str();
        told.then(|| (&self.ego_pose).into())
    }
}
