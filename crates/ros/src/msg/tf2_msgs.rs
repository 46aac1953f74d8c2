//! `tf2_msgs`: the frame tree.

use super::geometry_msgs::TransformStamped;
use serde::{Deserialize, Serialize};

/// Transforms of the frame tree.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// One per child frame.
    pub transforms: Vec<TransformStamped>,
}
