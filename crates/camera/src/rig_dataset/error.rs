//! What can be wrong with a rig dataset, said with file and line.

use crate::{image_sequence::SequenceError, video_file::VideoError};
use roadwatch_core::{
    CameraName, Timestamp, distortion::UnknownDistortion, name::InvalidName,
    time::ParseTimestampError,
};
use std::{io, path::PathBuf};

/// A rig dataset that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// A file is missing, not ours to read, or not text.
    #[error(
        "`{}` cannot be read: a rig dataset is a folder with rig.toml, frames.jsonl and a folder of images per camera",
        file.display()
    )]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A mistake in `rig.toml`.
    #[error("{}:{line}: {problem}", file.display())]
    Rig {
        /// The file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong there.
        problem: RigProblem,
    },
    /// A mistake in `frames.jsonl`.
    #[error("{}:{line}: {problem}", file.display())]
    Frames {
        /// The file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong there.
        problem: FramesProblem,
    },
    /// A camera of the rig has neither a folder nor a clip.
    #[error("camera `{camera}` has no images: neither the folder `{0}` nor the clip `{0}.mp4` is there", folder.display())]
    NoFolder {
        /// The camera.
        camera: CameraName,
        /// Where its images should be.
        folder: PathBuf,
    },
    /// A camera of the rig has no stamp in any frame.
    #[error(
        "camera `{camera}` has no stamp in `{}`: add its stamps, or remove the camera from rig.toml",
        file.display()
    )]
    NoFrames {
        /// The camera.
        camera: CameraName,
        /// The file.
        file: PathBuf,
    },
    /// A camera's images cannot be played.
    #[error("camera `{camera}`")]
    Sequence {
        /// The camera.
        camera: CameraName,
        /// Why.
        source: SequenceError,
    },
    /// A camera's clip cannot be played.
    #[error("camera `{camera}`")]
    Clip {
        /// The camera.
        camera: CameraName,
        /// Why.
        source: VideoError,
    },
}

/// A mistake in `rig.toml`.
#[derive(Debug, thiserror::Error)]
pub enum RigProblem {
    /// Not TOML, or a key is missing, unknown or of the wrong kind.
    #[error("{0}")]
    Toml(String),
    /// No camera at all, or too many.
    #[error("{0} cameras: a rig has 1 to 255, each with a [[camera]] section")]
    CameraCount(usize),
    /// Not a legal name.
    #[error(transparent)]
    Name(InvalidName),
    /// Two cameras of one name.
    #[error("two cameras are called `{0}`: give each a name of its own")]
    SameName(CameraName),
    /// No camera has such an image.
    #[error(
        "camera `{camera}`: an image of {width}x{height} pixels is impossible: expected 1 to {max} each way"
    )]
    Size {
        /// The camera.
        camera: CameraName,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The most columns or rows.
        max: u32,
    },
    /// A number that is infinite, not a number, or not positive where it must be.
    #[error("camera `{camera}`: {key} is {value}: expected {expected}")]
    Number {
        /// The camera.
        camera: CameraName,
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A quaternion that is not a rotation.
    #[error(
        "camera `{camera}`: orientation_wxyz has length {length:.4}: a rotation, written w x y z, has length 1"
    )]
    Orientation {
        /// The camera.
        camera: CameraName,
        /// Its norm.
        length: f64,
    },
    /// An unknown lens model.
    #[error("camera `{camera}`: {cause}")]
    Distortion {
        /// The camera.
        camera: CameraName,
        /// What is unknown.
        cause: UnknownDistortion,
    },
}

/// A mistake in `frames.jsonl`.
#[derive(Debug, thiserror::Error)]
pub enum FramesProblem {
    /// Not one JSON object with the expected keys.
    #[error("column {column}: {message}")]
    Json {
        /// Counted from 1.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// No line at all.
    #[error("no frame: expected one JSON object per line")]
    Empty,
    /// A stamp that is not decimal seconds.
    #[error("camera `{camera}`: {cause}")]
    Stamp {
        /// The camera.
        camera: String,
        /// What is wrong with it.
        cause: ParseTimestampError,
    },
    /// The moment of the vehicle's pose is not decimal seconds.
    #[error("ego_stamp: {0}")]
    EgoStamp(#[source] ParseTimestampError),
    /// A stamp for a camera that the rig does not have.
    #[error("camera `{camera}` is not in rig.toml: it has {known}")]
    UnknownCamera {
        /// The name given.
        camera: String,
        /// The rig's cameras.
        known: String,
    },
    /// Frame numbers do not rise.
    #[error(
        "frame {number} comes after frame {previous}: sort the lines by frame, each number once"
    )]
    NumberFalls {
        /// This line's.
        number: u64,
        /// The line before's.
        previous: u64,
    },
    /// A camera's stamps do not rise.
    #[error(
        "camera `{camera}`: the stamp {stamp} is not later than {previous}, the one before it: put the frames \
         in order of capture"
    )]
    StampFalls {
        /// The camera.
        camera: CameraName,
        /// This line's.
        stamp: Timestamp,
        /// The one before.
        previous: Timestamp,
    },
    /// A pose of which one half is missing.
    #[error("an ego pose needs both ego_position_world_m and ego_orientation_world_wxyz")]
    HalfPose,
    /// A quaternion that is not a rotation.
    #[error(
        "ego_orientation_world_wxyz has length {length:.4}: a rotation, written w x y z, has length 1"
    )]
    Orientation {
        /// Its norm.
        length: f64,
    },
}
