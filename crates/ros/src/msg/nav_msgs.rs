//! `nav_msgs`: where the vehicle is.

use super::{
    geometry_msgs::{PoseWithCovariance, TwistWithCovariance},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// Where a body is, and how it moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// When, and in which frame.
    pub header: Header,
    /// Frame of the body.
    pub child_frame_id: String,
    /// Its pose in the header's frame.
    pub pose: PoseWithCovariance,
    /// Its velocity along its own axes.
    pub twist: TwistWithCovariance,
}
