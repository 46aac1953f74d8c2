//! `truth.jsonl` of a rig dataset: what was really there.

use roadwatch_core::{
    BoxPx,
    space::{BaseLink, Point},
};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Path, PathBuf},
};

const TRUTH_FILE: &str = "truth.jsonl";

/// A labelled object in one image.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthObject {
    /// The same object has the same id in every frame.
    pub id: String,
    /// COCO-style class.
    pub class: String,
    /// Hull of the projected cuboid, clipped to the image, pixels; `None` when nothing of it is in the image.
    pub box_px: Option<BoxPx>,
    /// Share of the hull outside the image, 0 to 1.
    pub truncated: f64,
    /// Share hidden by other objects, 0 to 1.
    pub occluded: f64,
    /// Centre of the cuboid.
    pub center: Point<BaseLink>,
}

/// All labels of a dataset, by frame number and camera name.
#[derive(Debug, Clone, Default)]
pub struct Truth {
    frames: BTreeMap<(u64, String), Vec<TruthObject>>,
}

/// Labels that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TruthError {
    /// The file is not there or not readable.
    #[error("cannot read the labels `{}`", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// A line is not a label.
    #[error("{}:{line}: not a line of labels", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Why.
        #[source]
        cause: serde_json::Error,
    },
}

#[derive(Deserialize)]
struct Line {
    frame: u64,
    camera: String,
    objects: Vec<Object>,
}

#[derive(Deserialize)]
struct Object {
    id: String,
    class: String,
    box_px: [f32; 4],
    truncated: f64,
    occluded: f64,
    center_base_m: [f64; 3],
}

impl Truth {
    /// Reads `truth.jsonl` of a dataset's folder.
    ///
    /// # Errors
    /// When the file is absent or a line is malformed, with the line's number.
    pub fn read(folder: &Path) -> Result<Self, TruthError> {
        let file = folder.join(TRUTH_FILE);
        let text = fs::read_to_string(&file).map_err(|cause| TruthError::Unreadable {
            file: file.clone(),
            cause,
        })?;
        let mut frames = BTreeMap::new();
        for (at, line) in text.lines().enumerate() {
            if line.trim().is_empty() {
                continue;
            }
            let line: Line = serde_json::from_str(line).map_err(|cause| TruthError::Malformed {
                file: file.clone(),
                line: at + 1,
                cause,
            })?;
            let objects = line.objects.into_iter().map(TruthObject::from).collect();
            frames.insert((line.frame, line.camera), objects);
        }
        Ok(Self { frames })
    }

    /// Every class that is labelled, in order.
    #[must_use]
    pub fn classes(&self) -> BTreeSet<&str> {
        self.frames
            .values()
            .flatten()
            .map(|object| object.class.as_str())
            .collect()
    }

    /// The objects in one image; none where nothing is labelled.
    #[must_use]
    pub fn objects(&self, frame: u64, camera: &str) -> &[TruthObject] {
        let found = self.frames.get(&(frame, camera.to_owned()));
        found.map_or(&[], Vec::as_slice)
    }
}

impl From<Object> for TruthObject {
    fn from(object: Object) -> Self {
        let [x_min, y_min, x_max, y_max] = object.box_px;
        let [x, y, z] = object.center_base_m;
        Self {
            id: object.id,
            class: object.class,
            box_px: BoxPx::new(x_min, y_min, x_max, y_max),
            truncated: object.truncated,
            occluded: object.occluded,
            center: Point::new(x, y, z),
        }
    }
}
