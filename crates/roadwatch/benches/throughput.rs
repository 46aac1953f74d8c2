//! The whole lossless pipeline (JPEG decode included) against bare ONNX Runtime on ready-made tensors.
//!
//! Interleaved pairs in one run, medians and ratios: on a shared machine only those mean anything.

use roadwatch::{
    config::{Config, Environment},
    session::Session,
};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat};
use roadwatch_core::Frame;
use roadwatch_detect::{
    Network, Runtime,
    letterbox::{Letterbox, Placement, Scratch, Values},
};
use roadwatch_pipeline::{Outcome, Overload, PipelineOptions};
use rustix::time::{ClockId, clock_gettime};
use std::{
    fs,
    path::{Path, PathBuf},
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("bench.toml");
    let shipped = fs::read_to_string(root.join("config/pandaset.toml")).expect("shipped");
    let shipped = shipped.replace(
        "../../shared",
        &root.join("../shared").display().to_string(),
    );
    fs::write(&config, shipped).expect("written");
    let environment = Environment::of_process();
    let read = Config::load(&config, None, &environment).expect("a configuration");
    let (Some(detector), Some(rig)) = (read.detector, read.rig) else {
        println!("SKIPPED: the shared model and drive are not there; set ROADWATCH_SHARED");
        return;
    };
    let runtime = Runtime::load(&detector.runtime_candidates).expect("ONNX Runtime");
    let network = &detector.options.network;
    let mut bare = Network::open(&runtime, &detector.options.model, network).expect("the model");
    let dataset = rig.dataset.expect("a dataset");
    let images = images(dataset.folder());
    let parts = Parts::measure(&images, &bare);
    let tensors = tensors(&images[..TENSORS], &bare);

    let mut pairs = Vec::new();
    for pair in 0..=PAIRS {
        let bare = run_bare(&mut bare, &tensors);
        let whole = run_pipeline(&config);
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
        network.threads
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
    let session = Session::open(config, None, PLAYBACK).expect("opens");
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
    fn measure(images: &[PathBuf], network: &Network) -> Self {
        let frames: Vec<Frame> = images.iter().map(|path| frame(path)).collect();
        let decode = Side::time(frames.len() as u32, || {
            for frame in &frames {
                frame.image.pixels().expect("decodes");
            }
        });
        let mut scratch = Scratch::default();
        let mut input = vec![0.0; Letterbox::input_len(network.input_size())];
        let letterbox = letterbox(&frames[0], network);
        let fill = Side::time(frames.len() as u32, || {
            for frame in &frames {
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

fn letterbox(frame: &Frame, network: &Network) -> Letterbox {
    let size = frame.image.pixels().expect("decodes").size();
    Letterbox::new(
        size,
        network.input_size(),
        Placement::Centred,
        Values::RgbUnit,
    )
}

fn tensors(images: &[PathBuf], network: &Network) -> Vec<Vec<f32>> {
    let tensor = |path: &PathBuf| {
        let frame = frame(path);
        let mut input = vec![0.0; Letterbox::input_len(network.input_size())];
        let pixels = frame.image.pixels().expect("decodes");
        letterbox(&frame, network).fill(pixels, &mut input, &mut Scratch::default());
        input
    };
    images.iter().map(tensor).collect()
}

fn frame(path: &Path) -> Frame {
    use roadwatch_camera::StillImage;
    use roadwatch_core::{CameraId, Image, ImageSize, Timestamp};
    let size = ImageSize {
        width_px: 960,
        height_px: 540,
    };
    let bytes = fs::read(path).expect("an image");
    Frame {
        camera: CameraId(0),
        seq: 0,
        captured_at: Timestamp::from_nanos(0),
        received_at: Instant::now(),
        image: Image::encoded(Box::new(StillImage::new(
            bytes,
            size,
            path.display().to_string(),
        ))),
    }
}

/// Every fifth image of every camera.
fn images(drive: &Path) -> Vec<PathBuf> {
    let cameras = [
        "front_left",
        "front",
        "front_right",
        "right",
        "back",
        "left",
    ];
    let names = cameras.iter().flat_map(|camera| {
        (0..40)
            .step_by(5)
            .map(move |at| format!("{camera}/{at:04}.jpg"))
    });
    names.map(|name| drive.join(name)).collect()
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
