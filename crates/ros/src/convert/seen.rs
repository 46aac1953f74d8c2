//! What one output says, in one shape for a camera's frame and for the scene.

use crate::msg::std_msgs::Header;
use roadwatch_core::{PerFrame, Rig, Scene, Timestamp, Track};

/// One object with its own stamp.
pub(crate) struct Seen<'a> {
    /// Capture time of the frame it was seen in.
    pub(crate) stamp: Timestamp,
    /// Who, what, where.
    pub(crate) track: &'a Track,
    /// Names of the cameras that saw it.
    pub(crate) seen_by: Vec<&'a str>,
}

/// The objects of one output.
pub(crate) struct SeenTogether<'a> {
    /// Name of the camera; empty for the scene.
    pub(crate) camera: &'a str,
    /// Frame of all positions.
    pub(crate) base_frame: &'a str,
    /// Capture time; of a scene the newest.
    pub(crate) stamp: Timestamp,
    /// In the output's order.
    pub(crate) objects: Vec<Seen<'a>>,
}

impl<'a> SeenTogether<'a> {
    /// The objects of one frame.
    pub(crate) fn in_camera(
        rig: &'a Rig,
        base_frame: &'a str,
        tracks: &'a PerFrame<Track>,
    ) -> Self {
        let frame = &tracks.frame;
        let camera = rig.camera(frame.camera).name.as_str();
        let seen = |track| Seen {
            stamp: frame.captured_at,
            track,
            seen_by: vec![camera],
        };
        Self {
            camera,
            base_frame,
            stamp: frame.captured_at,
            objects: tracks.items.iter().map(seen).collect(),
        }
    }

    /// The objects of a rig round.
    pub(crate) fn in_scene(rig: &'a Rig, base_frame: &'a str, scene: &'a Scene) -> Self {
        let name = |&id| rig.camera(id).name.as_str();
        let objects = scene
            .objects
            .iter()
            .map(|object| Seen {
                stamp: object.seen_at,
                track: &object.track,
                seen_by: object.seen_by.iter().map(name).collect(),
            })
            .collect();
        Self {
            camera: "",
            base_frame,
            stamp: scene.stamp,
            objects,
        }
    }

    /// Header of the whole message.
    pub(crate) fn header(&self) -> Header {
        Header::new(self.stamp, self.base_frame)
    }

    /// Header of one object.
    pub(crate) fn header_of(&self, seen: &Seen) -> Header {
        Header::new(seen.stamp, self.base_frame)
    }
}
