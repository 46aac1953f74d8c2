//! Rig rounds: each camera's next frame once.

use crate::camera_set::CameraSet;
use roadwatch_core::{CameraId, Perceived, Round};
use std::{
    collections::BTreeMap,
    sync::Arc,
    time::{Duration, Instant},
};

/// Collects the frames of a round and closes it when every live camera has spoken.
///
/// A slow machine does not split rounds: the inbox serves every camera whose frame waits before it serves
/// one twice, so a round only stays open for cameras that have nothing to say.
pub struct RoundAssembler {
    timeout: Option<Duration>,
    seq: u64,
    round: BTreeMap<CameraId, Option<Arc<Perceived>>>,
    began: Option<Instant>,
    last_heard: Option<Instant>,
}

impl RoundAssembler {
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
    /// Gives the round when the round is complete: every camera of `live` has spoken. A second frame of a
    /// camera replaces its first, or closes a round that is older than the timeout and begins the next.
    pub fn offer(
        &mut self,
        camera: CameraId,
        perceived: Option<Arc<Perceived>>,
        live: &CameraSet,
        now: Instant,
    ) -> Vec<Round> {
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

    /// Gives the round when nobody has spoken for the timeout.
    pub fn tick(&mut self, now: Instant) -> Option<Round> {
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

    /// Time until [`RoundAssembler::tick`] may give one; `None` while no round waits.
    #[must_use]
    pub fn due_in(&self, now: Instant) -> Option<Duration> {
        self.left(self.last_heard, now)
    }

    /// Ends the round as it is; `None` when no frame of it was perceived.
    pub fn close(&mut self) -> Option<Round> {
        self.began = None;
        self.last_heard = None;
        let round = std::mem::take(&mut self.round);
        let perceived: Vec<_> = round.into_values().flatten().collect();
        let captured = perceived.iter().map(|one| one.tracks.frame.captured_at);
        let round = Round {
            seq: self.seq,
            stamp: captured.max()?,
            perceived,
        };
        self.seq += 1;
        Some(round)
    }

    fn left(&self, since: Option<Instant>, now: Instant) -> Option<Duration> {
        Some((since? + self.timeout?).saturating_duration_since(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_core::{Ego, Frame, Image, ImageSize, PerFrame, Pixels, Timestamp};

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
            ego: Ego::default(),
        }))
    }

    fn stamps(scenes: impl IntoIterator<Item = Round>) -> Vec<i64> {
        scenes
            .into_iter()
            .map(|scene| scene.stamp.as_nanos())
            .collect()
    }

    #[test]
    fn slow_rounds_stay_whole() {
        let live: CameraSet = [CameraId(0), CameraId(1)].into_iter().collect();
        let mut scenes = RoundAssembler::new(Some(TIMEOUT));
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
        let mut scenes = RoundAssembler::new(Some(TIMEOUT));
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
    fn a_round_of_dropped_frames_gives_nothing() {
        let live: CameraSet = [CameraId(0)].into_iter().collect();
        let mut scenes = RoundAssembler::new(None);
        assert!(
            scenes
                .offer(CameraId(0), None, &live, Instant::now())
                .is_empty()
        );
    }
}
