//! A sink that keeps what was perceived, for scoring afterwards.

use crate::identity::PublishedScene;
use roadwatch_core::{
    CameraId, Detection, Heading, Known, Location, Output, RigCamera, Sink, SinkError,
    SlopeEvidence, Timestamp, Track,
};
use std::sync::{Arc, Mutex, PoisonError};

/// What was made of one frame, without its image.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The camera.
    pub camera: CameraId,
    /// Capture time.
    pub captured_at: Timestamp,
    /// Objects with a place.
    pub tracks: Vec<Track>,
    /// Detections without.
    pub unlocated: Vec<Detection>,
}

impl Recorded {
    /// Every detection of the frame, with a place or without.
    pub fn detections(&self) -> impl Iterator<Item = &Detection> {
        let located = self
            .tracks
            .iter()
            .map(|track| &track.observed.located.detection);
        located.chain(&self.unlocated)
    }

    /// What the frame by itself says of the place of the detection that [`Recorded::detections`] gives at `index`, and
    /// of its heading; `None` without a place.
    #[must_use]
    pub fn single(&self, index: usize) -> Option<Answer> {
        let observed = &self.tracks.get(index)?.observed;
        Some((
            observed.located.location.clone(),
            observed.heading.map(|kept| kept.heading),
        ))
    }

    /// What was published of it.
    #[must_use]
    pub fn published(&self, index: usize, camera: &RigCamera) -> Option<Answer> {
        let track = self.tracks.get(index)?;
        let position = track.position();
        let location = Location {
            position,
            covariance: track.covariance(),
            size: track.size(),
            depth_m: camera.depth_m(position),
            range_m: camera.range_m(position),
            ..track.observed.located.location.clone()
        };
        Some((location, track.heading()))
    }

    /// What is known of the detection beside its box: of the ground by other objects. Nothing of itself from
    /// earlier frames, so that every method stands alone.
    #[must_use]
    pub fn known(&self, index: usize) -> Known {
        let located = self.tracks.get(index).map(|track| &track.observed.located);
        Known {
            object: None,
            slopes: located.map_or_else(SlopeEvidence::default, |located| located.slopes),
        }
    }
}

/// A place, and the heading that was decided for.
pub type Answer = (Location, Option<Heading>);

/// Everything that was published, in its order.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    /// What was made of each frame.
    pub frames: Vec<Recorded>,
    /// The fused scenes.
    pub scenes: Vec<PublishedScene>,
}

/// The sink. Clones share what is kept.
#[derive(Debug, Clone, Default)]
pub struct Recorder(Arc<Mutex<Recording>>);

impl Recorder {
    /// Takes everything kept so far.
    #[must_use]
    pub fn take(&self) -> Recording {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Sink for Recorder {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match output {
            Output::Camera(perceived) => kept.frames.push(Recorded {
                camera: perceived.tracks.frame.camera,
                captured_at: perceived.tracks.frame.captured_at,
                tracks: perceived.tracks.items.clone(),
                unlocated: perceived.unlocated.clone(),
            }),
            Output::Scene(scene) => kept.scenes.push(PublishedScene::from(&**scene)),
        }
        Ok(())
    }
}
