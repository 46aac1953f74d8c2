//! Configuration: what the user typed, checked whole, as what it means.

mod camera_info;
mod camera_lens;
mod camera_mount;
pub mod camera_source;
pub mod cameras;
mod changes;
pub mod detector;
mod diagnostics;
mod document;
mod ego;
mod environment;
pub mod locate;
mod mistake;
pub mod node;
mod notes;
mod reader;
mod reid;
pub mod rotation;
mod scene_stream;
mod values;

pub use camera_source::SourceConfig;
pub use cameras::{CameraConfig, DatasetChoice, RigConfig};
pub use changes::Changes;
pub use detector::DetectorConfig;
pub use diagnostics::DiagnosticLimits;
pub use ego::{EgoConfig, EgoTopic};
pub use environment::Environment;
pub use locate::LocateConfig;
pub use mistake::{Mistake, Mistakes};
pub use node::NodeConfig;
pub use notes::Notes;
pub use reid::{Identities, ReidConfig};
pub use rotation::RotationConfig;

use document::Document;
use reader::Reader;
use roadwatch_pipeline::PipelineOptions;
use std::{fs, net::SocketAddr, path::Path, time::Duration};

/// Longer than this no round is worth waiting for, seconds.
const LONGEST_SCENE_TIMEOUT_SECS: f64 = 60.0;

/// A configuration as far as it could be understood, with the mistakes found on the way.
///
/// What could be understood is still opened, so that one run shows everything that is wrong.
#[derive(Debug, Clone)]
pub struct Config {
    /// Mistakes so far, and where keys stand.
    pub notes: Notes,
    /// `[node]`.
    pub node: NodeConfig,
    /// `[detector]`; `None` when there is a mistake in it.
    pub detector: Option<DetectorConfig>,
    /// `[rig]` and `[[camera]]`; `None` when there is a mistake in them.
    pub rig: Option<RigConfig>,
    /// `[locate]`.
    pub locate: LocateConfig,
    /// `[rotation]`; `None` without it, or when there is a mistake in it.
    pub rotation: Option<RotationConfig>,
    /// `[scene] timeout_secs`.
    pub scene_timeout: Duration,
    /// `[reid]`.
    pub reid: ReidConfig,
    /// `[ego]`.
    pub ego: EgoConfig,
    /// `[scene_stream] listen`; `None` where the scene is not offered.
    pub scene_stream: Option<SocketAddr>,
    /// `[enabled]`: whether each camera, in order of their ids, is looked at from the start.
    pub enabled: Vec<bool>,
    /// `[diagnostics]`.
    pub diagnostics: DiagnosticLimits,
}

impl Config {
    /// Reads a file, with what the command line changes in it.
    ///
    /// # Errors
    /// When the file cannot be read or is not TOML.
    pub fn load(
        file: &Path,
        changes: &Changes,
        environment: &Environment,
    ) -> Result<Self, Mistakes> {
        let text = fs::read_to_string(file)
            .map_err(|error| Mistakes::about_file(file, format!("cannot be read: {error}")))?;
        Self::parse(file, &text, changes, environment)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// When the text is not TOML.
    pub fn parse(
        file: &Path,
        text: &str,
        changes: &Changes,
        environment: &Environment,
    ) -> Result<Self, Mistakes> {
        let node_name = changes.node_name(file, text);
        let overrides = changes.overrides(&node_name)?;
        let document = Document::new(file, (text, &overrides), environment);
        let table = document.parse()?;
        let mut config = read(
            Reader::root(&document, &table),
            Notes::new(file, text, table.get_ref()),
            changes.dataset.clone(),
        );
        let surface = &mut config.node.options.surface;
        *surface = surface.renamed(&changes.ros);
        config.notes.extend(document.into_mistakes());
        Ok(config)
    }
}

fn read(root: Reader<'_, '_>, notes: Notes, dataset: Option<DatasetChoice>) -> Config {
    let sections = [
        "node",
        "detector",
        "rig",
        "locate",
        "rotation",
        "scene",
        "reid",
        "ego",
        "scene_stream",
        "enabled",
        "diagnostics",
    ];
    let sections = sections.map(|key| root.table(key));
    let [
        node,
        detector,
        rig,
        locate,
        rotation,
        scene,
        reid,
        ego,
        scene_stream,
        enabled,
        diagnostics,
    ] = &sections;
    let camera_tables = root.tables("camera");
    let head = cameras::read_head(rig, dataset);
    let rig_config = cameras::read(rig, &head, &camera_tables);
    if !detector.is_present() {
        root.note(
            "detector",
            "missing: add a [detector] table with `model = \"….onnx\"`",
        );
    }
    let config = Config {
        notes,
        node: node::read(node),
        detector: detector::read(detector),
        reid: reid::read(reid),
        ego: ego::read(ego),
        scene_stream: scene_stream::read(scene_stream),
        diagnostics: diagnostics::read(diagnostics),
        enabled: read_enabled(enabled, rig_config.as_ref()),
        rig: rig_config,
        locate: locate::read(locate),
        rotation: rotation::read(rotation),
        scene_timeout: read_timeout(scene),
    };
    root.finish();
    for reader in sections.into_iter().chain(camera_tables) {
        reader.finish();
    }
    config
}

fn read_timeout(scene: &Reader<'_, '_>) -> Duration {
    let seconds = scene.number("timeout_secs", 0.001..=LONGEST_SCENE_TIMEOUT_SECS);
    seconds.map_or(
        PipelineOptions::DEFAULT_SCENE_TIMEOUT,
        Duration::from_secs_f64,
    )
}

/// One answer per camera of the rig; cameras that are not mentioned are looked at.
fn read_enabled(enabled: &Reader<'_, '_>, rig: Option<&RigConfig>) -> Vec<bool> {
    let Some(rig) = rig else {
        // Which cameras there are is unknown, so nothing can be said of their names.
        enabled.keys();
        return Vec::new();
    };
    let cameras = rig.rig.cameras().iter();
    cameras
        .map(|camera| enabled.flag(camera.name.as_str()).unwrap_or(true))
        .collect()
}
