//! One scene per rig round: each camera's next frame once.

use crate::camera_set::CameraSet;
use roadwatch_core::{CameraId, Perceived, Scene, SceneObject, Timestamp};
use std::{
    collections::BTreeMap,
    sync::Arc,
    time::{Duration, Instant},
};

/// Collects the frames of a round and closes it when every live camera has spoken.
///
/// A slow machine does not split rounds: the inbox serves every camera whose frame waits before it serves
/// one twice, so a round only stays open for cameras that have nothing to say.
pub struct SceneAssembler {
    timeout: Option<Duration>,
    seq: u64,
    round: BTreeMap<CameraId, Option<Arc<Perceived>>>,
    began: Option<Instant>,
    last_heard: Option<Instant>,
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
            last_heard: None,
        }
    }

    /// Takes a camera's next frame, or `None` when that frame was dropped.
    ///
    /// Gives the scene when the round is complete: every camera of `live` has spoken. A second frame of a
    /// camera replaces its first, or closes a round that is older than the timeout and begins the next.
    pub fn offer(
        &mut self,
        camera: CameraId,
        perceived: Option<Arc<Perceived>>,
        live: &CameraSet,
        now: Instant,
    ) -> Vec<Scene> {
        let speaks_again = self.round.contains_key(&camera);
        let overdue = if speaks_again && self.left(self.began, now) == Some(Duration::ZERO) {
            self.close()
        } else {
            None
        };
        self.began.get_or_insert(now);
        self.last_heard = Some(now);
        self.round.insert(camera, perceived);
        let spoken: CameraSet = self.round.keys().copied().collect();
        let complete = if live.is_subset(&spoken) {
            self.close()
        } else {
            None
        };
        overdue.into_iter().chain(complete).collect()
    }

    /// Gives the scene when nobody has spoken for the timeout.
    pub fn tick(&mut self, now: Instant) -> Option<Scene> {
        if self.due_in(now) == Some(Duration::ZERO) {
            self.close()
        } else {
            None
        }
    }

    /// Begins the wait anew: somebody is about to speak.
    pub fn wait_on(&mut self, now: Instant) {
        self.last_heard = self.last_heard.map(|_| now);
    }

    /// Time until [`SceneAssembler::tick`] may give a scene; `None` while no round waits.
    #[must_use]
    pub fn due_in(&self, now: Instant) -> Option<Duration> {
        self.left(self.last_heard, now)
    }

    /// Ends the round as it is; `None` when no frame of it was perceived.
    pub fn close(&mut self) -> Option<Scene> {
        self.began = None;
        self.last_heard = None;
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

    fn left(&self, since: Option<Instant>, now: Instant) -> Option<Duration> {
        Some((since? + self.timeout?).saturating_duration_since(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_core::{Frame, Image, ImageSize, PerFrame, Pixels};

    const TIMEOUT: Duration = Duration::from_millis(200);

    fn seen(camera: u8, stamp: i64) -> Option<Arc<Perceived>> {
        let size = ImageSize {
            width_px: 1,
            height_px: 1,
        };
        let frame = Frame {
            camera: CameraId(camera),
            seq: 0,
            captured_at: Timestamp::from_nanos(stamp),
            received_at: Instant::now(),
            image: Image::decoded(Pixels::new(size, vec![0; 3]).expect("pixels")),
        };
        Some(Arc::new(Perceived {
            tracks: PerFrame {
                frame,
                items: Vec::new(),
            },
            unlocated: Vec::new(),
        }))
    }

    fn stamps(scenes: impl IntoIterator<Item = Scene>) -> Vec<i64> {
        scenes
            .into_iter()
            .map(|scene| scene.stamp.as_nanos())
            .collect()
    }

    #[test]
    fn slow_rounds_stay_whole() {
        let live: CameraSet = [CameraId(0), CameraId(1)].into_iter().collect();
        let mut scenes = SceneAssembler::new(Some(TIMEOUT));
        let began = Instant::now();
        // Half a second between two frames of one round, as on a slow machine; nobody ticks in between.
        assert!(
            scenes
                .offer(CameraId(0), seen(0, 1), &live, began)
                .is_empty()
        );
        let late = began + Duration::from_millis(500);
        assert_eq!(
            stamps(scenes.offer(CameraId(1), seen(1, 2), &live, late)),
            [2]
        );
    }

    #[test]
    fn a_camera_that_speaks_again_closes_an_overdue_round() {
        let live: CameraSet = [CameraId(0), CameraId(1)].into_iter().collect();
        let mut scenes = SceneAssembler::new(Some(TIMEOUT));
        let began = Instant::now();
        let at = |millis| began + Duration::from_millis(millis);
        assert!(
            scenes
                .offer(CameraId(0), seen(0, 1), &live, at(0))
                .is_empty()
        );
        assert!(
            scenes
                .offer(CameraId(0), seen(0, 2), &live, at(100))
                .is_empty()
        );
        assert_eq!(
            stamps(scenes.offer(CameraId(0), seen(0, 3), &live, at(200))),
            [2]
        );
        assert_eq!(stamps(scenes.tick(at(399))), Vec::<i64>::new());
        assert_eq!(stamps(scenes.tick(at(400))), [3]);
    }

    #[test]
    fn a_round_of_dropped_frames_gives_no_scene() {
        let live: CameraSet = [CameraId(0)].into_iter().collect();
        let mut scenes = SceneAssembler::new(None);
        assert!(
            scenes
                .offer(CameraId(0), None, &live, Instant::now())
                .is_empty()
        );
    }
}
