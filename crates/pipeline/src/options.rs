//! The choices a pipeline is started with.

use std::time::Duration;

/// What happens when frames come faster than they are worked off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overload {
    /// *Realtime*: the newest frame of a camera replaces the one that waits; sinks that fall behind lose outputs.
    NewestWins,
    /// *Lossless*: sources and stages wait, nothing is dropped, and frames are taken in order of
    /// (capture time, camera), so the same input gives the same output.
    Wait,
}

/// The choices a pipeline is started with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PipelineOptions {
    /// What happens under overload.
    pub overload: Overload,
    /// How long a scene waits for a camera that says nothing, in [`Overload::NewestWins`].
    pub scene_timeout: Duration,
    /// Outputs a sink may be behind before it loses some, or before the pipeline waits for it.
    pub sink_queue_len: usize,
}

impl PipelineOptions {
    /// Two frame intervals of a 10 Hz rig.
    pub const DEFAULT_SCENE_TIMEOUT: Duration = Duration::from_millis(200);
    /// About one second of six cameras at 10 Hz: enough for a disk's hiccup, little memory.
    pub const DEFAULT_SINK_QUEUE_LEN: usize = 64;

    /// The defaults for a pace.
    #[must_use]
    pub fn new(overload: Overload) -> Self {
        Self {
            overload,
            scene_timeout: Self::DEFAULT_SCENE_TIMEOUT,
            sink_queue_len: Self::DEFAULT_SINK_QUEUE_LEN,
        }
    }
}
