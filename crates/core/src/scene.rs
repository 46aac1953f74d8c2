//! Identities and the fused scene.

use crate::{frame::CameraId, location::Oriented, time::Timestamp};

/// An identity. With left-to-right order it is the place in the row, per camera (docs/method.md, section 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TrackId(pub u64);

/// An observed object with its identity.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Who it is.
    pub id: TrackId,
    /// What was observed in this frame.
    pub observed: Oriented,
}

/// One object of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneObject {
    /// Who, what, where.
    pub track: Track,
    /// The cameras that saw it.
    pub seen_by: Vec<CameraId>,
    /// Capture time of the newest frame it was seen in.
    pub seen_at: Timestamp,
}

/// All objects of one completed rig round.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Count of scenes, from 0.
    pub seq: u64,
    /// The newest capture time of the round.
    pub stamp: Timestamp,
    /// In order of (camera, place in the camera's list).
    pub objects: Vec<SceneObject>,
}
