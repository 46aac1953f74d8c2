//! The rig dataset: a folder with `rig.toml`, `frames.jsonl` and, per camera, a folder of images or one clip.

mod error;
mod frames_file;
mod rig_file;
mod writer;

pub use error::{DatasetError, FramesProblem, RigProblem};
pub use rig_file::read_rig_file;
pub use writer::{DatasetWriter, NewFrame};

use crate::{
    any_recording::AnyRecording,
    image_sequence::{ImageSequence, SequenceError, StampedFile},
    playback::{Playback, PlaybackOptions},
    player::Recording,
    span::Span,
    video_file::VideoFile,
};
use nalgebra::Isometry3;
use roadwatch_core::{EgoMotion, RigCamera, Timestamp};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

const RIG_FILE: &str = "rig.toml";
const FRAMES_FILE: &str = "frames.jsonl";
const CLIP_EXTENSION: &str = "mp4";

/// One line of `frames.jsonl`.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetFrame {
    /// Its number, which names the image files: `<camera>/0007.jpg` for 7.
    pub number: u64,
    /// When each camera captured it, in the order of [`RigDataset::cameras`]; `None` where a camera has no image.
    pub stamps: Vec<Option<Timestamp>>,
    /// Where the vehicle was, `base_link` in world, metres; `None` where the recording does not know.
    pub world_from_base: Option<Isometry3<f64>>,
    /// The moment of that pose: `ego_stamp`, or without one the middle of the captures.
    pub ego_at: Timestamp,
}

/// An image of a dataset that is laid out in another way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DatasetImage {
    /// Index of its camera.
    pub camera: usize,
    /// Number of its frame.
    pub number: u64,
    /// The file, and when it was captured.
    pub image: StampedFile,
}

/// A rig dataset, read and checked; images and clips are only read when they are played.
#[derive(Clone, Debug)]
pub struct RigDataset {
    folder: PathBuf,
    cameras: Vec<RigCamera>,
    frames: Vec<DatasetFrame>,
    stored: Vec<Stored>,
}

/// What a camera saw, as it lies in the dataset.
#[derive(Clone, Debug)]
enum Stored {
    /// `<camera>/0000.jpg` and so on.
    Images(ImageSequence),
    /// `<camera>.mp4`, with one frame per stamp.
    Clip {
        file: PathBuf,
        stamps: Vec<Timestamp>,
        span: Span,
    },
}

impl RigDataset {
    /// Reads `rig.toml` and `frames.jsonl` of `folder`. Stamps keep every digit of the file up to nanoseconds.
    ///
    /// # Errors
    /// When a file or a camera's folder is missing, or a line is wrong: see [`DatasetError`].
    pub fn open(folder: &Path) -> Result<Self, DatasetError> {
        let cameras = read_rig_file(&folder.join(RIG_FILE))?;
        let frames_file = folder.join(FRAMES_FILE);
        let frames = frames_file::parse(&read_text(&frames_file)?, &frames_file, &cameras)?;
        let stored = cameras
            .iter()
            .enumerate()
            .map(|(index, camera)| stored(folder, camera, index, &frames))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            folder: folder.to_owned(),
            cameras,
            frames,
            stored,
        })
    }

    /// A dataset of images that are laid out in another way. Images of one number make one frame; numbers and each
    /// camera's stamps must rise.
    ///
    /// # Errors
    /// When a camera has no image, or its stamps do not rise.
    pub fn from_images(
        folder: &Path,
        cameras: Vec<RigCamera>,
        images: Vec<DatasetImage>,
    ) -> Result<Self, DatasetError> {
        let mut frames: Vec<DatasetFrame> = Vec::new();
        let mut files = vec![Vec::new(); cameras.len()];
        for DatasetImage {
            camera,
            number,
            image,
        } in images
        {
            if frames.last().is_none_or(|frame| frame.number != number) {
                frames.push(DatasetFrame {
                    number,
                    stamps: vec![None; cameras.len()],
                    world_from_base: None,
                    ego_at: image.stamp,
                });
            }
            if let Some(frame) = frames.last_mut() {
                frame.stamps[camera] = Some(image.stamp);
            }
            files[camera].push(image);
        }
        let stored = cameras.iter().zip(files).map(|(camera, files)| {
            let images = ImageSequence::from_files(files, camera.model.size);
            let images = images.map_err(|source| DatasetError::Sequence {
                camera: camera.name.clone(),
                source,
            });
            Ok(Stored::Images(images?))
        });
        Ok(Self {
            folder: folder.to_owned(),
            stored: stored.collect::<Result<_, DatasetError>>()?,
            cameras,
            frames,
        })
    }

    /// The folder it was read from.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The cameras, in the order of `rig.toml`: as `roadwatch_core::Rig::new` wants them.
    #[must_use]
    pub fn cameras(&self) -> &[RigCamera] {
        &self.cameras
    }

    /// The frames, in order.
    #[must_use]
    pub fn frames(&self) -> &[DatasetFrame] {
        &self.frames
    }

    /// Where the vehicle was, as far as the recording knows. What cannot be is counted by the motion itself.
    #[must_use]
    pub fn ego_motion(&self) -> EgoMotion {
        let motion = EgoMotion::recorded();
        for frame in &self.frames {
            if let Some(world_from_base) = frame.world_from_base {
                motion.tell(frame.ego_at, world_from_base).ok();
            }
        }
        motion
    }

    /// What the camera at `index` of [`RigDataset::cameras`] saw; `None` when there is no such camera.
    ///
    /// # Errors
    /// When its clip cannot be played, or has another number of frames than it has stamps.
    pub fn recording(&self, index: usize) -> Option<Result<AnyRecording, DatasetError>> {
        let camera = self.cameras.get(index)?;
        Some(match self.stored.get(index)? {
            Stored::Images(images) => Ok(AnyRecording::Images(images.clone())),
            Stored::Clip { file, stamps, .. } => {
                VideoFile::open_stamped(file, camera.model.size, stamps.clone())
                    .map(AnyRecording::Video)
                    .map_err(|source| DatasetError::Clip {
                        camera: camera.name.clone(),
                        source,
                    })
            }
        })
    }

    /// A clock over all cameras of the dataset. Played cameras share it, also when only some are played, so
    /// that each frame of a camera comes at the same moment whoever else plays.
    #[must_use]
    pub fn playback(&self, options: PlaybackOptions) -> Arc<Playback> {
        let spans: Vec<_> = self.stored.iter().map(Stored::span).collect();
        Playback::new(options, &spans)
    }
}

impl Stored {
    fn span(&self) -> Span {
        match self {
            Self::Images(images) => images.span(),
            Self::Clip { span, .. } => *span,
        }
    }
}

fn stored(
    folder: &Path,
    camera: &RigCamera,
    index: usize,
    frames: &[DatasetFrame],
) -> Result<Stored, DatasetError> {
    let clip = folder.join(format!("{}.{CLIP_EXTENSION}", camera.name.as_str()));
    if !clip.is_file() {
        return sequence(folder, camera, index, frames).map(Stored::Images);
    }
    let stamps: Vec<_> = frames
        .iter()
        .filter_map(|frame| frame.stamps[index])
        .collect();
    let span = Span::from_stamps(stamps.iter().copied()).ok_or_else(|| DatasetError::NoFrames {
        camera: camera.name.clone(),
        file: folder.join(FRAMES_FILE),
    })?;
    Ok(Stored::Clip {
        file: clip,
        stamps,
        span,
    })
}

fn sequence(
    folder: &Path,
    camera: &RigCamera,
    index: usize,
    frames: &[DatasetFrame],
) -> Result<ImageSequence, DatasetError> {
    let images = folder.join(camera.name.as_str());
    if !images.is_dir() {
        return Err(DatasetError::NoFolder {
            camera: camera.name.clone(),
            folder: images,
        });
    }
    let files = frames.iter().filter_map(|frame| {
        Some(StampedFile {
            file: images.join(format!("{:04}.jpg", frame.number)),
            stamp: frame.stamps[index]?,
        })
    });
    ImageSequence::from_files(files.collect(), camera.model.size).map_err(|source| match source {
        SequenceError::Empty => DatasetError::NoFrames {
            camera: camera.name.clone(),
            file: folder.join(FRAMES_FILE),
        },
        source => DatasetError::Sequence {
            camera: camera.name.clone(),
            source,
        },
    })
}

fn read_text(file: &Path) -> Result<String, DatasetError> {
    fs::read_to_string(file).map_err(|source| DatasetError::Unreadable {
        file: file.to_owned(),
        source,
    })
}
