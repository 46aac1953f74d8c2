//! `truth.jsonl` of a rig dataset: what was really there.

use roadwatch_core::{
    BoxPx, Rig, SizeLwh,
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
    /// The dataset's own name for its kind, such as `Pickup Truck`; `None` where it has none.
    pub label: Option<String>,
    /// Hull of the projected cuboid, clipped to the image, pixels; `None` when nothing of it is in the image.
    pub box_px: Option<BoxPx>,
    /// The box that a perfect detector gives: of the object's outline as if nothing stood in front of it,
    /// clipped to the image, pixels; `None` where the labels do not say, as with cuboids drawn by hand.
    pub silhouette_px: Option<BoxPx>,
    /// The box of what is seen of it, pixels; `None` where the labels do not say.
    pub visible_px: Option<BoxPx>,
    /// Share of the hull outside the image, 0 to 1.
    pub truncated: f64,
    /// Share hidden by other objects, 0 to 1.
    pub occluded: f64,
    /// Centre of the cuboid.
    pub center: Point<BaseLink>,
    /// The cuboid's size; `None` where the labels do not say.
    pub size: Option<SizeLwh>,
    /// Heading about base_link's z, radians; `None` where the labels do not say.
    pub yaw_rad: Option<f64>,
}

/// What is labelled in one image.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImageLabels {
    /// The objects.
    pub objects: Vec<TruthObject>,
    /// Regions nobody labelled: what is detected there is neither right nor wrong, pixels.
    pub unlabelled_px: Vec<BoxPx>,
}

impl From<Vec<TruthObject>> for ImageLabels {
    fn from(objects: Vec<TruthObject>) -> Self {
        Self {
            objects,
            unlabelled_px: Vec::new(),
        }
    }
}

/// Of an image without any label.
static NOTHING_LABELLED: ImageLabels = ImageLabels {
    objects: Vec::new(),
    unlabelled_px: Vec::new(),
};

/// All labels of a dataset, by frame number and camera name.
#[derive(Debug, Clone, Default)]
pub struct Truth {
    frames: BTreeMap<(u64, String), ImageLabels>,
}

impl TruthObject {
    /// What a detector's box comes nearest to: the silhouette's box, or the cuboid's where that is not known.
    #[must_use]
    pub fn seen_px(&self) -> Option<BoxPx> {
        self.silhouette_px.or(self.box_px)
    }
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
    /// Labels of a camera that the rig does not have.
    #[error(
        "frame {frame} has labels of camera `{camera}`, but the rig has only {known}: add the camera to the \
         rig, or remove its labels"
    )]
    UnknownCamera {
        /// The first frame with such labels.
        frame: u64,
        /// The camera.
        camera: String,
        /// The rig's cameras.
        known: String,
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
    #[serde(default)]
    label: Option<String>,
    box_px: [f32; 4],
    #[serde(default)]
    silhouette_px: Option<[f32; 4]>,
    /// A box in our own datasets; others count pixels under this name.
    #[serde(default)]
    visible_px: serde_json::Value,
    truncated: f64,
    occluded: f64,
    center_base_m: [f64; 3],
    #[serde(default)]
    size_lwh_m: Option<[f64; 3]>,
    #[serde(default)]
    yaw_base_rad: Option<f64>,
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
            let objects: Vec<_> = line.objects.into_iter().map(TruthObject::from).collect();
            frames.insert((line.frame, line.camera), objects.into());
        }
        Ok(Self { frames })
    }

    /// Every class that is labelled, in order.
    #[must_use]
    pub fn classes(&self) -> BTreeSet<&str> {
        self.frames
            .values()
            .flat_map(|labels| &labels.objects)
            .map(|object| object.class.as_str())
            .collect()
    }

    /// What is labelled in one image; empty where nothing is.
    #[must_use]
    pub fn labels(&self, frame: u64, camera: &str) -> &ImageLabels {
        let found = self.frames.get(&(frame, camera.to_owned()));
        found.unwrap_or(&NOTHING_LABELLED)
    }

    /// The objects in one image; none where nothing is labelled.
    #[must_use]
    pub fn objects(&self, frame: u64, camera: &str) -> &[TruthObject] {
        &self.labels(frame, camera).objects
    }

    /// Checks that whoever has labels is a camera of the rig.
    ///
    /// # Errors
    /// The first labels of a camera that the rig does not have: a slip that would score nothing.
    pub fn check_cameras(&self, rig: &Rig) -> Result<(), TruthError> {
        let mut images = self.frames.keys();
        let unknown = images.find(|(_, camera)| rig.find(camera).is_none());
        let Some((frame, camera)) = unknown else {
            return Ok(());
        };
        let known: Vec<_> = rig.cameras().iter().map(|c| c.name.as_str()).collect();
        Err(TruthError::UnknownCamera {
            frame: *frame,
            camera: camera.clone(),
            known: known.join(", "),
        })
    }

    /// Every object that is labelled in a camera's images, in order of frames.
    pub fn of_camera(&self, camera: &str) -> impl Iterator<Item = &TruthObject> {
        let frames = self.frames.iter();
        let frames = frames.filter(move |((_, name), _)| name == camera);
        frames.flat_map(|(_, labels)| &labels.objects)
    }
}

impl<L: Into<ImageLabels>> FromIterator<((u64, String), L)> for Truth {
    /// Labels by frame number and camera name.
    fn from_iter<I>(frames: I) -> Self
    where
        I: IntoIterator<Item = ((u64, String), L)>,
    {
        let frames = frames.into_iter();
        Self {
            frames: frames
                .map(|(image, labels)| (image, labels.into()))
                .collect(),
        }
    }
}

impl From<Object> for TruthObject {
    fn from(object: Object) -> Self {
        let [x, y, z] = object.center_base_m;
        let to_box =
            |[x_min, y_min, x_max, y_max]: [f32; 4]| BoxPx::new(x_min, y_min, x_max, y_max);
        let to_size = |[length_m, width_m, height_m]: [f64; 3]| SizeLwh {
            length_m,
            width_m,
            height_m,
        };
        Self {
            id: object.id,
            class: object.class,
            label: object.label,
            box_px: to_box(object.box_px),
            silhouette_px: object.silhouette_px.and_then(to_box),
            visible_px: serde_json::from_value(object.visible_px)
                .ok()
                .and_then(to_box),
            truncated: object.truncated,
            occluded: object.occluded,
            center: Point::new(x, y, z),
            size: object.size_lwh_m.map(to_size),
            yaw_rad: object.yaw_base_rad,
        }
    }
}

/// The objects of a line, from its `objects`.
pub(crate) fn objects_of_line(
    objects: serde_json::Value,
) -> Result<Vec<TruthObject>, serde_json::Error> {
    let objects: Vec<Object> = serde_json::from_value(objects)?;
    Ok(objects.into_iter().map(TruthObject::from).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = r#"{"frame": 3, "camera": "front", "objects": [
        {"id": "a", "class": "car", "box_px": [10, 20, 50, 60], "truncated": 0, "occluded": 0.1,
         "center_base_m": [20, 1, 0.7], SEEN "label": "Car"}]}"#;

    fn read(seen: &str) -> Result<Truth, TruthError> {
        let folder = tempfile::tempdir().expect("a folder");
        let line = LINE.replace('\n', "").replace("SEEN", seen);
        fs::write(folder.path().join(TRUTH_FILE), line).expect("written");
        Truth::read(folder.path())
    }

    fn seen_px(seen: &str) -> Option<BoxPx> {
        let truth = read(seen).expect("labels");
        truth.objects(3, "front")[0].seen_px()
    }

    #[test]
    fn the_silhouette_is_what_is_seen_and_the_cuboid_where_there_is_none() {
        let silhouette = r#""silhouette_px": [11, 22, 49, 59], "visible_px": [11, 22, 30, 59],"#;
        assert_eq!(seen_px(silhouette), BoxPx::new(11.0, 22.0, 49.0, 59.0));
        assert_eq!(seen_px(""), BoxPx::new(10.0, 20.0, 50.0, 60.0));
        assert_eq!(
            seen_px(r#""silhouette_px": null,"#),
            BoxPx::new(10.0, 20.0, 50.0, 60.0)
        );
    }

    #[test]
    fn a_silhouette_that_is_no_box_is_named_with_its_line() {
        let refused = read(r#""silhouette_px": [1, 2, 3],"#).expect_err("three numbers");
        assert!(refused.to_string().contains("truth.jsonl:1"), "{refused}");
    }
}
