//! `[rotation]`: which way objects point.

use super::reader::Reader;
use roadwatch_core::ObjectClass;
use roadwatch_rotate::RotationOptions;
use std::path::PathBuf;

/// A crop costs some milliseconds, and headings are kept in between.
const DEFAULT_CROPS_PER_FRAME: u32 = 4;
/// Smaller boxes show no components.
const DEFAULT_MIN_HEIGHT_PX: f64 = 20.0;
/// What the shipped models were trained on.
const DEFAULT_CLASSES: [&str; 3] = ["car", "truck", "bus"];

/// How headings are estimated.
#[derive(Debug, Clone, PartialEq)]
pub struct RotationConfig {
    /// The key-component model.
    pub model: PathBuf,
    /// The detector whose features it reads; `None` for the one that detects.
    pub features: Option<PathBuf>,
    /// The forest.
    pub forest: PathBuf,
    /// The paper's curve in place of the exact ray.
    pub position_curve: Option<PathBuf>,
    /// Most objects of a frame that are looked at.
    pub crops_per_frame: usize,
    /// Threads inside one run.
    pub threads: usize,
    /// Which objects.
    pub options: RotationOptions,
}

/// `None` without the table, and when something that must be there is missing or wrong; the mistake is noted.
pub(super) fn read(rotation: &Reader<'_, '_>) -> Option<RotationConfig> {
    if !rotation.is_present() {
        return None;
    }
    let (model, forest) = (
        rotation.required_path("model"),
        rotation.required_path("forest"),
    );
    let classes = rotation.texts("classes");
    let classes = classes.unwrap_or_else(|| DEFAULT_CLASSES.map(str::to_owned).to_vec());
    let features = rotation.path("features");
    let position_curve = rotation.path("position_curve");
    let crops = rotation.integer("crops_per_frame", 1..=255);
    let height = rotation.number("min_height_px", 1.0..=10_000.0);
    let threads = rotation.integer("threads", 1..=256);
    Some(RotationConfig {
        model: model?,
        features,
        position_curve,
        forest: forest?,
        crops_per_frame: crops.unwrap_or(DEFAULT_CROPS_PER_FRAME) as usize,
        threads: threads.unwrap_or(1) as usize,
        options: RotationOptions {
            classes: classes.iter().map(|name| ObjectClass::new(name)).collect(),
            min_height_px: height.unwrap_or(DEFAULT_MIN_HEIGHT_PX) as f32,
        },
    })
}
