//! The boxes that a study locates: what an ideal detector sees, or a real one.

use super::scene::OpenedScene;
use crate::{
    evaluate::{Evaluation, LostImages},
    matching::TruthFilter,
    recorder::Recorded,
    sample::Target,
};
use roadwatch_core::{Detection, ObjectClass, Score};
use serde::Serialize;
use std::sync::Arc;

/// Whose boxes are located.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BoxSource {
    /// Of the labels: the box of the silhouette.
    Truth,
    /// A detector's.
    Detector,
}

impl BoxSource {
    /// Its name in reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Truth => "truth",
            Self::Detector => "detector",
        }
    }
}

/// A box and the vehicle that it is taken for.
#[derive(Debug, Clone)]
pub struct SeenVehicle {
    /// The box.
    pub detection: Detection,
    /// What was really there.
    pub target: Arc<Target>,
}

/// Which vehicles count: whole and well visible ones.
///
/// The cuboid of a car 6 m ahead reaches below the image by an eighth while its silhouette is still whole, hence the
/// share outside; an image's rows are twice as many here as where 20 px is the least height elsewhere, but 60 m away a
/// low car is no higher than 28 px.
#[must_use]
pub fn study_filter() -> TruthFilter {
    TruthFilter {
        min_height_px: 20.0,
        max_occluded: 0.3,
        max_truncated: 0.15,
        classes: ["car", "truck", "bus"].map(str::to_owned).into(),
    }
}

/// What an ideal detector sees: the box of every silhouette, of the labelled class.
#[must_use]
pub fn seen_by_labels(opened: &OpenedScene) -> Vec<SeenVehicle> {
    let camera = &opened.scene.camera;
    let filter = study_filter();
    let labelled = opened.truth.of_camera(camera.name.as_str());
    let seen = labelled.filter(|object| filter.admits(object));
    let seen = seen.filter_map(|object| {
        let detection = Detection {
            class: ObjectClass::new(&object.class),
            score: Score::new(1.0)?,
            input_pixel_px: 1.0,
            box_px: object.seen_px()?,
        };
        let target = Arc::new(Target::new(object, camera, true));
        Some(SeenVehicle { detection, target })
    });
    seen.collect()
}

/// What a detector saw, matched to the labels as an evaluation does.
#[must_use]
pub fn seen_by_detector(opened: &OpenedScene, recorded: &[Recorded]) -> Vec<SeenVehicle> {
    let filter = study_filter();
    let evaluation = Evaluation {
        rig: &opened.rig,
        dataset: &opened.dataset,
        truth: &opened.truth,
        filter: &filter,
        lost_images: LostImages::Count,
        frame_limit: None,
    };
    let pairs = evaluation.pairs(recorded).into_iter();
    pairs
        .map(|(detection, target)| SeenVehicle { detection, target })
        .collect()
}
