//! How frames flow: a mailbox with one slot per camera, detection in lanes, one perceiving step for the
//! whole rig, and sinks that never slow it.
//!
//! ```text
//! camera thread x N -> [inbox: one slot per camera] -> detect lanes -> [FIFO] -> perceive -> [FIFO per sink] -> sinks
//! ```
//!
//! Every stage blocks, so every stage is a named thread; nothing here is async. What a stage computes is
//! behind the seams of `roadwatch-core`. Stop travels through the channels: sources stop, the inbox closes,
//! each stage drains and ends in turn.

mod camera_set;
mod capture;
mod detecting;
pub mod inbox;
mod latency;
pub mod metrics;
mod options;
pub mod perceive;
mod perceiving;
pub mod round;
mod running;
mod sinking;
mod start;
mod stop;
mod warn_limit;

pub use camera_set::CameraSet;
pub use detecting::LANES;
pub use latency::Percentiles;
pub use metrics::{CameraCounts, DropReason, Edge, Metrics, SinkCounts};
pub use options::{Overload, PipelineOptions};
pub use running::{Outcome, Running};
pub use start::{DETECTED_QUEUE_LEN, NamedSink, PipelineError, Stages, start};
