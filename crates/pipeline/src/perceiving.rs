//! The perceiving thread: the perceiving step, scenes, and handing over to the sinks.

use crate::{
    detecting::Seen,
    inbox,
    metrics::{Edge, Metrics},
    perceive::Perceiver,
    round::RoundAssembler,
    sinking::Fanout,
    warn_limit::WarnLimit,
};
use roadwatch_core::{CameraId, Clock, Output, RotationError, Round};
use std::{
    sync::{
        Arc, Weak,
        mpsc::{Receiver, RecvTimeoutError},
    },
    time::Duration,
};

pub(crate) struct Perceiving {
    pub(crate) perceiver: Perceiver,
    pub(crate) rounds: RoundAssembler,
    /// Ends with the lanes, so that this thread does not keep it open.
    pub(crate) inbox: Weak<inbox::Receiver>,
    pub(crate) fanout: Fanout,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) clock: Arc<dyn Clock>,
    pub(crate) warnings: WarnLimit,
}

impl Perceiving {
    /// Runs until every lane has ended.
    pub(crate) fn run(mut self, detections: &Receiver<Seen>) {
        loop {
            let wait = self.rounds.due_in(self.clock.now());
            let rounds = match receive(detections, wait) {
                Ok(seen) => self.step(seen),
                Err(RecvTimeoutError::Timeout) => {
                    let now = self.clock.now();
                    if self.is_busy() {
                        self.rounds.wait_on(now);
                        Vec::new()
                    } else {
                        self.rounds.tick(now).into_iter().collect()
                    }
                }
                Err(RecvTimeoutError::Disconnected) => break,
            };
            self.publish_scenes(rounds);
        }
        let last = self.rounds.close();
        self.publish_scenes(last);
    }

    /// Whether a slow network, and not a silent camera, is what keeps this thread waiting.
    fn is_busy(&self) -> bool {
        self.inbox.upgrade().is_some_and(|inbox| inbox.is_busy())
    }

    fn step(&mut self, seen: Seen) -> Vec<Round> {
        let perceived = seen.detections.map(|detections| {
            let received_at = detections.frame.received_at;
            let (perceived, rotated) = self.perceiver.perceive(detections);
            let perceived = Arc::new(perceived);
            if let Err(error) = rotated {
                self.metrics.unrotated(seen.camera);
                self.warn(seen.camera, &error);
            }
            let now = self.clock.now();
            self.metrics.time(
                Edge::Perceive,
                now.saturating_duration_since(seen.detected_at),
            );
            self.metrics.time(
                Edge::ReceivedToPerceived,
                now.saturating_duration_since(received_at),
            );
            self.metrics
                .published(seen.camera, perceived.tracks.items.len());
            self.fanout
                .send(&Output::Camera(Arc::clone(&perceived)), Some(received_at));
            perceived
        });
        self.rounds
            .offer(seen.camera, perceived, &seen.live, self.clock.now())
    }

    fn warn(&mut self, camera: CameraId, error: &RotationError) {
        if let Some(suppressed) = self.warnings.allow(self.clock.now()) {
            tracing::warn!(camera = camera.0, %error, suppressed, "headings of a frame not estimated");
        }
    }

    fn publish_scenes(&mut self, rounds: impl IntoIterator<Item = Round>) {
        for round in rounds {
            let scene = self.perceiver.scene(&round);
            self.metrics.scene();
            self.fanout.send(&Output::Scene(Arc::new(scene)), None);
        }
    }
}

fn receive(detections: &Receiver<Seen>, wait: Option<Duration>) -> Result<Seen, RecvTimeoutError> {
    match wait {
        Some(wait) => detections.recv_timeout(wait),
        None => detections
            .recv()
            .map_err(|_| RecvTimeoutError::Disconnected),
    }
}
