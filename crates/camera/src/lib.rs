//! Frame sources: image sequences, video files and rig datasets.
//!
//! A [`Recording`] is what one camera once saw; a [`Player`] turns it into a [`FrameSource`]; a
//! [`Playback`] is the clock that the players of one rig share. Live cameras need none of the three:
//! they implement [`FrameSource`] themselves.
//!
//! [`FrameSource`]: roadwatch_core::FrameSource

mod any_recording;
pub mod camera_info;
pub mod counted;
pub mod frame_rate;
pub mod image_sequence;
pub mod live_camera;
mod mat;
mod natural_order;
pub mod playback;
pub mod player;
pub mod raw_image;
pub mod rig_dataset;
pub mod span;
pub mod still_image;
mod video_clock;
pub mod video_file;

pub use any_recording::AnyRecording;
pub use camera_info::{CameraInfo, CameraInfoError};
pub use counted::{Counted, DecodeCount};
pub use frame_rate::FrameRate;
pub use image_sequence::{ImageSequence, SequenceError, StampedFile};
pub use live_camera::{LiveCamera, LiveCameraError};
pub use playback::{Due, Pace, Playback, PlaybackOptions, Repeat, Speed};
pub use player::{Player, Recording};
pub use raw_image::RawImage;
pub use rig_dataset::{
    DatasetError, DatasetFrame, DatasetImage, DatasetWriter, FramesProblem, NewFrame, RigDataset,
    RigProblem, read_rig_file,
};
pub use span::Span;
pub use still_image::StillImage;
pub use video_file::{VideoError, VideoFile, video_size};
