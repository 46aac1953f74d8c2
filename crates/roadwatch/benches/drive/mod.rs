//! The shared drive and model, as benchmarks use them.

#![expect(dead_code, reason = "each benchmark uses its part")]

use roadwatch::config::{Changes, Config, Environment};
use roadwatch_camera::StillImage;
use roadwatch_core::{CameraId, Frame, Image, ImageSize, Timestamp};
use roadwatch_detect::{
    DetectorOptions, Network, Runtime,
    letterbox::{Letterbox, Placement, Scratch, Values},
};
use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

const SIZE: ImageSize = ImageSize {
    width_px: 960,
    height_px: 540,
};

/// The shipped configuration with its parts at hand.
pub(crate) struct Drive {
    /// The configuration's file, without ROS.
    pub(crate) config: PathBuf,
    /// Keeps the file.
    folder: tempfile::TempDir,
    images: PathBuf,
    runtime: Runtime,
    pub(crate) options: DetectorOptions,
}

impl Drive {
    /// `None`, said loudly, when the shared files are absent.
    pub(crate) fn open() -> Option<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let folder = tempfile::tempdir().expect("a folder");
        let config = folder.path().join("bench.toml");
        let shipped = fs::read_to_string(root.join("config/pandaset.toml")).expect("shipped");
        let shipped = shipped.replace(
            "../../shared",
            &root.join("../shared").display().to_string(),
        );
        // What is compared with one network must not run two: headings have a benchmark of their own.
        let (before, rotation) = shipped.split_once("[rotation]").expect("headings");
        let (_, after) = rotation.split_once("\n\n").expect("more tables");
        fs::write(&config, [before, after].concat()).expect("written");
        let read = Config::load(&config, &Changes::default(), &Environment::of_process())
            .expect("a configuration");
        let parts = read.detector.zip(read.rig.and_then(|rig| rig.dataset));
        let Some((detector, dataset)) =
            parts.filter(|(detector, _)| detector.options.model.is_file())
        else {
            println!("SKIPPED: the shared model and drive are not there; set ROADWATCH_SHARED");
            return None;
        };
        Some(Self {
            config,
            folder,
            images: dataset.folder().to_owned(),
            runtime: Runtime::load(&detector.runtime_candidates).expect("ONNX Runtime"),
            options: detector.options,
        })
    }

    /// The network alone.
    pub(crate) fn network(&self) -> Network {
        Network::open(&self.runtime, &self.options.model, &self.options.network).expect("the model")
    }

    /// Every fifth image of every camera, not decoded yet.
    pub(crate) fn frames(&self) -> Vec<Frame> {
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
        names.map(|name| frame(&self.images.join(name))).collect()
    }

    /// Times of single runs of the network on one real image.
    pub(crate) fn time_inferences(&self, runs: usize) -> Vec<Duration> {
        let mut network = self.network();
        let tensor = tensor(&self.frames()[0], &network);
        let mut time = || {
            let began = Instant::now();
            network.run(&tensor, 1, |_, _, _| ()).expect("runs");
            began.elapsed()
        };
        (0..runs).map(|_| time()).collect()
    }
}

pub(crate) fn letterbox(frame: &Frame, network: &Network) -> Letterbox {
    let size = frame.image.pixels().expect("decodes").size();
    Letterbox::new(
        size,
        network.input_size(),
        Placement::Centred,
        Values::RgbUnit,
    )
}

/// A frame as the network takes it.
pub(crate) fn tensor(frame: &Frame, network: &Network) -> Vec<f32> {
    let mut input = vec![0.0; Letterbox::input_len(network.input_size())];
    let pixels = frame.image.pixels().expect("decodes");
    letterbox(frame, network).fill(pixels, &mut input, &mut Scratch::default());
    input
}

fn frame(path: &Path) -> Frame {
    let bytes = fs::read(path).expect("an image");
    Frame {
        camera: CameraId(0),
        seq: 0,
        captured_at: Timestamp::from_nanos(0),
        received_at: Instant::now(),
        image: Image::encoded(Box::new(StillImage::new(
            bytes,
            SIZE,
            path.display().to_string(),
        ))),
    }
}
