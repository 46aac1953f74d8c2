//! The rig dataset: a folder with `rig.toml`, `frames.jsonl` and one folder of images per camera.

mod error;
mod frames_file;
mod rig_file;

pub use error::{DatasetError, FramesProblem, RigProblem};
pub use rig_file::read_rig_file;

use crate::{
    image_sequence::{ImageSequence, SequenceError, StampedFile},
    playback::{Playback, PlaybackOptions},
    player::Recording,
};
use nalgebra::Isometry3;
use roadwatch_core::{RigCamera, Timestamp};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

const RIG_FILE: &str = "rig.toml";
const FRAMES_FILE: &str = "frames.jsonl";

/// One line of `frames.jsonl`.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetFrame {
    /// Its number, which names the image files: `<camera>/0007.jpg` for 7.
    pub number: u64,
    /// When each camera captured it, in the order of [`RigDataset::cameras`]; `None` where a camera has no image.
    pub stamps: Vec<Option<Timestamp>>,
    /// Where the vehicle was, `base_link` in world, metres; `None` where the recording does not know.
    pub world_from_base: Option<Isometry3<f64>>,
}

/// A rig dataset, read and checked; images are only read when they are played.
#[derive(Clone, Debug)]
pub struct RigDataset {
    folder: PathBuf,
    cameras: Vec<RigCamera>,
    frames: Vec<DatasetFrame>,
    sequences: Vec<ImageSequence>,
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
        let sequences = cameras
            .iter()
            .enumerate()
            .map(|(index, camera)| sequence(folder, camera, index, &frames))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            folder: folder.to_owned(),
            cameras,
            frames,
            sequences,
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

    /// The images of the camera at `index` of [`RigDataset::cameras`]; `None` when there is no such camera.
    #[must_use]
    pub fn recording(&self, index: usize) -> Option<ImageSequence> {
        self.sequences.get(index).cloned()
    }

    /// A clock over all cameras of the dataset. Played cameras share it, also when only some are played, so
    /// that each frame of a camera comes at the same moment whoever else plays.
    #[must_use]
    pub fn playback(&self, options: PlaybackOptions) -> Arc<Playback> {
        let spans: Vec<_> = self.sequences.iter().map(Recording::span).collect();
        Playback::new(options, &spans)
    }
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
