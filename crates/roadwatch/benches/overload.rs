//! Latency under overload: realtime at 1.2, 2 and 10 times the frame rate that this machine can do, while a
//! bag is recorded.
//!
//! The target: 99 of 100 frames are published within one frame interval (the wait in the slot, where a newer
//! frame would replace it) and two inferences (the one that runs, and its own). Inference is timed right
//! before and after each run, for a shared machine is not equally fast all the time.

mod drive;

use roadwatch::{config::Changes, session::Session};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat, Speed};
use roadwatch_pipeline::{Edge, NamedSink, Outcome, Overload, PipelineOptions};
use roadwatch_ros::{BagOptions, BagSink, LogTime};
use std::{
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

/// The drive's frame rate per camera, Hz.
const RECORDED_HZ: f64 = 10.0;
const CAMERAS: f64 = 6.0;
/// Long enough for hundreds of frames, so that a percentile means something.
const MEASURED: Duration = Duration::from_secs(30);
/// Rounds of all cameras that tell the machine's rate.
const CALIBRATION_FRAMES: u64 = 20;
/// Runs of the bare network before and after each measurement.
const INFERENCES: usize = 50;

fn main() {
    let Some(drive) = drive::Drive::open() else {
        return;
    };
    for overload in [1.2, 2.0, 10.0] {
        let machine_fps = machine_fps(&drive.config);
        let interval_ms = 1e3 * CAMERAS / (overload * machine_fps);
        let Some(speed) = Speed::new(overload * machine_fps / (CAMERAS * RECORDED_HZ)) else {
            return;
        };
        let mut inferences = drive.time_inferences(INFERENCES);
        let measured = measure(&drive.config, speed);
        inferences.extend(drive.time_inferences(INFERENCES));
        inferences.sort();
        println!("{overload} x the {machine_fps:.1} frames per second of this machine:");
        println!("  {}", measured.text);
        for (name, share) in [("median", 0.5), ("p99", 0.99)] {
            let at = (share * (inferences.len() - 1) as f64) as usize;
            let inference_ms = milliseconds(inferences[at]);
            let target_ms = interval_ms + 2.0 * inference_ms;
            let holds = measured.p99_ms < target_ms;
            println!(
                "  target by the {name} of inference: {interval_ms:.1} + 2 x {inference_ms:.1} = {target_ms:.1} ms: {}",
                if holds { "holds" } else { "DOES NOT HOLD" }
            );
        }
    }
}

fn machine_fps(config: &Path) -> f64 {
    let playback = PlaybackOptions {
        pace: Pace::AsFastAsPossible,
        repeat: Repeat::Loop,
        frame_limit: Some(CALIBRATION_FRAMES),
    };
    let session = Session::open(config, &Changes::default(), playback).expect("opens");
    let began = Instant::now();
    let running = session
        .start(Vec::new(), PipelineOptions::new(Overload::Wait))
        .expect("starts");
    assert_eq!(
        running.wait(Duration::from_secs(600)).expect("no panic"),
        Outcome::Finished
    );
    CALIBRATION_FRAMES as f64 * CAMERAS / began.elapsed().as_secs_f64()
}

/// What one overload gave.
struct Measured {
    p99_ms: f64,
    text: String,
}

fn measure(config: &Path, speed: Speed) -> Measured {
    let playback = PlaybackOptions {
        pace: Pace::Recorded { speed },
        repeat: Repeat::Loop,
        frame_limit: None,
    };
    let session = Session::open(config, &Changes::default(), playback).expect("opens");
    let cameras = session.rig.ids();
    let folder = tempfile::tempdir().expect("a folder");
    let bag = BagSink::create(
        &folder.path().join("bag"),
        Arc::clone(&session.rig),
        &session.config.node.options.surface,
        BagOptions::new(LogTime::Stamp),
    );
    let sink = NamedSink {
        name: "bag".to_owned(),
        sink: Box::new(bag.expect("a bag")),
    };
    let running = session
        .start(vec![sink], PipelineOptions::new(Overload::NewestWins))
        .expect("starts");
    running.wait(MEASURED).expect("no panic");
    let metrics = running.metrics();
    let latency = metrics.received_to_published(0);
    let edges = Edge::ALL.map(|edge| {
        let p99_ms = milliseconds(metrics.edge(edge).p99);
        format!("{} {p99_ms:.1}", edge.as_str())
    });
    let counts: Vec<_> = cameras.map(|camera| metrics.camera(camera)).collect();
    running.stop();
    assert_eq!(
        running.wait(Duration::from_secs(60)).expect("no panic"),
        Outcome::Finished
    );
    let published: Vec<_> = counts.iter().map(|counts| counts.published).collect();
    let dropped: u64 = counts.iter().map(|counts| counts.dropped_total()).sum();
    let p99_ms = milliseconds(latency.p99);
    let text = format!(
        "published {published:?}, dropped {dropped}; received to published p50 {:.1} ms, p99 {p99_ms:.1} ms \
         (p99 by edge: {})",
        milliseconds(latency.p50),
        edges.join(", "),
    );
    Measured { p99_ms, text }
}

fn milliseconds(duration: Duration) -> f64 {
    1e3 * duration.as_secs_f64()
}
