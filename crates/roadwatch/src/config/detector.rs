//! `[detector]`: the network and what is kept of its answers.

use super::reader::Reader;
use roadwatch_core::ImageSize;
use roadwatch_detect::{ClassFilter, DetectorOptions, Family, NetworkOptions};
use std::{num::NonZero, path::PathBuf, thread::available_parallelism};

/// YOLO's customary least score for showing a box.
const DEFAULT_SCORE_THRESHOLD: f64 = 0.25;
/// YOLO's customary overlap for suppression.
const DEFAULT_IOU_THRESHOLD: f64 = 0.45;
/// More objects than any street scene shows in one image.
const DEFAULT_MAX_DETECTIONS: u32 = 300;
/// A larger side does not fit any network worth running in real time.
const LARGEST_SIDE_PX: u32 = 8192;
/// Where `./dev` puts ONNX Runtime's library, in the checkout.
const DEV_LIBRARY: &str = ".cache/onnxruntime/libonnxruntime.so";
/// Where systems keep it.
const SYSTEM_LIBRARIES: [&str; 3] = [
    "/usr/local/lib/libonnxruntime.so",
    "/usr/lib/libonnxruntime.so",
    "/usr/lib/x86_64-linux-gnu/libonnxruntime.so",
];

/// The detector as configured.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectorConfig {
    /// The network, thresholds, classes.
    pub options: DetectorOptions,
    /// Where ONNX Runtime's library may be, in the order of trying.
    pub runtime_candidates: Vec<PathBuf>,
}

/// `None` when something that must be there is missing or wrong; the mistake is noted.
pub(super) fn read(detector: &Reader<'_, '_>) -> Option<DetectorConfig> {
    let model = detector.required_path("model");
    let families = Family::ALL.map(|family| (family.as_str(), Some(family)));
    let families: Vec<_> = families.into_iter().chain([("auto", None)]).collect();
    let family = detector.choice("family", &families).flatten();
    let options = DetectorOptions {
        model: model.clone().unwrap_or_default(),
        family,
        class_names: detector.texts("class_names"),
        network: network(detector),
        filter: filter(detector),
        iou_threshold: detector
            .number("iou_threshold", 0.0..=1.0)
            .unwrap_or(DEFAULT_IOU_THRESHOLD) as f32,
        exclusive_classes: detector.texts("exclusive_classes").unwrap_or_default(),
        max_detections: detector
            .integer("max_detections", 1..=10_000)
            .unwrap_or(DEFAULT_MAX_DETECTIONS) as usize,
    };
    let runtime_candidates = match detector.path("runtime_library") {
        Some(path) => vec![path],
        None => runtime_candidates(detector),
    };
    model?;
    Some(DetectorConfig {
        options,
        runtime_candidates,
    })
}

/// On a processor a batch takes as long as its images one after the other, and all wait for the last.
const DEFAULT_MAX_BATCH: usize = 1;

fn network(detector: &Reader<'_, '_>) -> NetworkOptions {
    let cores = available_parallelism().map_or(1, NonZero::get);
    let threads = detector.integer("threads", 0..=256).unwrap_or(0) as usize;
    let size = detector.numbers::<2>("input_size_px");
    let fits =
        |side: f64| (1.0..=f64::from(LARGEST_SIDE_PX)).contains(&side) && side.fract() == 0.0;
    if size.is_some_and(|size| !size.into_iter().all(fits)) {
        detector.note("input_size_px", "expected [width, height] in whole pixels");
    }
    NetworkOptions {
        threads: if threads == 0 { cores } else { threads },
        spinning: detector.flag("spinning").unwrap_or(false),
        input_size: size.map(|[width, height]| ImageSize {
            width_px: width as u32,
            height_px: height as u32,
        }),
        max_batch: detector
            .integer("max_batch", 1..=255)
            .map_or(DEFAULT_MAX_BATCH, |batch| batch as usize),
    }
}

fn filter(detector: &Reader<'_, '_>) -> ClassFilter {
    let thresholds = detector.table("class_thresholds");
    let class_thresholds = thresholds.keys().into_iter().filter_map(|class| {
        let threshold = thresholds.number(class, 0.0..=1.0)?;
        Some((class.to_owned(), threshold as f32))
    });
    let class_thresholds = class_thresholds.collect();
    thresholds.finish();
    ClassFilter {
        score_threshold: detector
            .number("score_threshold", 0.0..=1.0)
            .unwrap_or(DEFAULT_SCORE_THRESHOLD) as f32,
        class_thresholds,
        allowed: detector.texts("classes"),
    }
}

fn runtime_candidates(detector: &Reader<'_, '_>) -> Vec<PathBuf> {
    runtime_places(detector.document().environment())
}

/// Where ONNX Runtime's library is looked for when no configuration names it.
#[must_use]
pub fn runtime_places(environment: &super::Environment) -> Vec<PathBuf> {
    let named = environment.get("ORT_DYLIB_PATH").map(PathBuf::from);
    let in_checkout = environment
        .checkout()
        .map(|folder| folder.join(DEV_LIBRARY));
    let usual = SYSTEM_LIBRARIES.iter().map(PathBuf::from);
    match named {
        Some(path) => vec![path],
        None => in_checkout.into_iter().chain(usual).collect(),
    }
}
