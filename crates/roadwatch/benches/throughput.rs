//! The whole lossless pipeline (JPEG decode included) against bare ONNX Runtime on ready-made tensors.
//!
//! Interleaved pairs in one run, medians and ratios: on a shared machine only those mean anything.

mod drive;

use roadwatch::{config::Changes, session::Session};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat};
use roadwatch_core::Frame;
use roadwatch_detect::{
    Network,
    letterbox::{Letterbox, Scratch},
};
use roadwatch_pipeline::{Outcome, Overload, PipelineOptions};
use rustix::time::{ClockId, clock_gettime};
use std::{
    path::Path,
    time::{Duration, Instant},
};

const PAIRS: usize = 5;
/// Frames per camera and pair: about five seconds a side on two cores.
const FRAMES: u64 = 40;
const CAMERAS: u32 = 6;
/// Images whose tensors the bare network runs on in turn.
const TENSORS: usize = 12;
const PLAYBACK: PlaybackOptions = PlaybackOptions {
    pace: Pace::AsFastAsPossible,
    repeat: Repeat::Once,
    frame_limit: Some(FRAMES),
};

fn main() {
    let Some(drive) = drive::Drive::open() else {
        return;
    };
    let mut bare = drive.network();
    let parts = Parts::measure(&drive.frames(), &bare);
    let frames = drive.frames();
    let tensors: Vec<_> = frames[..TENSORS]
        .iter()
        .map(|frame| drive::tensor(frame, &bare))
        .collect();

    let mut pairs = Vec::new();
    for pair in 0..=PAIRS {
        let bare = run_bare(&mut bare, &tensors);
        let whole = run_pipeline(&drive.config);
        // The first pair warms caches up.
        if pair > 0 {
            println!(
                "pair {pair}: bare {bare}, pipeline {whole}, ratio {:.3}",
                whole.fps() / bare.fps()
            );
            pairs.push((bare, whole));
        }
    }
    let ratio = median(pairs.iter().map(|(bare, whole)| whole.fps() / bare.fps()));
    let beside =
        median(pairs.iter().map(|(bare, whole)| {
            whole.cpu_ms_per_frame() - bare.cpu_ms_per_frame() - parts.decode_ms
        }));
    println!(
        "threads inside the network: {} on both sides",
        drive.options.network.threads
    );
    println!(
        "alone, CPU per frame: decode {:.2} ms, letterbox {:.2} ms",
        parts.decode_ms, parts.letterbox_ms
    );
    println!("CPU per frame beside decode and network: {beside:.2} ms (median)");
    println!(
        "throughput ratio, pipeline to bare network: {ratio:.3} (median of {PAIRS} interleaved pairs)"
    );
}

/// One side of a pair.
struct Side {
    frames: u32,
    wall: Duration,
    cpu: Duration,
}

impl Side {
    fn time(frames: u32, work: impl FnOnce()) -> Self {
        let (began, cpu) = (Instant::now(), cpu_time());
        work();
        Self {
            frames,
            wall: began.elapsed(),
            cpu: cpu_time() - cpu,
        }
    }

    fn fps(&self) -> f64 {
        f64::from(self.frames) / self.wall.as_secs_f64()
    }

    fn cpu_ms_per_frame(&self) -> f64 {
        self.cpu.as_secs_f64() * 1e3 / f64::from(self.frames)
    }
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.2} fps at {:.1} CPU-ms per frame",
            self.fps(),
            self.cpu_ms_per_frame()
        )
    }
}

fn run_bare(network: &mut Network, tensors: &[Vec<f32>]) -> Side {
    let frames = FRAMES as u32 * CAMERAS;
    Side::time(frames, || {
        for frame in 0..frames as usize {
            network
                .run(&tensors[frame % tensors.len()], 1, |_, _, _| ())
                .expect("runs");
        }
    })
}

fn run_pipeline(config: &Path) -> Side {
    let session = Session::open(config, &Changes::default(), PLAYBACK).expect("opens");
    Side::time(FRAMES as u32 * CAMERAS, || {
        let running = session
            .start(Vec::new(), PipelineOptions::new(Overload::Wait))
            .expect("starts");
        let outcome = running.wait(Duration::from_secs(600)).expect("no panic");
        assert_eq!(outcome, Outcome::Finished);
    })
}

/// Single-threaded CPU time of what goes before the network.
struct Parts {
    decode_ms: f64,
    letterbox_ms: f64,
}

impl Parts {
    /// `frames` must not be decoded yet.
    fn measure(frames: &[Frame], network: &Network) -> Self {
        let decode = Side::time(frames.len() as u32, || {
            for frame in frames {
                frame.image.pixels().expect("decodes");
            }
        });
        let mut scratch = Scratch::default();
        let mut input = vec![0.0; Letterbox::input_len(network.input_size())];
        let letterbox = drive::letterbox(&frames[0], network);
        let fill = Side::time(frames.len() as u32, || {
            for frame in frames {
                letterbox.fill(
                    frame.image.pixels().expect("decoded"),
                    &mut input,
                    &mut scratch,
                );
            }
        });
        Self {
            decode_ms: decode.cpu_ms_per_frame(),
            letterbox_ms: fill.cpu_ms_per_frame(),
        }
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(
        time.tv_sec.unsigned_abs(),
        time.tv_nsec.unsigned_abs() as u32,
    )
}
