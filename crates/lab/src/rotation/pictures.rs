//! Labelled pictures as the simulator's `training` command writes them: `labels.jsonl`, a line per picture with a
//! camera of its own.

use super::rows::LEVEL_M;
use crate::truth::{TruthObject, objects_of_line};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use roadwatch_camera::StillImage;
use roadwatch_core::{
    Image, ImageSize,
    rig::LooksVertical,
    space::{BaseLink, CameraGround, Optical, Transform},
};
use serde::Deserialize;
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Name of the labels' file.
pub(super) const LABELS_FILE: &str = "labels.jsonl";

/// A folder that holds no labelled pictures.
#[derive(Debug, thiserror::Error)]
pub enum PictureSetError {
    /// The disk.
    #[error("cannot read `{}`", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// A line is not a picture's.
    #[error("{}:{line}: not the labels of a picture", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Why.
        #[source]
        cause: serde_json::Error,
    },
    /// A camera that looks up or down.
    #[error(transparent)]
    Pose(#[from] LooksVertical),
}

/// One labelled picture.
pub(super) struct Picture {
    pub(super) image: Image,
    /// The ground before its camera.
    pub(super) ground: Transform<BaseLink, CameraGround>,
    pub(super) objects: Vec<TruthObject>,
}

#[derive(Deserialize)]
struct Line {
    image: String,
    width: u32,
    height: u32,
    position_m: [f64; 3],
    orientation_wxyz: [f64; 4],
    objects: serde_json::Value,
}

/// Reads the labels of a folder; images are read when they are due.
pub(super) fn read(
    folder: &Path,
) -> Result<impl ExactSizeIterator<Item = Result<Picture, PictureSetError>>, PictureSetError> {
    let file = folder.join(LABELS_FILE);
    let unreadable = |file: PathBuf| move |cause| PictureSetError::Unreadable { file, cause };
    let text = fs::read_to_string(&file).map_err(unreadable(file.clone()))?;
    let mut lines = Vec::new();
    for (text, line) in text.lines().zip(1..) {
        let malformed = |cause| PictureSetError::Malformed {
            file: file.clone(),
            line,
            cause,
        };
        let read: Line = serde_json::from_str(text).map_err(malformed)?;
        let objects = objects_of_line(read.objects.clone()).map_err(malformed)?;
        lines.push((read, objects));
    }
    let folder = folder.to_owned();
    Ok(lines.into_iter().map(move |(line, objects)| {
        let file = folder.join(&line.image);
        let bytes = fs::read(&file).map_err(unreadable(file.clone()))?;
        let size = ImageSize {
            width_px: line.width,
            height_px: line.height,
        };
        let ground = ground_of(line.position_m, line.orientation_wxyz)?;
        let still = StillImage::new(bytes, size, file.display().to_string());
        Ok(Picture {
            image: Image::encoded(Box::new(still)),
            ground,
            objects,
        })
    }))
}

/// The ground before a camera at that pose; a quaternion of another length is one of the same direction.
fn ground_of(
    position_m: [f64; 3],
    [w, x, y, z]: [f64; 4],
) -> Result<Transform<BaseLink, CameraGround>, LooksVertical> {
    let turned = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let pose = Isometry3::from_parts(Translation3::from(position_m), turned);
    Transform::<BaseLink, Optical>::new(pose).to_ground(LEVEL_M)
}
