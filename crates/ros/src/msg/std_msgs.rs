//! `std_msgs`: header and colour.

use super::builtin_interfaces::Time;
use roadwatch_core::Timestamp;
use serde::{Deserialize, Serialize};

/// When and in which frame the content is true.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Capture time.
    pub stamp: Time,
    /// Name of the tf frame.
    pub frame_id: String,
}

impl Header {
    /// A header from a capture time and the name of a tf frame.
    pub fn new(stamp: Timestamp, frame_id: impl Into<String>) -> Self {
        Self {
            stamp: stamp.into(),
            frame_id: frame_id.into(),
        }
    }
}

/// A colour; every part is 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ColorRGBA {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// Opacity.
    pub a: f32,
}
