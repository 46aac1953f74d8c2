//! What feeds each camera.

use super::ros_images::{BagRecording, to_image};
use crate::config::{CameraConfig, Config, Notes, RigConfig, SourceConfig};
use roadwatch_camera::{
    DecodeCount, ImageSequence, Playback, PlaybackOptions, Player, Recording, Repeat, RigDataset,
    Span, VideoFile,
};
use roadwatch_core::{CameraId, EgoMotion, FrameSource, RigCamera, Timestamp, error_chain};
use roadwatch_ros::{BagImages, ImageTopic, RosError, RosNode, TopicCamera};
use std::sync::Arc;

/// Beginning of a rig without any stamp: one second, as tf takes zero for "latest".
const UNSTAMPED_START: Timestamp = Timestamp::from_nanos(1_000_000_000);

/// What feeds one camera.
pub enum Feed {
    /// Something that is there already.
    Playing(Box<dyn FrameSource>),
    /// A topic, which needs a node to listen.
    Topic {
        /// The topic.
        camera: Box<TopicCamera>,
        /// Counts the images that are decoded.
        decodes: DecodeCount,
    },
}

impl Feed {
    /// The camera's frames.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn listening(self, node: &RosNode) -> Result<Self, RosError> {
        let Self::Topic {
            mut camera,
            decodes,
        } = self
        else {
            return Ok(self);
        };
        camera.images = node.surface().topic(&camera.images);
        camera.info = camera.info.map(|info| node.surface().topic(&info));
        let size = camera.camera.model.size;
        let to_image = to_image(size, camera.images.clone(), decodes);
        let source = ImageTopic::listen(node, *camera, to_image)?;
        Ok(Self::Playing(Box::new(source)))
    }
}

/// What a camera's recording is, or its topic.
enum Opened {
    Recording(Box<dyn Recording>),
    Topic(Box<TopicCamera>),
}

/// Opens what feeds each camera, or notes why not. `decodes` counts the images that are decoded; what was recorded of the
/// vehicle's motion, `ego`, is looped as the images are.
pub fn sources(
    config: &Config,
    playback: PlaybackOptions,
    (decodes, ego): (&DecodeCount, &EgoMotion),
    notes: &mut Notes,
) -> Option<Vec<Feed>> {
    let RigConfig {
        rig,
        cameras,
        dataset,
        ..
    } = config.rig.as_ref()?;
    let start = default_start(cameras, dataset.as_deref());
    let opened: Vec<Option<Opened>> = rig
        .ids()
        .zip(cameras)
        .map(|(id, config)| {
            let camera = (id, rig.camera(id));
            match open_source(camera, config, dataset.as_deref(), (start, decodes)) {
                Ok(opened) => Some(opened),
                Err((key, what)) => {
                    notes.note(&format!("{}.{key}", config.key), what);
                    None
                }
            }
        })
        .collect();
    let opened: Vec<Opened> = opened.into_iter().collect::<Option<_>>()?;
    let spans: Vec<Option<Span>> = opened.iter().map(Opened::span).collect();
    note_lonely(cameras, &spans, notes);
    let spans: Vec<Span> = spans.into_iter().flatten().collect();
    let playback = Playback::new(playback, &spans);
    if playback.options().repeat == Repeat::Loop && !config.ego.is_live() {
        ego.repeat_every(playback.lap());
    }
    let feeds = rig.ids().zip(opened).map(|(camera, opened)| match opened {
        Opened::Recording(recording) => {
            let player = Player::new(camera, recording, Arc::clone(&playback));
            Feed::Playing(Box::new(player))
        }
        Opened::Topic(camera) => Feed::Topic {
            camera,
            decodes: decodes.clone(),
        },
    });
    Some(feeds.collect())
}

impl Opened {
    fn span(&self) -> Option<Span> {
        match self {
            Self::Recording(recording) => Some(recording.span()),
            Self::Topic(_) => None,
        }
    }
}

/// Where recordings without a start stamp begin: with the dataset, or with the earliest that has one.
fn default_start(cameras: &[CameraConfig], dataset: Option<&RigDataset>) -> Timestamp {
    let of_dataset = dataset
        .and_then(|dataset| dataset.frames().first())
        .into_iter();
    let of_dataset = of_dataset.flat_map(|frame| frame.stamps.iter().flatten().copied());
    let of_cameras = cameras.iter().filter_map(|camera| match camera.source {
        SourceConfig::Images { start, .. } | SourceConfig::Video { start, .. } => start,
        _ => None,
    });
    of_dataset
        .chain(of_cameras)
        .min()
        .unwrap_or(UNSTAMPED_START)
}

/// Notes recordings that share no moment with another: played together, one would wait for the other for
/// as long as lies between them.
fn note_lonely(cameras: &[CameraConfig], spans: &[Option<Span>], notes: &mut Notes) {
    let meets = |a: &Span, b: &Span| a.first <= b.last && b.first <= a.last;
    let first = spans.iter().flatten().min_by_key(|span| span.first);
    for (camera, span) in cameras.iter().zip(spans) {
        let (Some(first), Some(span)) = (first, span) else {
            continue;
        };
        if !meets(first, span) {
            let what = "this recording begins after another of the rig has ended; give both matching start stamps";
            notes.note(&start_key(camera), what);
        }
    }
}

/// The key that says when a camera's recording begins.
fn start_key(camera: &CameraConfig) -> String {
    match camera.source {
        SourceConfig::Images { .. } | SourceConfig::Video { .. } => {
            format!("{}.start_stamp", camera.key)
        }
        SourceConfig::Bag { .. } => format!("{}.bag", camera.key),
        _ => camera.key.clone(),
    }
}

fn open_source(
    (id, camera): (CameraId, &RigCamera),
    config: &CameraConfig,
    dataset: Option<&RigDataset>,
    (default_start, decodes): (Timestamp, &DecodeCount),
) -> Result<Opened, (&'static str, String)> {
    let size = camera.model.size;
    let recording: Box<dyn Recording> = match &config.source {
        SourceConfig::Dataset(index) => dataset
            .and_then(|dataset| dataset.recording(*index))
            .ok_or_else(|| "the dataset has no images of this camera".to_owned())
            .and_then(|opened| opened.map_err(|error| error_chain(&error)))
            .map(|recording| Box::new(recording.counting(decodes.clone())))
            .map_err(|what| ("dataset", what))?,
        SourceConfig::Images {
            folder,
            rate,
            start,
        } => ImageSequence::open(folder, size, *rate, start.unwrap_or(default_start))
            .map(|images| Box::new(images.counting(decodes.clone())))
            .map_err(|error| ("images", error_chain(&error)))?,
        SourceConfig::Video { file, start } => {
            VideoFile::open(file, size, start.unwrap_or(default_start))
                .map(Box::new)
                .map_err(|error| ("video", error_chain(&error)))?
        }
        SourceConfig::Bag { bag, topic } => {
            let images =
                BagImages::open(bag, topic).map_err(|error| ("bag", error_chain(&error)))?;
            let to_image = to_image(size, topic.clone(), decodes.clone());
            Box::new(BagRecording { images, to_image })
        }
        SourceConfig::Topic { images, info } => {
            return Ok(Opened::Topic(Box::new(TopicCamera {
                id,
                camera: camera.clone(),
                images: images.clone(),
                info: info.clone(),
            })));
        }
    };
    Ok(Opened::Recording(recording))
}
