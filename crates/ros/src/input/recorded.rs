//! What a daemon recorded, read back: its arrays of objects, its cameras.

use super::{
    bag_error::BagImagesError,
    bag_file::TopicReader,
    bag_images::{OneFile, files, type_of},
    bag_messages::messages_of,
};
use crate::{
    cdr,
    msg::{
        geometry_msgs::Transform, roadwatch_msgs::ObjectArray, sensor_msgs::CameraInfo,
        tf2_msgs::TFMessage,
    },
    scene_lines::{LineCamera, LineRig},
};
use mcap::sans_io::indexed_reader::ReadOrder;
use serde::de::DeserializeOwned;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

const OBJECTS: &str = "roadwatch_msgs/msg/ObjectArray";
const CAMERA_INFO: &str = "sensor_msgs/msg/CameraInfo";
const TRANSFORMS: &str = "tf2_msgs/msg/TFMessage";
/// End of the name of a camera's frame, behind the camera's.
const OPTICAL_FRAME: &str = "_optical_frame";

/// Why a recording does not give what was asked of it.
#[derive(Debug, thiserror::Error)]
pub enum RecordedError {
    /// It cannot be read.
    #[error(transparent)]
    Bag(#[from] BagImagesError),
    /// A message is not what its topic promises.
    #[error("a message on `{topic}` of `{}` cannot be read: was it recorded with another version?", path.display())]
    Message {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// What is wrong.
        source: cdr::DecodeError,
    },
    /// No scene was recorded.
    #[error(
        "`{}` holds no scene of Roadwatch: record one with `roadwatch run CONFIG --bag DIR`", .0.display()
    )]
    NoScene(PathBuf),
    /// More than one was.
    #[error("`{}` holds the scenes of several daemons: choose with --topic one of {}", path.display(), topics.join(", "))]
    Scenes {
        /// The bag.
        path: PathBuf,
        /// Their topics.
        topics: Vec<String>,
    },
}

/// A bag with what a daemon published.
pub struct Recorded {
    path: PathBuf,
    files: Vec<OneFile>,
    scenes: Vec<String>,
    cameras: BTreeMap<String, String>,
}

impl Recorded {
    /// Opens a bag: an `.mcap` file, or a folder with some.
    ///
    /// # Errors
    /// When it is no bag, is damaged, or its arrays are of another version.
    pub fn open(path: &Path) -> Result<Self, RecordedError> {
        let mut opened = Self {
            path: path.to_owned(),
            files: files(path)?,
            scenes: Vec::new(),
            cameras: BTreeMap::new(),
        };
        for topic in opened.topics_of(OBJECTS) {
            // Names may be remapped; what an array is of, it says itself.
            let first = opened.arrays(&topic).next().transpose()?;
            match first {
                Some(array) if array.camera.is_empty() => opened.scenes.push(topic),
                Some(array) => {
                    opened.cameras.insert(array.camera, topic);
                }
                None => {}
            }
        }
        Ok(opened)
    }

    /// The topic of the scene.
    ///
    /// # Errors
    /// When there is none, or more than one.
    pub fn scene_topic(&self) -> Result<&str, RecordedError> {
        match self.scenes.as_slice() {
            [topic] => Ok(topic),
            [] => Err(RecordedError::NoScene(self.path.clone())),
            several => Err(RecordedError::Scenes {
                path: self.path.clone(),
                topics: several.to_vec(),
            }),
        }
    }

    /// The topic of each camera's objects, by the camera's name.
    #[must_use]
    pub fn camera_topics(&self) -> &BTreeMap<String, String> {
        &self.cameras
    }

    /// The arrays of a topic, in order of their log times. Read as they are asked for.
    pub fn arrays(&self, topic: &str) -> impl Iterator<Item = Result<ObjectArray, RecordedError>> {
        let mut at = 0;
        let mut reader: Option<TopicReader> = None;
        std::iter::from_fn(move || {
            loop {
                if reader.is_none() {
                    let file = self.files.get(at)?;
                    at += 1;
                    match self.reader(file, topic) {
                        Ok(opened) => reader = opened,
                        Err(error) => return Some(Err(error)),
                    }
                }
                let next = reader.as_mut().map(TopicReader::next);
                match next {
                    Some(Ok(Some(bytes))) => return Some(self.decoded(topic, &bytes)),
                    Some(Ok(None)) | None => reader = None,
                    Some(Err(source)) => {
                        let path = self.path.clone();
                        at = self.files.len();
                        reader = None;
                        return Some(Err(BagImagesError::Damaged { path, source }.into()));
                    }
                }
            }
        })
    }

    /// How many arrays a topic has.
    #[must_use]
    pub fn count(&self, topic: &str) -> u64 {
        let of_file = |file: &OneFile| {
            let stats = file.summary.stats.as_ref()?;
            let mut channels = file.summary.channels.values();
            let channel = channels.find(|channel| channel.topic == topic)?;
            stats.channel_message_counts.get(&channel.id).copied()
        };
        self.files.iter().filter_map(of_file).sum()
    }

    /// The rig: every camera whose calibration and place were recorded.
    ///
    /// # Errors
    /// When a message cannot be read.
    pub fn line_rig(&self) -> Result<LineRig, RecordedError> {
        let mut places: BTreeMap<String, (String, Transform)> = BTreeMap::new();
        for topic in self.topics_of(TRANSFORMS) {
            for bytes in messages_of(&self.path, &topic, TRANSFORMS)? {
                let message: TFMessage = self.decoded(&topic, &bytes)?;
                let named = message.transforms.into_iter();
                places.extend(
                    named.map(|one| (one.child_frame_id, (one.header.frame_id, one.transform))),
                );
            }
        }
        let mut rig = LineRig::default();
        for topic in self.topics_of(CAMERA_INFO) {
            let Some(bytes) = self.first(&topic)? else {
                continue;
            };
            let camera_info: CameraInfo = self.decoded(&topic, &bytes)?;
            let frame = &camera_info.header.frame_id;
            let (Some(name), Some((base_frame, base_from_optical))) =
                (frame.strip_suffix(OPTICAL_FRAME), places.get(frame))
            else {
                tracing::warn!(%topic, %frame, "a camera without a place in the bag is left out");
                continue;
            };
            rig.base_frame.clone_from(base_frame);
            rig.cameras.push(LineCamera {
                name: name.to_owned(),
                base_from_optical: *base_from_optical,
                camera_info,
            });
        }
        Ok(rig)
    }

    fn topics_of(&self, ros_type: &str) -> BTreeSet<String> {
        let channels = self
            .files
            .iter()
            .flat_map(|file| file.summary.channels.values());
        let is_that = |channel: &&std::sync::Arc<mcap::Channel<'_>>| {
            let schema = channel.schema.as_ref();
            schema.is_some_and(|schema| schema.name == ros_type)
        };
        let found = channels.filter(is_that);
        found.map(|channel| channel.topic.clone()).collect()
    }

    fn first(&self, topic: &str) -> Result<Option<Vec<u8>>, RecordedError> {
        for file in &self.files {
            if let Some(mut reader) = self.reader(file, topic)? {
                let next = reader.next();
                let next = next.map_err(|source| BagImagesError::Damaged {
                    path: file.path.clone(),
                    source,
                })?;
                if next.is_some() {
                    return Ok(next);
                }
            }
        }
        Ok(None)
    }

    /// `None` where a file does not have the topic.
    fn reader(&self, file: &OneFile, topic: &str) -> Result<Option<TopicReader>, RecordedError> {
        if type_of(&file.summary, topic).is_none() {
            return Ok(None);
        }
        let opened = TopicReader::open(&file.path, &file.summary, topic, ReadOrder::LogTime);
        let opened = opened.map_err(|source| BagImagesError::Damaged {
            path: file.path.clone(),
            source,
        })?;
        Ok(Some(opened))
    }

    fn decoded<M: DeserializeOwned>(&self, topic: &str, bytes: &[u8]) -> Result<M, RecordedError> {
        cdr::decode(bytes).map_err(|source| RecordedError::Message {
            path: self.path.clone(),
            topic: topic.to_owned(),
            source,
        })
    }
}
