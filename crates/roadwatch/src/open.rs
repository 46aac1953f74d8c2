//! From configuration to the parts of a pipeline: everything that can fail at start fails here.

use crate::config::{
    CameraConfig, Config, DetectorConfig, Notes, RigConfig, RotationConfig, SourceConfig,
};
use roadwatch_camera::{
    AnyRecording, DecodeCount, ImageSequence, Playback, PlaybackOptions, Player, Recording,
    RigDataset, Span, VideoFile,
};
use roadwatch_core::{FrameSource, Locator, Rig, RigCamera, Timestamp, error_chain};
use roadwatch_detect::{DetectorError, NetworkError, Runtime, YoloDetector};
use roadwatch_onnx::SessionOptions;
use roadwatch_pipeline::perceive::Rotating;
use roadwatch_rotate::{
    Calibration, ComponentModelError, ComponentNetwork, EstimatorError, Forest,
    KeyComponentEstimator, PositionCurve,
};
use std::sync::{Arc, atomic::AtomicUsize};

const CURVE_KEY: &str = "rotation.position_curve";
/// Beginning of a rig without any stamp: one second, as tf takes zero for "latest".
const UNSTAMPED_START: Timestamp = Timestamp::from_nanos(1_000_000_000);

/// Opens the model, or notes why not.
pub fn detector(config: &Config, notes: &mut Notes) -> Option<YoloDetector> {
    let detector = config.detector.as_ref()?;
    let runtime = match Runtime::load(&detector.runtime_candidates) {
        Ok(runtime) => runtime,
        Err(error) => {
            notes.note("detector.runtime_library", error.to_string());
            // Without the library a model cannot be opened, but it can be missed.
            let model = &detector.options.model;
            if !model.is_file() {
                notes.note(
                    "detector.model",
                    NetworkError::Absent(model.clone()).to_string(),
                );
            }
            return None;
        }
    };
    match YoloDetector::open(&runtime, &detector.options) {
        Ok(opened) => Some(opened),
        Err(error) => {
            for key in detector_keys(&error) {
                notes.note(key, error_chain(&error));
            }
            None
        }
    }
}

/// The keys that are to blame.
fn detector_keys(error: &DetectorError) -> Vec<&'static str> {
    match error {
        DetectorError::Network(_) => vec!["detector.model"],
        DetectorError::WrongFamily { .. } => vec!["detector.family"],
        DetectorError::ClassNames { .. } => vec!["detector.class_names"],
        DetectorError::UnknownClasses {
            allowed,
            with_thresholds,
            exclusive,
            ..
        } => {
            let lists = [
                (allowed, "detector.classes"),
                (with_thresholds, "detector.class_thresholds"),
                (exclusive, "detector.exclusive_classes"),
            ];
            let to_blame = lists.into_iter().filter(|(unknown, _)| !unknown.is_empty());
            to_blame.map(|(_, key)| key).collect()
        }
    }
}

/// Builds every camera's locator by the method configured for it, or notes why not.
pub fn locators(config: &Config, notes: &mut Notes) -> Option<Vec<Box<dyn Locator>>> {
    let rig = config.rig.as_ref()?;
    let pairs = rig.rig.cameras().iter().zip(&rig.cameras);
    let built: Vec<Option<Box<dyn Locator>>> = pairs
        .map(|(camera, camera_config)| {
            let method = camera_config.method_or(config.locate.method);
            match config
                .locate
                .locator(&rig.rig, camera, camera_config, method)
            {
                Ok(locator) => Some(locator),
                Err((key, what)) => {
                    notes.note(&format!("{}.{key}", camera_config.key), what);
                    None
                }
            }
        })
        .collect();
    built.into_iter().collect()
}

/// Opens what headings need; `Ok(None)` where the configuration asks for none, an error where it cannot be opened,
/// which is noted.
pub fn rotation(config: &Config, notes: &mut Notes) -> Result<Option<Rotating>, Noted> {
    let (Some(rotation), Some(rig), Some(detector)) =
        (&config.rotation, &config.rig, &config.detector)
    else {
        // Mistakes in any of these are noted already.
        return Ok(None);
    };
    let opened = open_rotation(rotation, rig, detector);
    let estimator = opened.map_err(|(key, what)| {
        notes.note(key, what);
        Noted
    })?;
    Ok(Some(Rotating {
        estimator: Box::new(estimator),
        crops_per_frame: Arc::new(AtomicUsize::new(rotation.crops_per_frame)),
    }))
}

/// Something could not be opened, and a note says why.
pub struct Noted;

fn open_rotation(
    rotation: &RotationConfig,
    rig: &RigConfig,
    detector: &DetectorConfig,
) -> Result<KeyComponentEstimator, (&'static str, String)> {
    let runtime = Runtime::load(&detector.runtime_candidates);
    let runtime = runtime.map_err(|error| ("detector.runtime_library", error_chain(&error)))?;
    let features = rotation.features.as_ref();
    let features = features.unwrap_or(&detector.options.model);
    let options = SessionOptions {
        threads: rotation.threads,
        spinning: false,
    };
    let network = ComponentNetwork::open(&runtime, (&rotation.model, features), options);
    let network = network.map_err(|error| (model_key(&error), error_chain(&error)))?;
    let forest = Forest::read(&rotation.forest);
    let forest = forest.map_err(|error| ("rotation.forest", error_chain(&error)))?;
    let calibration = match &rotation.position_curve {
        None => Calibration::Ray,
        Some(file) => {
            let curve = PositionCurve::read(file);
            Calibration::Curve(curve.map_err(|error| (CURVE_KEY, error_chain(&error)))?)
        }
    };
    let options = rotation.options.clone();
    let parts = (network, forest);
    let estimator = KeyComponentEstimator::new(&rig.rig, parts, &calibration, options);
    estimator.map_err(|error| {
        let key = match error {
            EstimatorError::Pose { .. } => CURVE_KEY,
            EstimatorError::Components { .. } | EstimatorError::Facing { .. } => "rotation.forest",
        };
        (key, error_chain(&error))
    })
}

fn model_key(error: &ComponentModelError) -> &'static str {
    match error {
        ComponentModelError::OtherDetector { .. } | ComponentModelError::Features { .. } => {
            "rotation.features"
        }
        ComponentModelError::Unreadable { .. } | ComponentModelError::NotAHead { .. } => {
            "rotation.model"
        }
    }
}

/// Opens what feeds each camera, or notes why not. `decodes` counts the images that are decoded.
pub fn sources(
    config: &Config,
    playback: PlaybackOptions,
    decodes: &DecodeCount,
    notes: &mut Notes,
) -> Option<Vec<Box<dyn FrameSource>>> {
    let RigConfig {
        rig,
        cameras,
        dataset,
        ..
    } = config.rig.as_ref()?;
    let start = default_start(cameras, dataset.as_deref());
    let opened: Vec<Option<AnyRecording>> = rig
        .cameras()
        .iter()
        .zip(cameras)
        .map(|(camera, config)| {
            match open_source(camera, config, dataset.as_deref(), (start, decodes)) {
                Ok(opened) => Some(opened),
                Err((key, what)) => {
                    notes.note(&format!("{}.{key}", config.key), what);
                    None
                }
            }
        })
        .collect();
    let opened: Vec<AnyRecording> = opened.into_iter().collect::<Option<_>>()?;
    let spans: Vec<_> = opened.iter().map(Recording::span).collect();
    note_lonely(cameras, &spans, notes);
    let playback = Playback::new(playback, &spans);
    let players = rig.ids().zip(opened).map(|(camera, recording)| {
        Box::new(Player::new(camera, recording, Arc::clone(&playback))) as Box<dyn FrameSource>
    });
    Some(players.collect())
}

/// Where recordings without a start stamp begin: with the dataset, or with the earliest that has one.
fn default_start(cameras: &[CameraConfig], dataset: Option<&RigDataset>) -> Timestamp {
    let of_dataset = dataset
        .and_then(|dataset| dataset.frames().first())
        .into_iter();
    let of_dataset = of_dataset.flat_map(|frame| frame.stamps.iter().flatten().copied());
    let of_cameras = cameras.iter().filter_map(|camera| match camera.source {
        SourceConfig::Images { start, .. } | SourceConfig::Video { start, .. } => start,
        SourceConfig::Dataset(_) => None,
    });
    of_dataset
        .chain(of_cameras)
        .min()
        .unwrap_or(UNSTAMPED_START)
}

/// Notes recordings that share no moment with another: played together, one would wait for the other for
/// as long as lies between them.
fn note_lonely(cameras: &[CameraConfig], spans: &[Span], notes: &mut Notes) {
    let meets = |a: &Span, b: &Span| a.first <= b.last && b.first <= a.last;
    let first = spans.iter().min_by_key(|span| span.first);
    for (camera, span) in cameras.iter().zip(spans) {
        if first.is_some_and(|first| !meets(first, span)) {
            let what = "this recording begins after another of the rig has ended; give both matching start stamps";
            notes.note(&start_key(camera), what);
        }
    }
}

/// The key that says when a camera's recording begins.
fn start_key(camera: &CameraConfig) -> String {
    match camera.source {
        SourceConfig::Dataset(_) => camera.key.clone(),
        SourceConfig::Images { .. } | SourceConfig::Video { .. } => {
            format!("{}.start_stamp", camera.key)
        }
    }
}

fn open_source(
    camera: &RigCamera,
    config: &CameraConfig,
    dataset: Option<&RigDataset>,
    (default_start, decodes): (Timestamp, &DecodeCount),
) -> Result<AnyRecording, (&'static str, String)> {
    let size = camera.model.size;
    match &config.source {
        SourceConfig::Dataset(index) => dataset
            .and_then(|dataset| dataset.recording(*index))
            .ok_or_else(|| "the dataset has no images of this camera".to_owned())
            .and_then(|opened| opened.map_err(|error| error_chain(&error)))
            .map(|recording| recording.counting(decodes.clone()))
            .map_err(|what| ("dataset", what)),
        SourceConfig::Images {
            folder,
            rate,
            start,
        } => ImageSequence::open(folder, size, *rate, start.unwrap_or(default_start))
            .map(|images| AnyRecording::Images(images.counting(decodes.clone())))
            .map_err(|error| ("images", error_chain(&error))),
        SourceConfig::Video { file, start } => {
            VideoFile::open(file, size, start.unwrap_or(default_start))
                .map(AnyRecording::Video)
                .map_err(|error| ("video", error_chain(&error)))
        }
    }
}

/// The rig, shared; `None` when it could not be understood.
#[must_use]
pub fn shared_rig(config: &Config) -> Option<Arc<Rig>> {
    config.rig.as_ref().map(|rig| Arc::new(rig.rig.clone()))
}
