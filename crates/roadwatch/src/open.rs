//! From configuration to the parts of a pipeline: everything that can fail at start fails here.

mod ego;
mod ros_images;
mod sources;

use crate::config::{Config, DetectorConfig, Notes, RigConfig, RotationConfig};
use roadwatch_core::{Locator, Rig, error_chain};
use roadwatch_detect::{DetectorError, NetworkError, Runtime, YoloDetector};
use roadwatch_onnx::SessionOptions;
use roadwatch_pipeline::perceive::Rotating;
use roadwatch_rotate::{
    Calibration, ComponentModelError, ComponentNetwork, EstimatorError, Forest,
    KeyComponentEstimator, PositionCurve,
};
use std::sync::{Arc, atomic::AtomicUsize};

const CURVE_KEY: &str = "rotation.position_curve";

pub use ego::{ego, ego_source};
pub use ros_images::encoded;
pub use sources::{Feed, sources};

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

/// The rig, shared; `None` when it could not be understood.
#[must_use]
pub fn shared_rig(config: &Config) -> Option<Arc<Rig>> {
    config.rig.as_ref().map(|rig| Arc::new(rig.rig.clone()))
}
