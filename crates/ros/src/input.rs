//! What others publish or recorded: images as a camera's frames, odometry and transforms as the vehicle's motion.

mod bag_error;
mod bag_file;
mod bag_images;
mod bag_messages;
mod camera_info_check;
mod ego;
mod image_topic;
mod one_publisher;
mod recorded;
mod transforms;

use crate::msg::{
    sensor_msgs::{CompressedImage, Image},
    std_msgs::Header,
};
use roadwatch_core::Timestamp;

pub use bag_error::BagImagesError;
pub use bag_images::{BagImages, BagSpan};
pub use ego::{EgoListener, EgoSource, tell_from_bag};
pub use image_topic::{ImageTopic, ToImage, TopicCamera};
pub use recorded::{Recorded, RecordedError};

/// ROS's customary end of the names of topics with compressed images (`image_transport`).
const COMPRESSED: &str = "/compressed";

/// An image as it came.
#[derive(Clone, Debug, PartialEq)]
pub enum ImageMessage {
    /// `sensor_msgs/Image`.
    Raw(Image),
    /// `sensor_msgs/CompressedImage`.
    Compressed(CompressedImage),
}

impl ImageMessage {
    /// When it was captured.
    #[must_use]
    pub fn stamp(&self) -> Timestamp {
        self.header().stamp.into()
    }

    fn header(&self) -> &Header {
        match self {
            Self::Raw(image) => &image.header,
            Self::Compressed(image) => &image.header,
        }
    }
}

/// Why an image cannot stand behind those before it: `stamp` is not later than `last`.
fn stands_still(stamp: Timestamp, last: Timestamp) -> String {
    if stamp == Timestamp::from_nanos(0) {
        return "the image has no stamp: its publisher leaves it zero".to_owned();
    }
    if stamp == last {
        return format!("the stamp stands still at {stamp}");
    }
    format!("the stamp jumps back from {last} to {stamp}")
}
