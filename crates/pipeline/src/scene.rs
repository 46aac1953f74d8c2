//! One scene per rig round: each camera's next frame once.

use crate::camera_set::CameraSet;
use roadwatch_core::{CameraId, Perceived, Scene, SceneObject, Timestamp};
use std::{
    collections::BTreeMap,
    sync::Arc,
    time::{Duration, Instant},
};

/// Collects the frames of a round and closes it when every live camera has spoken.
pub struct SceneAssembler {
    timeout: Option<Duration>,
    seq: u64,
    round: BTreeMap<CameraId, Option<Arc<Perceived>>>,
    /// When the round began.
    began: Option<Instant>,
}

impl SceneAssembler {
    /// Rounds that wait for silent cameras at most for `timeout`, or for ever with `None`.
    #[must_use]
    pub fn new(timeout: Option<Duration>) -> Self {
        Self {
            timeout,
            seq: 0,
            round: BTreeMap::new(),
            began: None,
        }
    }

    /// Takes a camera's next frame, or `None` when that frame was dropped. Gives the scene when the round
    /// is complete: every camera of `live` has spoken. A second frame of a camera replaces its first.
    pub fn offer(
        &mut self,
        camera: CameraId,
        perceived: Option<Arc<Perceived>>,
        live: &CameraSet,
        now: Instant,
    ) -> Option<Scene> {
        self.began.get_or_insert(now);
        self.round.insert(camera, perceived);
        let spoken: CameraSet = self.round.keys().copied().collect();
        if live.is_subset(&spoken) || self.is_overdue(now) {
            return self.close();
        }
        None
    }

    /// Gives the scene when the round has waited too long.
    pub fn tick(&mut self, now: Instant) -> Option<Scene> {
        if self.is_overdue(now) {
            self.close()
        } else {
            None
        }
    }

    /// Time until [`SceneAssembler::tick`] may give a scene; `None` while no round waits.
    #[must_use]
    pub fn due_in(&self, now: Instant) -> Option<Duration> {
        let due = self.began? + self.timeout?;
        Some(due.saturating_duration_since(now))
    }

    /// Ends the round as it is; `None` when no frame of it was perceived.
    pub fn close(&mut self) -> Option<Scene> {
        self.began = None;
        let round = std::mem::take(&mut self.round);
        let mut stamp: Option<Timestamp> = None;
        let mut objects = Vec::new();
        for (camera, perceived) in round {
            let Some(perceived) = perceived else {
                continue;
            };
            let seen_at = perceived.tracks.frame.captured_at;
            stamp = stamp.max(Some(seen_at));
            objects.extend(perceived.tracks.items.iter().map(|track| SceneObject {
                track: track.clone(),
                seen_by: vec![camera],
                seen_at,
            }));
        }
        let scene = Scene {
            seq: self.seq,
            stamp: stamp?,
            objects,
        };
        self.seq += 1;
        Some(scene)
    }

    fn is_overdue(&self, now: Instant) -> bool {
        self.due_in(now).is_some_and(|left| left.is_zero())
    }
}
