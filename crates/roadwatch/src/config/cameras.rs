//! `[rig]` and `[[camera]]`: which cameras there are, how they see, where they sit, what feeds them.

use super::{
    camera_info, camera_lens, camera_mount, camera_source, camera_source::SourceConfig,
    reader::Reader,
};
use roadwatch_camera::RigDataset;
use roadwatch_core::{CameraName, Method, Rig, RigCamera, error_chain};
use roadwatch_lab::DatasetFormat;
use std::{path::PathBuf, sync::Arc};

/// Beyond this a height is a slip of units, metres.
const FARTHEST_M: f64 = 1e4;
/// Key of cameras that no table of their own configures.
const DATASET_KEY: &str = "rig.dataset";

/// What is configured for one camera beside its place in the [`Rig`].
#[derive(Debug, Clone, PartialEq)]
pub struct CameraConfig {
    /// What feeds it.
    pub source: SourceConfig,
    /// How its objects are located; `None` for the rig's method.
    pub method: Option<Method>,
    /// The file of its look-up table; `None` to build one at start.
    pub table: Option<PathBuf>,
    /// Dotted key of the table that configures it, such as `camera[0]`, or `rig.dataset`.
    pub key: String,
}

impl CameraConfig {
    /// How its objects are located, where the rig's cameras use `general`: a camera that names a table and no
    /// method asks that table.
    #[must_use]
    pub fn method_or(&self, general: Method) -> Method {
        let by_table = self.table.as_ref().map(|_| Method::Table);
        self.method.or(by_table).unwrap_or(general)
    }
}

/// The rig, and one [`CameraConfig`] per camera of it.
#[derive(Debug, Clone)]
pub struct RigConfig {
    /// The cameras as geometry.
    pub rig: Rig,
    /// The cameras as configuration, in order of their ids.
    pub cameras: Vec<CameraConfig>,
    /// The dataset that some of them play; `None` without one.
    pub dataset: Option<Arc<RigDataset>>,
    /// How the dataset is laid out.
    pub format: DatasetFormat,
}

/// The dataset that the command line names instead of the configured one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DatasetChoice {
    /// Its folder.
    pub folder: PathBuf,
    /// How it is laid out; `None` as the configuration says.
    pub format: Option<DatasetFormat>,
}

impl From<PathBuf> for DatasetChoice {
    fn from(folder: PathBuf) -> Self {
        Self {
            folder,
            format: None,
        }
    }
}

/// What `[rig]` says by itself.
pub(super) struct RigHead {
    dataset: DatasetState,
    format: DatasetFormat,
    ground_z_m: f64,
    /// The dataset came from the command line: `[[camera]]` tables may then name cameras it has not.
    overridden: bool,
}

enum DatasetState {
    /// None is named.
    Absent,
    /// The one named cannot be opened, so nothing can be said of its cameras.
    Broken,
    Open(Arc<RigDataset>),
}

pub(super) fn read_head(rig: &Reader<'_, '_>, chosen: Option<DatasetChoice>) -> RigHead {
    let configured = rig.path("dataset");
    let configured_format = rig.choice("format", &DatasetFormat::ALL);
    let overridden = chosen.is_some();
    let (folder, format) = match chosen {
        Some(chosen) => (Some(chosen.folder), chosen.format.or(configured_format)),
        None => (configured, configured_format),
    };
    let format = format.unwrap_or_default();
    let dataset = match folder.map(|folder| format.open(&folder)) {
        None => DatasetState::Absent,
        Some(Ok(dataset)) => DatasetState::Open(Arc::new(dataset)),
        Some(Err(error)) => {
            rig.note("dataset", error_chain(&error));
            DatasetState::Broken
        }
    };
    RigHead {
        dataset,
        format,
        ground_z_m: rig
            .number("ground_z_m", -FARTHEST_M..=FARTHEST_M)
            .unwrap_or(0.0),
        overridden,
    }
}

/// `None` when the rig cannot be; every mistake is noted.
pub(super) fn read(
    rig: &Reader<'_, '_>,
    head: &RigHead,
    tables: &[Reader<'_, '_>],
) -> Option<RigConfig> {
    let dataset = match &head.dataset {
        DatasetState::Open(dataset) => Some(Arc::clone(dataset)),
        DatasetState::Absent | DatasetState::Broken => None,
    };
    let mut cameras: Vec<_> = dataset
        .iter()
        .flat_map(|dataset| from_dataset(dataset))
        .collect();
    for table in tables {
        read_table(table, head, &mut cameras);
    }
    if matches!(head.dataset, DatasetState::Broken) || (cameras.is_empty() && !tables.is_empty()) {
        return None;
    }
    let (rig_cameras, configs): (Vec<_>, _) = cameras.into_iter().unzip();
    let built = Rig::new(rig_cameras, head.ground_z_m);
    let advice = "name a dataset here or add [[camera]] tables";
    let built = built.map_err(|error| rig.note("dataset", format!("{error}: {advice}")));
    Some(RigConfig {
        rig: built.ok()?,
        cameras: configs,
        dataset,
        format: head.format,
    })
}

/// One `[[camera]]` table: with intrinsics a camera of its own, without them more about one of the dataset's.
fn read_table(
    table: &Reader<'_, '_>,
    head: &RigHead,
    cameras: &mut Vec<(RigCamera, CameraConfig)>,
) {
    let name = table.required_text("name").and_then(|name| {
        CameraName::new(name)
            .map_err(|error| table.note("name", error.to_string()))
            .ok()
    });
    let known = cameras
        .iter_mut()
        .find(|(camera, _)| Some(&camera.name) == name.as_ref());
    let has_lens = table.has("fx") || (table.has(camera_info::KEY) && table.has("position_m"));
    let is_whole = has_lens || matches!(head.dataset, DatasetState::Absent);
    match known {
        Some((camera, config)) if !is_whole && config.key == DATASET_KEY => {
            adjust(table, camera, config)
        }
        Some(_) => {
            table.note("name", "another camera has this name");
            // Which of the two is meant is unknown, so nothing more is said of this one.
            table.keys();
        }
        None if is_whole => cameras.extend(read_camera(table, name)),
        None => {
            read_config(table, SourceConfig::Dataset(0));
            camera_lens::read_measured_focal(table, 1);
            camera_info::read(table, None);
            if matches!(head.dataset, DatasetState::Open(_)) && !head.overridden {
                table.note("name", "the dataset has no camera of this name");
            }
        }
    }
}

fn from_dataset(dataset: &RigDataset) -> Vec<(RigCamera, CameraConfig)> {
    let config = |index| CameraConfig {
        source: SourceConfig::Dataset(index),
        method: None,
        table: None,
        key: DATASET_KEY.to_owned(),
    };
    let cameras = dataset.cameras().iter().enumerate();
    cameras
        .map(|(index, camera)| (camera.clone(), config(index)))
        .collect()
}

/// What a `[[camera]]` table adds to a camera of the dataset.
fn adjust(table: &Reader<'_, '_>, camera: &mut RigCamera, config: &mut CameraConfig) {
    camera.measured_focal = camera_lens::read_measured_focal(table, camera.model.size.height_px);
    if let Some(model) = camera_info::read(table, Some(camera.model.size)) {
        camera.model = model;
    }
    *config = read_config(table, config.source.clone());
}

fn read_config(table: &Reader<'_, '_>, source: SourceConfig) -> CameraConfig {
    CameraConfig {
        source,
        method: super::locate::read_method(table),
        table: table.path("table"),
        key: table.path_in_file().to_owned(),
    }
}

/// A camera that is not of the dataset: everything must be said.
fn read_camera(
    table: &Reader<'_, '_>,
    name: Option<CameraName>,
) -> Option<(RigCamera, CameraConfig)> {
    let model = camera_lens::read(table);
    let mount = camera_mount::read(table);
    let source = camera_source::read(table);
    let height_px = model.map_or(1, |model| model.size.height_px);
    let measured_focal = camera_lens::read_measured_focal(table, height_px);
    let config = source.map(|source| read_config(table, source));
    let camera = RigCamera {
        name: name?,
        model: model?,
        base_from_optical: mount?,
        measured_focal,
    };
    Some((camera, config?))
}
