//! From configuration to the parts of a pipeline: everything that can fail at start fails here.

use crate::config::{CameraConfig, Config, Notes, RigConfig, SourceConfig};
use roadwatch_camera::{
    DecodeCount, ImageSequence, Playback, PlaybackOptions, Player, Recording, RigDataset, VideoFile,
};
use roadwatch_core::{CameraId, FrameSource, Locator, Rig, RigCamera};
use roadwatch_detect::{NetworkError, Runtime, YoloDetector};
use std::sync::Arc;

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
            notes.note(detector_key(&error), error.to_string());
            None
        }
    }
}

fn detector_key(error: &roadwatch_detect::DetectorError) -> &'static str {
    use roadwatch_detect::DetectorError as E;
    match error {
        E::Network(_) => "detector.model",
        E::WrongFamily { .. } => "detector.family",
        E::ClassNames { .. } => "detector.class_names",
        E::UnknownClass { .. } => "detector.classes",
    }
}

/// Builds every camera's locator by the method configured for it, or notes why not.
pub fn locators(config: &Config, notes: &mut Notes) -> Option<Vec<Box<dyn Locator>>> {
    let rig = config.rig.as_ref()?;
    let pairs = rig.rig.cameras().iter().zip(&rig.cameras);
    let built: Vec<Option<Box<dyn Locator>>> = pairs
        .map(|(camera, camera_config)| {
            let method = camera_config.method.unwrap_or(config.locate.method);
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

/// A recording of any kind, opened, not yet playing.
enum Opened {
    Images(ImageSequence),
    Video(VideoFile),
}

impl Opened {
    fn span(&self) -> roadwatch_camera::Span {
        match self {
            Self::Images(images) => images.span(),
            Self::Video(video) => video.span(),
        }
    }

    fn play(self, camera: CameraId, playback: &Arc<Playback>) -> Box<dyn FrameSource> {
        let playback = Arc::clone(playback);
        match self {
            Self::Images(images) => Box::new(Player::new(camera, images, playback)),
            Self::Video(video) => Box::new(Player::new(camera, video, playback)),
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
    } = config.rig.as_ref()?;
    let opened: Vec<Option<Opened>> = rig
        .cameras()
        .iter()
        .zip(cameras)
        .map(
            |(camera, config)| match open_source(camera, config, dataset.as_deref(), decodes) {
                Ok(opened) => Some(opened),
                Err((key, what)) => {
                    notes.note(&format!("{}.{key}", config.key), what);
                    None
                }
            },
        )
        .collect();
    let opened: Vec<Opened> = opened.into_iter().collect::<Option<_>>()?;
    let spans: Vec<_> = opened.iter().map(Opened::span).collect();
    let playback = Playback::new(playback, &spans);
    let players = rig.ids().zip(opened);
    Some(
        players
            .map(|(camera, opened)| opened.play(camera, &playback))
            .collect(),
    )
}

fn open_source(
    camera: &RigCamera,
    config: &CameraConfig,
    dataset: Option<&RigDataset>,
    decodes: &DecodeCount,
) -> Result<Opened, (&'static str, String)> {
    let size = camera.model.size;
    match &config.source {
        SourceConfig::Dataset(index) => dataset
            .and_then(|dataset| dataset.recording(*index))
            .map(|images| Opened::Images(images.counting(decodes.clone())))
            .ok_or_else(|| {
                (
                    "dataset",
                    "the dataset has no images of this camera".to_owned(),
                )
            }),
        SourceConfig::Images {
            folder,
            rate,
            start,
        } => ImageSequence::open(folder, size, *rate, *start)
            .map(|images| Opened::Images(images.counting(decodes.clone())))
            .map_err(|error| ("images", error.to_string())),
        SourceConfig::Video { file, start } => VideoFile::open(file, size, *start)
            .map(Opened::Video)
            .map_err(|error| ("video", error.to_string())),
    }
}

/// The rig, shared; `None` when it could not be understood.
#[must_use]
pub fn shared_rig(config: &Config) -> Option<Arc<Rig>> {
    config.rig.as_ref().map(|rig| Arc::new(rig.rig.clone()))
}
