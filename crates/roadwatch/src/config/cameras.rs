//! `[rig]` and `[[camera]]`: which cameras there are, how they see, where they sit, what feeds them.

use super::{camera_info, reader::Reader};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use roadwatch_camera::{FrameRate, RigDataset};
use roadwatch_core::{
    CameraModel, CameraName, Distortion, ImageSize, Intrinsics, MeasuredFocal, Method, Rig,
    RigCamera, Timestamp, error_chain, space::Transform,
};
use roadwatch_lab::DatasetFormat;
use std::{path::PathBuf, sync::Arc};

/// How far a quaternion's length may be from 1: what printing it with four digits costs.
const UNIT_TOLERANCE: f64 = 1e-3;
/// What a `camera_info` says instead.
const LENS_KEYS: [&str; 6] = ["fx", "fy", "cx", "cy", "distortion_model", "distortion"];
const LARGEST_SIDE_PX: u32 = 16_384;
/// Beyond this a focal length is a slip of units, pixels.
const LONGEST_FOCAL_PX: f64 = 1e6;
/// Beyond this a mount is a slip of units, metres.
const FARTHEST_M: f64 = 1e4;

/// Key of cameras that no table of their own configures.
const DATASET_KEY: &str = "rig.dataset";

/// What feeds a camera.
#[derive(Debug, Clone, PartialEq)]
pub enum SourceConfig {
    /// The camera of this index in the rig dataset.
    Dataset(usize),
    /// A folder of images.
    Images {
        /// The folder.
        folder: PathBuf,
        /// Frames per second.
        rate: FrameRate,
        /// Stamp of the first; `None` for the rig's own beginning.
        start: Option<Timestamp>,
    },
    /// A video file.
    Video {
        /// The file.
        file: PathBuf,
        /// Stamp of the first frame; `None` for the rig's own beginning.
        start: Option<Timestamp>,
    },
}

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
            measured_focal(table, 1);
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
    camera.measured_focal = measured_focal(table, camera.model.size.height_px);
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
    let model = read_model(table);
    let position = table.numbers::<3>("position_m");
    let orientation = read_orientation(table);
    if !table.has("position_m") {
        table.note(
            "position_m",
            "missing: the camera's place in base_link, [x, y, z] in metres",
        );
    }
    let source = read_source(table);
    let focal = measured_focal(table, model.map_or(1, |model| model.size.height_px));
    let config = source.map(|source| read_config(table, source));
    let (model, [x, y, z]) = (model?, position?);
    let camera = RigCamera {
        name: name?,
        model,
        base_from_optical: Transform::new(Isometry3::from_parts(
            Translation3::new(x, y, z),
            orientation?,
        )),
        measured_focal: focal,
    };
    Some((camera, config?))
}

/// From `camera_info`, or from keys of its own.
fn read_model(table: &Reader<'_, '_>) -> Option<CameraModel> {
    if !table.has(camera_info::KEY) {
        return read_lens(table);
    }
    let side = |key| table.integer(key, 1..=LARGEST_SIDE_PX);
    let given = side("width").zip(side("height"));
    let expected = given.map(|(width_px, height_px)| ImageSize {
        width_px,
        height_px,
    });
    for key in LENS_KEYS.into_iter().filter(|key| table.has(key)) {
        table.note(key, "is in the camera_info already: name the lens once");
        table.mark_read(key);
    }
    camera_info::read(table, expected)
}

fn read_lens(table: &Reader<'_, '_>) -> Option<CameraModel> {
    let width_px = table.required_integer("width", 1..=LARGEST_SIDE_PX);
    let height_px = table.required_integer("height", 1..=LARGEST_SIDE_PX);
    let focal = |key| table.required_number(key, 1.0..=LONGEST_FOCAL_PX);
    let center = |key| table.required_number(key, -LONGEST_FOCAL_PX..=LONGEST_FOCAL_PX);
    let (fx, fy, cx, cy) = (focal("fx"), focal("fy"), center("cx"), center("cy"));
    let coefficients = table.number_list("distortion").unwrap_or_default();
    if table.has("distortion") && !table.has("distortion_model") {
        table.note(
            "distortion",
            "needs a distortion_model, such as \"plumb_bob\"",
        );
    }
    let lens = Distortion::from_ros(
        table.text("distortion_model").unwrap_or("none"),
        &coefficients,
    );
    let distortion = lens
        .map_err(|error| table.note("distortion_model", error.to_string()))
        .ok();
    Some(CameraModel {
        size: ImageSize {
            width_px: width_px?,
            height_px: height_px?,
        },
        intrinsics: Intrinsics {
            fx: fx?,
            fy: fy?,
            cx: cx?,
            cy: cy?,
        },
        distortion: distortion?,
    })
}

fn read_orientation(table: &Reader<'_, '_>) -> Option<UnitQuaternion<f64>> {
    const KEY: &str = "orientation_wxyz";
    if !table.has(KEY) {
        table.note(
            KEY,
            "missing: the quaternion [w, x, y, z] that turns optical axes into base_link's",
        );
    }
    let [w, x, y, z] = table.numbers::<4>(KEY)?;
    let quaternion = Quaternion::new(w, x, y, z);
    if (quaternion.norm() - 1.0).abs() > UNIT_TOLERANCE {
        table.note(
            KEY,
            format!("a rotation has length 1; this has {:.4}", quaternion.norm()),
        );
        return None;
    }
    Some(UnitQuaternion::from_quaternion(quaternion))
}

fn measured_focal(table: &Reader<'_, '_>, camera_height_px: u32) -> Option<MeasuredFocal> {
    let focal = table.number("measured_focal_px", 1.0..=LONGEST_FOCAL_PX);
    let height = table.integer("measured_focal_image_height_px", 1..=LARGEST_SIDE_PX);
    if height.is_some() && !table.has("measured_focal_px") {
        table.note("measured_focal_image_height_px", "needs measured_focal_px");
    }
    Some(MeasuredFocal {
        focal_px: focal?,
        image_height_px: height.unwrap_or(camera_height_px),
    })
}

fn read_source(table: &Reader<'_, '_>) -> Option<SourceConfig> {
    let start = match table.text("start_stamp") {
        None => None,
        Some(text) => match text.parse() {
            Ok(start) => Some(start),
            Err(error) => {
                table.note("start_stamp", format!("{error}"));
                return None;
            }
        },
    };
    let rate_hz = table.number("rate_hz", 0.001..=1000.0);
    match (table.path("images"), table.path("video")) {
        (Some(folder), None) => {
            let Some(rate) = rate_hz.and_then(FrameRate::from_hz) else {
                table.note("rate_hz", "missing: frames per second of the images");
                return None;
            };
            Some(SourceConfig::Images {
                folder,
                rate,
                start,
            })
        }
        (None, Some(file)) => {
            if rate_hz.is_some() {
                table.note("rate_hz", "is for images; a video has its own");
            }
            Some(SourceConfig::Video { file, start })
        }
        (Some(_), Some(_)) => {
            table.note("video", "a camera has one source: `images` or `video`");
            None
        }
        (None, None) => {
            table.note(
                "images",
                "missing: name a folder of `images` or a `video` file",
            );
            None
        }
    }
}
