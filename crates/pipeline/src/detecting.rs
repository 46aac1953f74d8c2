//! Detection in lanes: while one lane runs the network, the next decodes and prepares its images.

use crate::{
    camera_set::CameraSet,
    inbox::{Receiver, Taken},
    metrics::{DropReason, Edge, Metrics},
    warn_limit::WarnLimit,
};
use roadwatch_core::{
    CameraId, Clock, DetectError, Detection, Detector, Frame, PerFrame, error_chain,
};
use std::{
    sync::{Arc, Condvar, Mutex, PoisonError, mpsc::SyncSender},
    time::Instant,
};

/// One lane in the network and one that prepares; a third would only hold frames that grow old.
pub const LANES: usize = 2;

/// What became of one taken frame.
pub(crate) struct Seen {
    pub(crate) camera: CameraId,
    /// `None` when the frame was dropped on the way.
    pub(crate) detections: Option<PerFrame<Detection>>,
    pub(crate) live: CameraSet,
    pub(crate) detected_at: Instant,
}

/// Lets lanes pass in the order of their tickets.
#[derive(Default)]
pub(crate) struct Turnstile {
    state: Mutex<Passed>,
    moved: Condvar,
}

#[derive(Default)]
struct Passed {
    next: u64,
    broken: bool,
}

impl Turnstile {
    /// Runs `pass` when every earlier ticket has passed; `None` when another lane died.
    fn pass<R>(&self, ticket: u64, pass: impl FnOnce() -> R) -> Option<R> {
        let waiting = |passed: &mut Passed| passed.next != ticket && !passed.broken;
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let state = self
            .moved
            .wait_while(state, waiting)
            .unwrap_or_else(PoisonError::into_inner);
        if state.broken {
            return None;
        }
        drop(state);
        let result = pass();
        self.state
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .next += 1;
        self.moved.notify_all();
        Some(result)
    }

    fn break_down(&self) {
        self.state
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .broken = true;
        self.moved.notify_all();
    }
}

pub(crate) struct Lane {
    pub(crate) inbox: Arc<Receiver>,
    pub(crate) detector: Arc<dyn Detector>,
    pub(crate) turnstile: Arc<Turnstile>,
    pub(crate) out: SyncSender<Seen>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) clock: Arc<dyn Clock>,
}

impl Drop for Lane {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // The ticket this lane held will never pass.
            self.turnstile.break_down();
        }
    }
}

impl Lane {
    /// Runs until the inbox is closed and empty.
    pub(crate) fn run(self) {
        let mut warnings = WarnLimit::default();
        let max_batch = self.detector.max_batch();
        let hold_off = || self.detector.hold_off();
        while let Some(batch) = self.inbox.take(max_batch, hold_off) {
            let taken_at = self.clock.now();
            let (frames, takes) = self.split(batch.taken, taken_at);
            let results = self.detector.detect(frames);
            let detected_at = self.clock.now();
            let sent = self.turnstile.pass(batch.ticket, || {
                takes
                    .into_iter()
                    .zip(results)
                    .all(|((camera, live), result)| {
                        self.metrics.time(Edge::Detect, detected_at - taken_at);
                        let detections = self.count_failure(camera, result, &mut warnings);
                        let seen = Seen {
                            camera,
                            detections,
                            live,
                            detected_at,
                        };
                        let sent = self.out.send(seen).is_ok();
                        self.inbox.done();
                        sent
                    })
            });
            if sent != Some(true) {
                return;
            }
        }
    }

    fn split(&self, taken: Vec<Taken>, now: Instant) -> (Vec<Frame>, Vec<(CameraId, CameraSet)>) {
        let split = |Taken { frame, live }: Taken| {
            let waited = now.saturating_duration_since(frame.received_at);
            self.metrics.time(Edge::Waiting, waited);
            let camera = frame.camera;
            (frame, (camera, live))
        };
        taken.into_iter().map(split).unzip()
    }

    fn count_failure(
        &self,
        camera: CameraId,
        result: Result<PerFrame<Detection>, DetectError>,
        warnings: &mut WarnLimit,
    ) -> Option<PerFrame<Detection>> {
        let error = match result {
            Ok(detections) => return Some(detections),
            Err(error) => error,
        };
        let reason = match &error {
            DetectError::Decode(_) => DropReason::Undecodable,
            DetectError::Inference(_) => DropReason::DetectionFailed,
        };
        self.metrics.dropped(camera, reason);
        if let Some(suppressed) = warnings.allow(self.clock.now()) {
            tracing::warn!(camera = camera.0, %reason, error = error_chain(&error), suppressed, "frame dropped");
        }
        None
    }
}
