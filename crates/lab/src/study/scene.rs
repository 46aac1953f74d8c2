//! A simulated drive that a study can be made on.

use super::seen::{SeenVehicle, study_filter};
use crate::truth::{Truth, TruthError, TruthObject};
use roadwatch_camera::{DatasetError, RigDataset};
use roadwatch_core::{Rig, RigCamera, rig::InvalidRig};
use serde::Serialize;
use std::{
    fmt,
    path::{Path, PathBuf},
};

/// Height of the ground in base_link: the simulator's base_link lies on it, metres.
pub(super) const GROUND_Z_M: f64 = 0.0;
/// A path is straight when its vehicle strays no more than this to one side of it, metres.
const STRAIGHT_M: f64 = 0.5;
/// A path is at least this long, metres; shorter ones say nothing about distances.
const LEAST_PATH_M: f64 = 5.0;

/// What moves how, told by the labels alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// One vehicle crosses at one depth (the paper, Fig. 2).
    XPath,
    /// One vehicle drives along the optical axis (the paper, Fig. 2.1).
    YPath,
    /// One vehicle stands all over the ground.
    Grid,
    /// Several vehicles.
    Vehicles,
}

impl Shape {
    /// Its name in reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::XPath => "x_path",
            Self::YPath => "y_path",
            Self::Grid => "grid",
            Self::Vehicles => "vehicles",
        }
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// One drive with the boxes that were seen in it.
#[derive(Debug, Clone)]
pub struct StudyScene {
    /// The dataset's folder.
    pub folder: PathBuf,
    /// What moves how.
    pub shape: Shape,
    /// Its only camera.
    pub camera: RigCamera,
    /// Vehicles in images that count, seen or not.
    pub positions: usize,
    /// Boxes with what was really there; empty until somebody looked.
    pub seen: Vec<SeenVehicle>,
}

/// A dataset on which no study can be made.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The rig or the frames.
    #[error("`{}` is no rig dataset", folder.display())]
    Dataset {
        /// The dataset.
        folder: PathBuf,
        /// Why.
        #[source]
        cause: DatasetError,
    },
    /// The labels.
    #[error(
        "`{}` has no usable labels, and a study needs the truth: make the dataset with `roadwatch-simulate scenario`",
        folder.display()
    )]
    Truth {
        /// The dataset.
        folder: PathBuf,
        /// Why.
        #[source]
        cause: TruthError,
    },
    /// The rig cannot be.
    #[error("`{}`: {cause}", folder.display())]
    Rig {
        /// The dataset.
        folder: PathBuf,
        /// Why.
        cause: InvalidRig,
    },
    /// More or fewer cameras than the one that the paper has.
    #[error("`{}` has {cameras} cameras; a study takes datasets of one camera", folder.display())]
    Cameras {
        /// The dataset.
        folder: PathBuf,
        /// How many there are.
        cameras: usize,
    },
    /// No vehicle that is well visible.
    #[error(
        "no car, truck or bus is labelled and well visible in `{}`: give a dataset of one of the scenarios \
         paper_x_path, long_path, grid or vehicles",
        folder.display()
    )]
    Empty {
        /// The dataset.
        folder: PathBuf,
    },
    /// One vehicle that hardly moves.
    #[error(
        "`{}` is none of the study's scenes: its one vehicle keeps within {along_m:.1} m along the optical axis and \
         {aside_m:.1} m aside; an X path or Y path is at least 5 m long",
        folder.display()
    )]
    NoShape {
        /// The dataset.
        folder: PathBuf,
        /// Extent of its places along the axis, metres.
        along_m: f64,
        /// And across it.
        aside_m: f64,
    },
}

/// A dataset and its labels, before anybody looked at its images.
#[derive(Debug)]
pub struct OpenedScene {
    /// The dataset.
    pub dataset: RigDataset,
    /// Its labels.
    pub truth: Truth,
    /// Its rig, over the simulator's ground.
    pub rig: Rig,
    /// The scene, with nothing seen yet.
    pub scene: StudyScene,
}

impl StudyScene {
    /// Reads a dataset of one camera, its labels, and what moves how in it.
    ///
    /// # Errors
    /// When the dataset or its labels cannot be read, it has more than one camera, or no study fits it.
    pub fn open(folder: &Path) -> Result<OpenedScene, SceneError> {
        let owned = || folder.to_owned();
        let dataset = RigDataset::open(folder).map_err(|cause| SceneError::Dataset {
            folder: owned(),
            cause,
        })?;
        let unusable = |cause| SceneError::Truth {
            folder: owned(),
            cause,
        };
        let truth = Truth::read(folder).map_err(unusable)?;
        let [camera] = dataset.cameras() else {
            return Err(SceneError::Cameras {
                folder: owned(),
                cameras: dataset.cameras().len(),
            });
        };
        let camera = camera.clone();
        let rig = Rig::new(vec![camera.clone()], GROUND_Z_M).map_err(|cause| SceneError::Rig {
            folder: owned(),
            cause,
        })?;
        truth.check_cameras(&rig).map_err(unusable)?;
        let filter = study_filter();
        let labelled = truth.of_camera(camera.name.as_str());
        let objects: Vec<_> = labelled.filter(|object| filter.admits(object)).collect();
        let scene = StudyScene {
            folder: owned(),
            shape: shape(folder, &objects, &camera)?,
            positions: objects.len(),
            camera,
            seen: Vec::new(),
        };
        Ok(OpenedScene {
            dataset,
            truth,
            rig,
            scene,
        })
    }
}

fn shape(folder: &Path, objects: &[&TruthObject], camera: &RigCamera) -> Result<Shape, SceneError> {
    let folder = || folder.to_owned();
    let Some(first) = objects.first() else {
        return Err(SceneError::Empty { folder: folder() });
    };
    if objects.iter().any(|object| object.id != first.id) {
        return Ok(Shape::Vehicles);
    }
    let places = objects.iter().map(|object| in_camera(object, camera));
    let (along_m, aside_m) = extents(places);
    match (along_m >= LEAST_PATH_M, aside_m >= LEAST_PATH_M) {
        (true, true) => Ok(Shape::Grid),
        (true, false) if aside_m <= STRAIGHT_M => Ok(Shape::YPath),
        (false, true) if along_m <= STRAIGHT_M => Ok(Shape::XPath),
        _ => Err(SceneError::NoShape {
            folder: folder(),
            along_m,
            aside_m,
        }),
    }
}

/// Along the optical axis and to its right, metres.
pub(super) fn in_camera(object: &TruthObject, camera: &RigCamera) -> (f64, f64) {
    let place = camera.base_from_optical.inverse() * object.center;
    (place.z(), place.x())
}

fn extents(places: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
    let widen = |(low, high): (f64, f64), at: f64| (low.min(at), high.max(at));
    let (along, aside) = places.fold((NOTHING, NOTHING), |(along, aside), (z, x)| {
        (widen(along, z), widen(aside, x))
    });
    (along.1 - along.0, aside.1 - aside.0)
}
