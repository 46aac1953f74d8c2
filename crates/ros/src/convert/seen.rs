//! What one output says, in one shape for a camera's frame and for the scene, in the frame that it is published in.

use crate::msg::std_msgs::Header;
use nalgebra::{Isometry3, Matrix2, Matrix3, Point3, Rotation2, Vector2, Vector3};
use roadwatch_core::{
    CameraId, Ego, Heading, Motion, PerFrame, Phase, Rig, Scene, SceneObject, Timestamp, Track,
    angle::wrapped,
};

/// One object with its own stamp.
pub(crate) struct Seen<'a> {
    /// The moment its place is of.
    pub(crate) stamp: Timestamp,
    /// Capture time of the newest frame it was seen in.
    pub(crate) seen_at: Timestamp,
    /// Who, what, where.
    pub(crate) track: &'a Track,
    /// Names of the cameras that saw it.
    pub(crate) seen_by: Vec<&'a str>,
    /// From the first of them to it: along the optical axis, and over the ground, metres.
    pub(crate) depth_range_m: (f64, f64),
    /// Where and how.
    pub(crate) placed: Placed,
    /// Where it was before, oldest first.
    pub(crate) trail: Vec<Point3<f64>>,
}

/// Where an object is and how it moves, along the axes of the frame that it is published in.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) position: Point3<f64>,
    pub(crate) covariance: Matrix3<f64>,
    pub(crate) heading: Option<Heading>,
    /// `None` without tracking.
    pub(crate) moves: Option<Moves>,
}

/// How an object moves over x and y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moves {
    pub(crate) velocity: (Vector2<f64>, Matrix2<f64>),
    pub(crate) acceleration: (Vector2<f64>, Matrix2<f64>),
}

/// The frame that positions are published in.
pub(crate) struct PublishedIn<'a> {
    /// Its name.
    pub(crate) name: &'a str,
    /// Where base_link is in it.
    pub(crate) from_base: Isometry3<f64>,
}

/// The objects of one output.
pub(crate) struct SeenTogether<'a> {
    /// Name of the camera; empty for the scene.
    pub(crate) camera: &'a str,
    /// Frame of all positions.
    pub(crate) frame: &'a str,
    /// Capture time; of a scene the newest.
    pub(crate) stamp: Timestamp,
    /// Where the vehicle is.
    pub(crate) ego: Ego,
    /// In the output's order.
    pub(crate) objects: Vec<Seen<'a>>,
}

impl Placed {
    fn new(track: &Track, from_base: &Isometry3<f64>) -> Self {
        let turn = from_base.rotation.to_rotation_matrix();
        let forward = from_base.rotation * Vector3::x();
        let yaw_rad = forward.y.atan2(forward.x);
        let flat = Rotation2::new(yaw_rad);
        let turned = |(vector, matrix): (Vector2<f64>, Matrix2<f64>)| {
            let matrix = flat.matrix() * matrix * flat.matrix().transpose();
            (flat * vector, matrix)
        };
        let moves = |motion: &Motion| Moves {
            velocity: turned((motion.velocity_m_s, motion.velocity_covariance)),
            acceleration: turned((motion.acceleration_m_s2, motion.acceleration_covariance)),
        };
        Self {
            position: from_base * track.position().coords,
            covariance: turn * track.covariance().matrix * turn.transpose(),
            heading: track.heading().map(|heading| Heading {
                yaw_rad: wrapped(heading.yaw_rad + yaw_rad),
                ..heading
            }),
            moves: track.motion.as_ref().map(moves),
        }
    }
}

impl Seen<'_> {
    /// Whether nothing of this moment shows it.
    pub(crate) fn is_predicted(&self) -> bool {
        let motion = self.track.motion.as_ref();
        motion.is_some_and(|motion| motion.phase == Phase::Coasting)
            || self.track.observed.located.location.held
    }
}

impl<'a> SeenTogether<'a> {
    /// The objects of one frame.
    pub(crate) fn in_camera(
        rig: &'a Rig,
        base_frame: &'a str,
        (tracks, ego): (&'a PerFrame<Track>, Ego),
    ) -> Self {
        let frame = &tracks.frame;
        let camera = rig.camera(frame.camera).name.as_str();
        let base = Isometry3::identity();
        let seen = |track| Seen {
            stamp: frame.captured_at,
            seen_at: frame.captured_at,
            track,
            seen_by: vec![camera],
            depth_range_m: depth_range_m(rig, Some(&frame.camera), track),
            placed: Placed::new(track, &base),
            trail: Vec::new(),
        };
        Self {
            camera,
            frame: base_frame,
            stamp: frame.captured_at,
            ego,
            objects: tracks.items.iter().map(seen).collect(),
        }
    }

    /// The objects of a rig round.
    pub(crate) fn in_scene(rig: &'a Rig, frame: &PublishedIn<'a>, scene: &'a Scene) -> Self {
        let name = |&id| rig.camera(id).name.as_str();
        let seen = |object: &'a SceneObject| Seen {
            stamp: object.stamp,
            seen_at: object.seen_at,
            track: &object.track,
            seen_by: object.seen_by.iter().map(name).collect(),
            depth_range_m: depth_range_m(rig, object.seen_by.first(), &object.track),
            placed: Placed::new(&object.track, &frame.from_base),
            trail: object
                .trail
                .iter()
                .map(|point| frame.from_base * point.coords)
                .collect(),
        };
        Self {
            camera: "",
            frame: frame.name,
            stamp: scene.stamp,
            ego: scene.ego,
            objects: scene.objects.iter().map(seen).collect(),
        }
    }

    /// Header of the whole message.
    pub(crate) fn header(&self) -> Header {
        Header::new(self.stamp, self.frame)
    }

    /// Header of one object.
    pub(crate) fn header_of(&self, seen: &Seen) -> Header {
        Header::new(seen.stamp, self.frame)
    }
}

fn depth_range_m(rig: &Rig, camera: Option<&CameraId>, track: &Track) -> (f64, f64) {
    let location = &track.observed.located.location;
    match (camera, &track.motion) {
        (Some(&camera), Some(motion)) => {
            let camera = rig.camera(camera);
            (
                camera.depth_m(motion.position),
                camera.range_m(motion.position),
            )
        }
        _ => (location.depth_m, location.range_m),
    }
}
