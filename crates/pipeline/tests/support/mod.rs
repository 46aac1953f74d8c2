//! Sources, a detector and sinks that a test drives step by step, by channels.

#![expect(dead_code, reason = "each test file uses its part")]

use roadwatch_core::{
    BoxPx, CameraId, Clock, DecodeError, DecodeImage, DetectError, Detection, Detector, Ego, Frame,
    FrameSource, Image, ImageSize, Known, Location, Locator, ObjectClass, Oriented, Output,
    PerFrame, Pixels, Reidentifier, Score, Sink, SinkError, SourceError, Timestamp, Track, TrackId,
};
use roadwatch_pipeline::{
    NamedSink, Outcome, Overload, PipelineOptions, Running, Stages, perceive::Perceiver, start,
};
use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    time::{Duration, Instant},
};

/// Long enough for any machine; only a bug waits this long.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

pub(crate) struct RealClock;

impl Clock for RealClock {
    fn now(&self) -> Instant {
        Instant::now()
    }
}

struct CountedImage(Arc<AtomicU64>);

impl DecodeImage for CountedImage {
    fn decode(&self) -> Result<Pixels, DecodeError> {
        self.0.fetch_add(1, Ordering::SeqCst);
        let size = ImageSize {
            width_px: 1,
            height_px: 1,
        };
        Pixels::new(size, vec![0; 3])
    }
}

/// Frames with the stamps that the test sends; ends when the test drops its end.
pub(crate) struct ChannelSource {
    camera: CameraId,
    stamps: Receiver<i64>,
    decodes: Arc<AtomicU64>,
    seq: u64,
}

impl ChannelSource {
    pub(crate) fn new(camera: CameraId, stamps: Receiver<i64>) -> Self {
        Self {
            camera,
            stamps,
            decodes: Arc::default(),
            seq: 0,
        }
    }
}

impl FrameSource for ChannelSource {
    fn next_frame(&mut self, deadline: Instant) -> Result<Frame, SourceError> {
        let left = deadline.saturating_duration_since(Instant::now());
        match self.stamps.recv_timeout(left) {
            Ok(stamp) => {
                self.seq += 1;
                Ok(Frame {
                    camera: self.camera,
                    seq: self.seq - 1,
                    captured_at: Timestamp::from_nanos(stamp),
                    received_at: Instant::now(),
                    image: Image::encoded(Box::new(CountedImage(Arc::clone(&self.decodes)))),
                })
            }
            Err(RecvTimeoutError::Timeout) => Err(SourceError::Timeout),
            Err(RecvTimeoutError::Disconnected) => Err(SourceError::EndOfStream),
        }
    }
}

/// Finds one object per image, of which it looks at every pixel; may wait at a gate.
pub(crate) struct OneBoxDetector {
    pub(crate) gate: Option<Gate>,
    pub(crate) max_batch: usize,
    /// Sizes of all batches, in order of arrival.
    pub(crate) batches: Arc<Mutex<Vec<usize>>>,
}

/// Tells that a call arrived, and waits to be let through.
pub(crate) struct Gate {
    pub(crate) arrived: SyncSender<()>,
    /// One for each camera, or one for all.
    pub(crate) open: Vec<Mutex<Receiver<()>>>,
}

impl Detector for OneBoxDetector {
    fn detect(&self, frames: Vec<Frame>) -> Vec<Result<PerFrame<Detection>, DetectError>> {
        self.batches.lock().expect("batches").push(frames.len());
        if let Some(gate) = &self.gate {
            gate.arrived.send(()).expect("the test listens");
            // A closed gate stands open.
            let own = frames[0].camera.index().min(gate.open.len() - 1);
            gate.open[own].lock().expect("gate").recv().ok();
        }
        let found = |frame: Frame| {
            let pixels = frame.image.pixels();
            pixels.map_err(|error| DetectError::Decode(error.clone()))?;
            let detection = Detection {
                class: ObjectClass::new("car"),
                score: Score::new(0.5).expect("a score"),
                input_pixel_px: 1.0,
                box_px: BoxPx::new(0.0, 0.0, 1.0, 1.0).expect("a box"),
            };
            Ok(PerFrame {
                frame,
                items: vec![detection],
            })
        };
        frames.into_iter().map(found).collect()
    }

    fn max_batch(&self) -> usize {
        self.max_batch
    }
}

/// Places nothing: what is not located is still handed on.
pub(crate) struct Nowhere;

impl Locator for Nowhere {
    fn locate(&self, _: &Detection, _: &Known) -> Option<Location> {
        None
    }
}

pub(crate) struct NoMemory;

impl Reidentifier for NoMemory {
    fn recall(&self, seen: &PerFrame<Detection>, _: &Ego) -> Vec<Known> {
        vec![Known::default(); seen.items.len()]
    }

    fn commit(&mut self, seen: PerFrame<Oriented>, _: &[Detection], _: &Ego) -> PerFrame<Track> {
        let tracks = seen.items.into_iter().zip(0..);
        PerFrame {
            items: tracks
                .map(|(observed, id)| Track {
                    id: TrackId(id),
                    observed,
                    motion: None,
                })
                .collect(),
            frame: seen.frame,
        }
    }
}

/// What a sink got: (camera or `None` for the scene, stamp).
pub(crate) type Got = (Option<u8>, i64);

/// Passes on what it gets; may be held up by a channel without room.
pub(crate) struct ChannelSink(pub(crate) SyncSender<Got>);

impl Sink for ChannelSink {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let got = (
            output.camera().map(|camera| camera.0),
            output.stamp().as_nanos(),
        );
        self.0
            .send(got)
            .map_err(|error| SinkError::new("nobody listens", error.to_string()))
    }
}

/// A pipeline with the ends that a test holds.
pub(crate) struct World {
    pub(crate) running: Running,
    /// Per camera; `None` once ended.
    pub(crate) cameras: Vec<Option<SyncSender<i64>>>,
    pub(crate) outputs: Receiver<Got>,
    pub(crate) decodes: Arc<AtomicU64>,
    pub(crate) batches: Arc<Mutex<Vec<usize>>>,
}

/// Room for everything a test sends.
const ROOM: usize = 1000;

pub(crate) fn world(cameras: u8, overload: Overload, gate: Option<Gate>) -> World {
    world_with(
        cameras,
        PipelineOptions::new(overload),
        gate,
        (1, Vec::new()),
    )
}

pub(crate) fn world_with(
    cameras: u8,
    options: PipelineOptions,
    gate: Option<Gate>,
    (max_batch, more_sinks): (usize, Vec<NamedSink>),
) -> World {
    let decodes = Arc::new(AtomicU64::new(0));
    let batches = Arc::new(Mutex::new(Vec::new()));
    let (ends, sources): (Vec<_>, Vec<_>) = (0..cameras)
        .map(|camera| {
            let (end, stamps) = sync_channel(ROOM);
            let source: Box<dyn FrameSource> = Box::new(ChannelSource {
                camera: CameraId(camera),
                stamps,
                decodes: Arc::clone(&decodes),
                seq: 0,
            });
            (Some(end), source)
        })
        .unzip();
    let (sender, outputs) = sync_channel(ROOM);
    let channel = NamedSink {
        name: "channel".to_owned(),
        sink: Box::new(ChannelSink(sender)),
    };
    let stages = Stages {
        sources,
        detector: Arc::new(OneBoxDetector {
            gate,
            max_batch,
            batches: Arc::clone(&batches),
        }),
        perceiver: Perceiver {
            locators: (0..cameras)
                .map(|_| Box::new(Nowhere) as Box<dyn Locator>)
                .collect(),
            rotation: None,
            reidentifier: Box::new(NoMemory),
            ego: Arc::default(),
        },
        sinks: [channel].into_iter().chain(more_sinks).collect(),
    };
    let running = start(stages, options, Arc::new(RealClock)).expect("starts");
    World {
        running,
        cameras: ends,
        outputs,
        decodes,
        batches,
    }
}

impl World {
    pub(crate) fn send(&self, camera: usize, stamp: i64) {
        let end = self.cameras[camera].as_ref().expect("not ended");
        end.send(stamp).expect("the source lives");
    }

    /// Waits until a camera's thread has taken so many frames from its source.
    pub(crate) fn wait_captured(&self, camera: u8, count: u64) {
        self.wait_until(|running| running.metrics().camera(CameraId(camera)).captured >= count);
    }

    pub(crate) fn wait_until(&self, condition: impl Fn(&Running) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !condition(&self.running) {
            assert!(Instant::now() < deadline, "nothing happens");
            // Returns early only when a thread ends; a bounded wait, as events of counters do not exist.
            self.running
                .wait(Duration::from_millis(1))
                .expect("no panic");
        }
    }

    /// Ends all cameras and waits for the pipeline to drain; what was published, in order.
    pub(crate) fn finish(mut self) -> (Vec<Got>, Running) {
        self.cameras.iter_mut().for_each(|end| *end = None);
        let outcome = self.running.wait(PATIENCE).expect("no panic");
        assert_eq!(
            outcome,
            Outcome::Finished,
            "still alive: {:?}",
            self.running.alive()
        );
        (self.outputs.try_iter().collect(), self.running)
    }
}

/// One gate for all cameras.
pub(crate) fn gate() -> (Gate, Receiver<()>, SyncSender<()>) {
    let (gate, arrivals, mut openers) = gates(1);
    (gate, arrivals, openers.remove(0))
}

/// A gate for each camera.
pub(crate) fn gates(count: usize) -> (Gate, Receiver<()>, Vec<SyncSender<()>>) {
    let (arrived, arrivals) = sync_channel(ROOM);
    let (openers, open) = (0..count).map(|_| sync_channel(ROOM)).unzip();
    let open: Vec<Receiver<()>> = open;
    let open = open.into_iter().map(Mutex::new).collect();
    (Gate { arrived, open }, arrivals, openers)
}
