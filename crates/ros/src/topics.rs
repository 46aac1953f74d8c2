//! The closed list of topics: everything that is published and recorded, in one place.

use crate::surface::Surface;
use roadwatch_core::{CameraId, Rig};
use std::ops::Range;

/// What a topic carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TopicKind {
    /// Everything that is known about each object.
    Objects,
    /// Boxes in the image.
    Detections2d,
    /// Boxes in space.
    Detections3d,
    /// Shapes for viewers.
    Markers,
    /// The camera's calibration.
    CameraInfo,
    /// Where the cameras sit.
    TfStatic,
    /// The objects as Autoware takes them.
    DetectedObjects,
    /// The tracked objects as Autoware takes them.
    TrackedObjects,
    /// The camera's images as they came; recorded on request, never published.
    Image,
}

/// Whether late joiners get the last message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retention {
    /// Only who listens gets it; the depth is the surface's `queue_depth`.
    Volatile,
    /// The last message waits for late joiners (transient local, depth 1).
    Latched,
}

/// One row of the table.
struct Row {
    suffix: &'static str,
    ros_type: &'static str,
    retention: Retention,
}

impl TopicKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Objects,
        Self::Detections2d,
        Self::Detections3d,
        Self::Markers,
        Self::CameraInfo,
        Self::TfStatic,
        Self::DetectedObjects,
        Self::TrackedObjects,
        Self::Image,
    ];

    /// What each camera has, in order of publishing.
    pub const PER_CAMERA: [Self; 5] = [
        Self::Objects,
        Self::Detections2d,
        Self::Detections3d,
        Self::Markers,
        Self::CameraInfo,
    ];

    /// What the scene has, in order of publishing.
    pub const PER_SCENE: [Self; 3] = [Self::Objects, Self::Detections3d, Self::Markers];

    /// The table. All topics are reliable, which matches every reader (REP-2003).
    const fn row(self) -> Row {
        use Retention::{Latched, Volatile};
        let (suffix, ros_type, retention) = match self {
            Self::Objects => ("objects", "roadwatch_msgs/ObjectArray", Volatile),
            Self::Detections2d => ("detections_2d", "vision_msgs/Detection2DArray", Volatile),
            Self::Detections3d => ("detections_3d", "vision_msgs/Detection3DArray", Volatile),
            Self::Markers => ("markers", "visualization_msgs/MarkerArray", Volatile),
            Self::CameraInfo => ("camera_info", "sensor_msgs/CameraInfo", Volatile),
            Self::TfStatic => ("tf_static", "tf2_msgs/TFMessage", Latched),
            Self::DetectedObjects => (
                "detected_objects",
                "autoware_perception_msgs/DetectedObjects",
                Volatile,
            ),
            Self::TrackedObjects => (
                "tracked_objects",
                "autoware_perception_msgs/TrackedObjects",
                Volatile,
            ),
            Self::Image => ("image/compressed", "sensor_msgs/CompressedImage", Volatile),
        };
        Row {
            suffix,
            ros_type,
            retention,
        }
    }

    /// Last part of the topic's name.
    #[must_use]
    pub const fn suffix(self) -> &'static str {
        self.row().suffix
    }

    /// `package/Type`.
    #[must_use]
    pub const fn ros_type(self) -> &'static str {
        self.row().ros_type
    }

    /// Whether late joiners get the last message.
    #[must_use]
    pub const fn retention(self) -> Retention {
        self.row().retention
    }
}

/// One topic of the node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// Absolute name.
    pub name: String,
    /// What it carries.
    pub kind: TopicKind,
    /// Messages kept.
    pub depth: usize,
}

/// All topics of a rig: `/tf_static`, then each camera's, then the scene's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topics {
    list: Vec<Topic>,
    cameras: usize,
}

impl Topics {
    /// Place of `/tf_static` in the list.
    pub const TF_STATIC: usize = 0;

    /// The topics of `rig` under the node of `surface`.
    #[must_use]
    pub fn new(rig: &Rig, surface: &Surface) -> Self {
        let below = |owner: &str, kind: TopicKind| Topic {
            name: surface.topic(&format!("~/{owner}/{}", kind.suffix())),
            kind,
            depth: surface.queue_depth,
        };
        let mut list = vec![Topic {
            name: surface.topic(&format!("/{}", TopicKind::TfStatic.suffix())),
            kind: TopicKind::TfStatic,
            depth: 1,
        }];
        for camera in rig.cameras() {
            list.extend(TopicKind::PER_CAMERA.map(|kind| below(camera.name.as_str(), kind)));
        }
        list.extend(TopicKind::PER_SCENE.map(|kind| below("scene", kind)));
        if surface.autoware {
            list.push(below("scene", TopicKind::DetectedObjects));
            list.push(below("scene", TopicKind::TrackedObjects));
        }
        Self {
            list,
            cameras: rig.cameras().len(),
        }
    }

    /// The topics of the images as they came, one per camera: recorded, not published, so not in the list.
    #[must_use]
    pub fn of_images(rig: &Rig, surface: &Surface) -> Vec<Topic> {
        let kind = TopicKind::Image;
        let cameras = rig.cameras().iter();
        cameras
            .map(|camera| Topic {
                name: surface.topic(&format!("~/{}/{}", camera.name, kind.suffix())),
                kind,
                depth: surface.queue_depth,
            })
            .collect()
    }

    /// The topics, in the order of their places.
    #[must_use]
    pub fn list(&self) -> &[Topic] {
        &self.list
    }

    /// The places of a camera's topics, in the order of [`TopicKind::PER_CAMERA`].
    #[must_use]
    pub fn of_camera(&self, camera: CameraId) -> Range<usize> {
        let count = TopicKind::PER_CAMERA.len();
        let first = Self::TF_STATIC + 1 + camera.index() * count;
        first..first + count
    }

    /// The places of the scene's topics, in the order of [`TopicKind::PER_SCENE`]; Autoware's last, if it is there.
    #[must_use]
    pub fn of_scene(&self) -> Range<usize> {
        let first = Self::TF_STATIC + 1 + self.cameras * TopicKind::PER_CAMERA.len();
        first..self.list.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn places_and_names_agree() {
        let rig = testing::two_cameras();
        let topics = Topics::new(&rig, &Surface::default());
        let names = |range: Range<usize>| -> Vec<&str> {
            topics.list()[range]
                .iter()
                .map(|t| t.name.as_str())
                .collect()
        };
        assert_eq!(topics.list()[Topics::TF_STATIC].name, "/tf_static");
        assert_eq!(
            names(topics.of_camera(CameraId(1))),
            [
                "/roadwatch/rear/objects",
                "/roadwatch/rear/detections_2d",
                "/roadwatch/rear/detections_3d",
                "/roadwatch/rear/markers",
                "/roadwatch/rear/camera_info",
            ]
        );
        assert_eq!(
            names(topics.of_scene()),
            [
                "/roadwatch/scene/objects",
                "/roadwatch/scene/detections_3d",
                "/roadwatch/scene/markers",
            ]
        );
        assert_eq!(topics.of_scene().end, topics.list().len());
    }
}
