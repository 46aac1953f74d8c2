//! What the pipeline counts and measures: every drop with its reason, every edge with its latency.

use crate::latency::{Latency, Percentiles};
use roadwatch_core::CameraId;
use std::{
    fmt,
    sync::atomic::{AtomicU64, Ordering},
    time::Duration,
};

/// Why a captured frame was not published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DropReason {
    /// A newer frame of the same camera came first.
    Replaced,
    /// Its image could not be decoded.
    Undecodable,
    /// The detector failed on it.
    DetectionFailed,
    /// The pipeline was already closed.
    Closed,
}

impl DropReason {
    /// Every reason, in the order of [`CameraCounts::dropped`].
    pub const ALL: [Self; 4] = [
        Self::Replaced,
        Self::Undecodable,
        Self::DetectionFailed,
        Self::Closed,
    ];

    /// The reason's name in metrics.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Replaced => "replaced",
            Self::Undecodable => "undecodable",
            Self::DetectionFailed => "detection_failed",
            Self::Closed => "closed",
        }
    }
}

impl fmt::Display for DropReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A stretch of a frame's way that is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// From received to taken by the detector.
    Waiting,
    /// Decoding, letterbox, network, suppression, and waiting for the lane before.
    Detect,
    /// Locating and identifying, and waiting in the FIFO before it.
    Perceive,
    /// From received to handed over to the sinks.
    ReceivedToPerceived,
}

impl Edge {
    /// Every edge, in order of the flow.
    pub const ALL: [Self; 4] = [
        Self::Waiting,
        Self::Detect,
        Self::Perceive,
        Self::ReceivedToPerceived,
    ];

    /// The edge's name in metrics.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Detect => "detect",
            Self::Perceive => "perceive",
            Self::ReceivedToPerceived => "received_to_perceived",
        }
    }
}

/// One camera's counts since the start. `captured = published + sum(dropped) + still inside`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CameraCounts {
    /// Frames the source delivered.
    pub captured: u64,
    /// Frames handed over to the sinks.
    pub published: u64,
    /// Frames dropped, by [`DropReason::ALL`].
    pub dropped: [u64; DropReason::ALL.len()],
    /// Frames that the source itself lost; not in `captured`.
    pub lost: u64,
    /// Times the source reported itself disconnected.
    pub disconnected: u64,
    /// Objects in published frames.
    pub objects: u64,
    /// Published frames whose headings could not be estimated.
    pub unrotated: u64,
}

impl CameraCounts {
    /// Frames dropped for any reason.
    #[must_use]
    pub fn dropped_total(&self) -> u64 {
        self.dropped.iter().sum()
    }
}

/// One sink's counts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SinkCounts {
    /// Outputs delivered.
    pub delivered: u64,
    /// Outputs it had no room for.
    pub dropped: u64,
    /// Outputs it reported as lost.
    pub failed: u64,
}

#[derive(Default)]
struct CameraMetrics {
    captured: AtomicU64,
    published: AtomicU64,
    dropped: [AtomicU64; DropReason::ALL.len()],
    lost: AtomicU64,
    disconnected: AtomicU64,
    objects: AtomicU64,
    unrotated: AtomicU64,
}

struct SinkMetrics {
    name: String,
    delivered: AtomicU64,
    dropped: AtomicU64,
    failed: AtomicU64,
    received_to_published: Latency,
}

/// Counts and latencies of a running pipeline; shared by its threads, read by whoever reports.
pub struct Metrics {
    cameras: Vec<CameraMetrics>,
    edges: Vec<Latency>,
    sinks: Vec<SinkMetrics>,
    scenes: AtomicU64,
}

impl Metrics {
    /// Metrics for a number of cameras and sinks; `None` only if the histograms' fixed bounds were invalid.
    pub(crate) fn new(cameras: usize, sinks: &[String]) -> Option<Self> {
        let sink = |name: &String| {
            Some(SinkMetrics {
                name: name.clone(),
                delivered: AtomicU64::default(),
                dropped: AtomicU64::default(),
                failed: AtomicU64::default(),
                received_to_published: Latency::new()?,
            })
        };
        Some(Self {
            cameras: (0..cameras).map(|_| CameraMetrics::default()).collect(),
            edges: Edge::ALL
                .iter()
                .map(|_| Latency::new())
                .collect::<Option<_>>()?,
            sinks: sinks.iter().map(sink).collect::<Option<_>>()?,
            scenes: AtomicU64::default(),
        })
    }

    /// Number of cameras.
    #[must_use]
    pub fn cameras(&self) -> usize {
        self.cameras.len()
    }

    /// One camera's counts.
    #[must_use]
    pub fn camera(&self, camera: CameraId) -> CameraCounts {
        let metrics = &self.cameras[camera.index()];
        CameraCounts {
            captured: load(&metrics.captured),
            published: load(&metrics.published),
            dropped: std::array::from_fn(|at| load(&metrics.dropped[at])),
            lost: load(&metrics.lost),
            disconnected: load(&metrics.disconnected),
            objects: load(&metrics.objects),
            unrotated: load(&metrics.unrotated),
        }
    }

    /// Latencies of one edge.
    #[must_use]
    pub fn edge(&self, edge: Edge) -> Percentiles {
        self.edges[edge as usize].percentiles()
    }

    /// Names of the sinks, in order.
    pub fn sink_names(&self) -> impl Iterator<Item = &str> {
        self.sinks.iter().map(|sink| sink.name.as_str())
    }

    /// Counts of the `at`-th sink.
    #[must_use]
    pub fn sink(&self, at: usize) -> SinkCounts {
        let sink = &self.sinks[at];
        SinkCounts {
            delivered: load(&sink.delivered),
            dropped: load(&sink.dropped),
            failed: load(&sink.failed),
        }
    }

    /// Latencies from received to published by the `at`-th sink.
    #[must_use]
    pub fn received_to_published(&self, at: usize) -> Percentiles {
        self.sinks[at].received_to_published.percentiles()
    }

    /// Number of completed scenes.
    #[must_use]
    pub fn scenes(&self) -> u64 {
        load(&self.scenes)
    }

    pub(crate) fn captured(&self, camera: CameraId) {
        add(&self.cameras[camera.index()].captured, 1);
    }

    pub(crate) fn lost(&self, camera: CameraId) {
        add(&self.cameras[camera.index()].lost, 1);
    }

    pub(crate) fn disconnected(&self, camera: CameraId) {
        add(&self.cameras[camera.index()].disconnected, 1);
    }

    pub(crate) fn dropped(&self, camera: CameraId, reason: DropReason) {
        add(&self.cameras[camera.index()].dropped[reason as usize], 1);
    }

    pub(crate) fn published(&self, camera: CameraId, objects: usize) {
        add(&self.cameras[camera.index()].published, 1);
        add(&self.cameras[camera.index()].objects, objects as u64);
    }

    pub(crate) fn unrotated(&self, camera: CameraId) {
        add(&self.cameras[camera.index()].unrotated, 1);
    }

    pub(crate) fn scene(&self) {
        add(&self.scenes, 1);
    }

    pub(crate) fn time(&self, edge: Edge, latency: Duration) {
        self.edges[edge as usize].record(latency);
    }

    pub(crate) fn delivered(&self, sink: usize, since_received: Option<Duration>) {
        add(&self.sinks[sink].delivered, 1);
        if let Some(latency) = since_received {
            self.sinks[sink].received_to_published.record(latency);
        }
    }

    pub(crate) fn sink_dropped(&self, sink: usize) {
        add(&self.sinks[sink].dropped, 1);
    }

    pub(crate) fn sink_failed(&self, sink: usize) {
        add(&self.sinks[sink].failed, 1);
    }
}

fn load(counter: &AtomicU64) -> u64 {
    counter.load(Ordering::Relaxed)
}

fn add(counter: &AtomicU64, by: u64) {
    counter.fetch_add(by, Ordering::Relaxed);
}
