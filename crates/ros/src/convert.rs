//! From outputs to messages: pure functions, the same for the node and for the bag.

mod autoware;
mod calibration;
mod detections;
mod markers;
mod objects;
mod pose;
mod seen;

use crate::{
    msg::{
        autoware_perception_msgs::{DetectedObjects, TrackedObjects},
        roadwatch_msgs::ObjectArray,
        sensor_msgs::{CameraInfo, CompressedImage},
        tf2_msgs::TFMessage,
        vision_msgs::{Detection2DArray, Detection3DArray},
        visualization_msgs::MarkerArray,
    },
    scene_lines::{LineCamera, LineRig},
    surface::{InvalidSurface, Surface},
    topics::{Topic, TopicKind, Topics},
};
use nalgebra::Isometry3;
use roadwatch_core::{CameraId, Output, Perceived, Rig, RigCamera, Scene, Timestamp};
use seen::{PublishedIn, SeenTogether};
use serde::Serialize;
use std::{ops::Range, sync::Arc};

#[cfg(test)]
pub(crate) use calibration::camera_info;
pub use markers::MARKER_LIFETIME;
pub use pose::{UPRIGHT_VARIANCE_RAD2, YAW_UNKNOWN_VARIANCE_RAD2};

/// A message of any published type; serialises as the message inside.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Message {
    /// For [`TopicKind::Objects`].
    Objects(ObjectArray),
    /// For [`TopicKind::Detections2d`].
    Detections2d(Detection2DArray),
    /// For [`TopicKind::Detections3d`].
    Detections3d(Detection3DArray),
    /// For [`TopicKind::Markers`].
    Markers(MarkerArray),
    /// For [`TopicKind::CameraInfo`].
    CameraInfo(Box<CameraInfo>),
    /// For [`TopicKind::TfStatic`].
    TfStatic(TFMessage),
    /// For [`TopicKind::DetectedObjects`].
    DetectedObjects(DetectedObjects),
    /// For [`TopicKind::TrackedObjects`].
    TrackedObjects(TrackedObjects),
    /// For [`TopicKind::Image`].
    Image(CompressedImage),
}

impl Message {
    /// The kind of topic it belongs to.
    #[must_use]
    pub fn kind(&self) -> TopicKind {
        match self {
            Self::Objects(_) => TopicKind::Objects,
            Self::Detections2d(_) => TopicKind::Detections2d,
            Self::Detections3d(_) => TopicKind::Detections3d,
            Self::Markers(_) => TopicKind::Markers,
            Self::CameraInfo(_) => TopicKind::CameraInfo,
            Self::TfStatic(_) => TopicKind::TfStatic,
            Self::DetectedObjects(_) => TopicKind::DetectedObjects,
            Self::TrackedObjects(_) => TopicKind::TrackedObjects,
            Self::Image(_) => TopicKind::Image,
        }
    }
}

/// A message and where it goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Outgoing {
    /// Place of its topic in [`Messages::topics`].
    pub topic: usize,
    /// What is published there.
    pub message: Message,
}

/// Turns outputs of one rig into messages.
#[derive(Clone, Debug)]
pub struct Messages {
    rig: Arc<Rig>,
    base_frame: String,
    scene_in_odom: Option<String>,
    topics: Topics,
}

impl Messages {
    /// Messages of `rig` under the names of `surface`.
    ///
    /// # Errors
    /// When ROS 2 would refuse a name.
    pub fn new(rig: Arc<Rig>, surface: &Surface) -> Result<Self, InvalidSurface> {
        surface.check()?;
        Ok(Self {
            topics: Topics::new(&rig, surface),
            base_frame: surface.base_frame.clone(),
            scene_in_odom: surface.scene_in_odom.clone(),
            rig,
        })
    }

    /// Every topic that a message can go to.
    #[must_use]
    pub fn topics(&self) -> &[Topic] {
        self.topics.list()
    }

    /// The tf frame of a camera's images.
    #[must_use]
    pub fn frame_of(&self, camera: CameraId) -> String {
        self.rig.camera(camera).name.optical_frame()
    }

    /// The messages of one output, in order of publishing. Nothing seen gives empty arrays.
    #[must_use]
    pub fn of(&self, output: &Output) -> Vec<Outgoing> {
        self.of_wanted(output, |_topic| true)
    }

    /// Those of [`Messages::of`] whose topics, by their places, are `wanted`; the others are not made.
    #[must_use]
    pub fn of_wanted(&self, output: &Output, wanted: impl Fn(usize) -> bool) -> Vec<Outgoing> {
        let wanted = |places: Range<usize>| places.filter(|&topic| wanted(topic)).collect();
        match output {
            Output::Camera(perceived) => {
                let topics = self.topics.of_camera(perceived.tracks.frame.camera);
                self.of_camera(perceived, wanted(topics))
            }
            Output::Scene(scene) => self.of_scene(scene, wanted(self.topics.of_scene())),
        }
    }

    /// Markers that take away what is shown of a camera.
    #[must_use]
    pub fn no_markers(&self, camera: CameraId, stamp: Timestamp) -> Outgoing {
        let topics = self.topics.of_camera(camera);
        let is_markers = |&topic: &usize| self.topics()[topic].kind == TopicKind::Markers;
        Outgoing {
            topic: topics.clone().find(is_markers).unwrap_or(topics.start),
            message: Message::Markers(markers::none(&self.base_frame, stamp)),
        }
    }

    /// Where every camera sits, for `/tf_static`. Tools show its stamp and some refuse zero; static
    /// transforms hold at all times.
    #[must_use]
    pub fn tf_static(&self, stamp: Timestamp) -> Outgoing {
        Outgoing {
            topic: Topics::TF_STATIC,
            message: Message::TfStatic(calibration::tf_static(&self.rig, &self.base_frame, stamp)),
        }
    }

    /// Everything that is known of a scene, in the frame that it is published in.
    #[must_use]
    pub fn scene_objects(&self, scene: &Scene) -> ObjectArray {
        let frame = self.scene_frame(scene);
        objects::objects(&SeenTogether::in_scene(&self.rig, &frame, scene))
    }

    /// The rig for [`scene_lines`](crate::scene_lines).
    #[must_use]
    pub fn line_rig(&self) -> LineRig {
        let camera = |camera: &RigCamera| LineCamera {
            name: camera.name.as_str().to_owned(),
            base_from_optical: (&camera.base_from_optical.isometry).into(),
            camera_info: calibration::camera_info(camera, Timestamp::default()),
        };
        LineRig {
            base_frame: self.base_frame.clone(),
            cameras: self.rig.cameras().iter().map(camera).collect(),
        }
    }

    fn of_camera(&self, perceived: &Perceived, topics: Vec<usize>) -> Vec<Outgoing> {
        if topics.is_empty() {
            return Vec::new();
        }
        let camera = self.rig.camera(perceived.tracks.frame.camera);
        let seen = SeenTogether::in_camera(
            &self.rig,
            &self.base_frame,
            (&perceived.tracks, perceived.ego),
        );
        self.addressed(topics, |kind| match kind {
            TopicKind::Detections2d => Message::Detections2d(detections::detections_2d(
                &seen,
                &perceived.unlocated,
                camera,
            )),
            TopicKind::CameraInfo => {
                Message::CameraInfo(Box::new(calibration::camera_info(camera, seen.stamp)))
            }
            shared => of_objects(shared, &seen),
        })
    }

    fn of_scene(&self, scene: &Scene, topics: Vec<usize>) -> Vec<Outgoing> {
        if topics.is_empty() {
            return Vec::new();
        }
        let seen = SeenTogether::in_scene(&self.rig, &self.scene_frame(scene), scene);
        self.addressed(topics, |kind| of_objects(kind, &seen))
    }

    /// Base_link, or odom where that is asked for.
    fn scene_frame(&self, scene: &Scene) -> PublishedIn<'_> {
        match &self.scene_in_odom {
            Some(odom_frame) => PublishedIn {
                name: odom_frame,
                from_base: scene.ego.odom_from_base.isometry,
            },
            None => PublishedIn {
                name: &self.base_frame,
                from_base: Isometry3::identity(),
            },
        }
    }

    fn addressed(
        &self,
        topics: Vec<usize>,
        message: impl Fn(TopicKind) -> Message,
    ) -> Vec<Outgoing> {
        let addressed = |topic: usize| Outgoing {
            topic,
            message: message(self.topics()[topic].kind),
        };
        topics.into_iter().map(addressed).collect()
    }
}

/// What cameras and the scene have in common.
fn of_objects(kind: TopicKind, seen: &SeenTogether<'_>) -> Message {
    match kind {
        TopicKind::Detections3d => Message::Detections3d(detections::detections_3d(seen)),
        TopicKind::Markers => Message::Markers(markers::markers(seen)),
        TopicKind::DetectedObjects => Message::DetectedObjects(autoware::detected_objects(seen)),
        TopicKind::TrackedObjects => Message::TrackedObjects(autoware::tracked_objects(seen)),
        _ => Message::Objects(objects::objects(seen)),
    }
}

#[cfg(test)]
mod tests;
