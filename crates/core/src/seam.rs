//! The seams: one object-safe trait per stage, synchronous, with one required method where one is enough.

use crate::{
    detection::Detection,
    ego::Ego,
    frame::{CameraId, DecodeError, Frame, PerFrame},
    location::{Heading, Known, Located, Location, Oriented, Rotation},
    scene::{Scene, SceneObject, Track},
    time::Timestamp,
};
use std::{
    error::Error,
    sync::Arc,
    time::{Duration, Instant},
};

type Cause = Box<dyn Error + Send + Sync>;

/// Why a source gave no frame.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// No frame before the deadline; ask again.
    #[error("no frame before the deadline")]
    Timeout,
    /// The device or stream went away; asking again tries to reconnect.
    #[error("camera disconnected")]
    Disconnected(#[source] Cause),
    /// One frame was lost or damaged in the source; the next may be fine.
    #[error("frame lost")]
    FrameLost(#[source] Cause),
    /// The recording is over; asking again gives the same answer.
    #[error("end of recording")]
    EndOfStream,
}

/// A camera, a file or a topic that frames come from. Each lives on a thread of its own.
pub trait FrameSource: Send {
    /// Waits for the next frame, at most until `deadline`, so that a hung camera never blocks shutdown.
    ///
    /// # Errors
    /// See [`SourceError`].
    fn next_frame(&mut self, deadline: Instant) -> Result<Frame, SourceError>;
}

/// Why a frame has no detections.
#[derive(Debug, thiserror::Error)]
pub enum DetectError {
    /// The image could not be decoded.
    #[error("image not decoded: {0}")]
    Decode(DecodeError),
    /// The network failed.
    #[error("inference failed")]
    Inference(#[source] Cause),
}

/// Finds objects in images. Shared by all cameras, and by the lanes of the runner: while one call runs
/// the network, another prepares its images.
pub trait Detector: Send + Sync {
    /// One result per frame, in the same order; a broken image fails alone.
    fn detect(&self, frames: Vec<Frame>) -> Vec<Result<PerFrame<Detection>, DetectError>>;

    /// The most frames one call takes at an advantage; 1 where the model's batch axis is fixed.
    fn max_batch(&self) -> usize {
        1
    }

    /// How long the next call can begin later without losing throughput, because the network is busy until
    /// then: frames taken later are newer. Zero when it is free.
    fn hold_off(&self) -> Duration {
        Duration::ZERO
    }
}

/// Says where a detected object is. One per camera; remembers nothing.
pub trait Locator: Send {
    /// `None` when neither the box nor an earlier location gives one.
    fn locate(&self, detection: &Detection, known: &Known) -> Option<Location>;
}

/// No heading could be estimated in a frame. Its objects keep what they had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no headings: {reason}")]
pub struct RotationError {
    reason: String,
}

impl RotationError {
    /// An error that says why.
    pub fn new(reason: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
        }
    }
}

/// Says which way located objects point. One for the rig; remembers nothing.
pub trait RotationEstimator: Send {
    /// Whether it has anything to say of such an object; what it does not want costs no share of the budget.
    fn wants(&self, located: &Located) -> bool;

    /// One answer per object, in order, given the heading each had with its deviation now; `None` where the image
    /// shows nothing of one.
    ///
    /// # Errors
    /// When the frame gives no headings at all: its image is gone, or the network failed.
    fn estimate(
        &mut self,
        frame: &Frame,
        objects: &[(&Located, Option<Heading>)],
    ) -> Result<Vec<Option<Rotation>>, RotationError>;
}

/// Says who is who; the only memory, of objects and of the ground they stand on.
pub trait Reidentifier: Send {
    /// What earlier frames know about each detection of this frame, in the same order. `ego` is where the vehicle is at
    /// the frame's capture.
    fn recall(&self, seen: &PerFrame<Detection>, ego: &Ego) -> Vec<Known>;

    /// Takes a frame's objects into memory and gives each its identity, in the same order. `unlocated` are
    /// the frame's other detections: nobody gets to know them, but they stand in the row.
    fn commit(
        &mut self,
        seen: PerFrame<Oriented>,
        unlocated: &[Detection],
        ego: &Ego,
    ) -> PerFrame<Track>;

    /// The objects of a round at its stamp, `ego` where the vehicle is then. By itself each camera's objects stand side
    /// by side: who two cameras see is there twice.
    fn scene(&mut self, round: &Round, ego: &Ego) -> Vec<SceneObject> {
        let _ = ego;
        round.side_by_side()
    }
}

/// What was made of one rig round: each camera's next frame once.
#[derive(Clone, Debug)]
pub struct Round {
    /// Count of rounds, from 0.
    pub seq: u64,
    /// The newest capture time.
    pub stamp: Timestamp,
    /// Of each camera that had a frame, in order of their ids.
    pub perceived: Vec<Arc<Perceived>>,
}

impl Round {
    fn side_by_side(&self) -> Vec<SceneObject> {
        let of_camera = |perceived: &Arc<Perceived>| {
            let Frame {
                camera,
                captured_at,
                ..
            } = perceived.tracks.frame;
            let object = move |track: &Track| SceneObject {
                track: track.clone(),
                seen_by: vec![camera],
                seen_at: captured_at,
                stamp: captured_at,
                trail: Vec::new(),
            };
            perceived
                .tracks
                .items
                .iter()
                .map(object)
                .collect::<Vec<_>>()
        };
        self.perceived.iter().flat_map(of_camera).collect()
    }
}

/// All that was made of one frame.
#[derive(Clone, Debug)]
pub struct Perceived {
    /// The objects with place and identity; an empty list when nothing was seen.
    pub tracks: PerFrame<Track>,
    /// What was detected and has no place: a class without a known size, a box no method can locate.
    pub unlocated: Vec<Detection>,
    /// Where the vehicle was.
    pub ego: Ego,
}

/// What the pipeline hands to its sinks.
#[derive(Clone, Debug)]
pub enum Output {
    /// One frame of one camera.
    Camera(Arc<Perceived>),
    /// A completed rig round.
    Scene(Arc<Scene>),
}

impl Output {
    /// The camera this came from; `None` for the scene.
    #[must_use]
    pub fn camera(&self) -> Option<CameraId> {
        match self {
            Self::Camera(perceived) => Some(perceived.tracks.frame.camera),
            Self::Scene(_) => None,
        }
    }

    /// Capture time.
    #[must_use]
    pub fn stamp(&self) -> Timestamp {
        match self {
            Self::Camera(perceived) => perceived.tracks.frame.captured_at,
            Self::Scene(scene) => scene.stamp,
        }
    }
}

/// One output could not be delivered. It is counted and the next is tried.
#[derive(Debug, thiserror::Error)]
#[error("{what}")]
pub struct SinkError {
    what: String,
    #[source]
    cause: Cause,
}

impl SinkError {
    /// An error that says what was not delivered, and why.
    pub fn new(what: impl Into<String>, cause: impl Into<Cause>) -> Self {
        Self {
            what: what.into(),
            cause: cause.into(),
        }
    }
}

/// Somewhere outputs go: ROS 2, a bag, a report. Each lives on a thread of its own.
pub trait Sink: Send {
    /// Delivers one output.
    ///
    /// # Errors
    /// When this output is lost; the sink stays usable for the next.
    fn publish(&mut self, output: &Output) -> Result<(), SinkError>;

    /// Called once after the last output: flush, close, write what must come last.
    ///
    /// # Errors
    /// When what was published before may be incomplete.
    fn finish(&mut self) -> Result<(), SinkError> {
        Ok(())
    }
}

/// Monotonic time, so that tests can own it.
pub trait Clock: Send + Sync {
    /// Now.
    fn now(&self) -> Instant;
}
