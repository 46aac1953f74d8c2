//! A made-up rig of two cameras and what they see, for the tests of this crate.

use nalgebra::Matrix3;
use roadwatch_core::{
    BoxPx, CameraId, CameraModel, CameraName, Detection, Distortion, Ego, Frame, Heading,
    HeadingCandidates, Image, ImageSize, Intrinsics, KeptHeading, Located, Location, Method, Mount,
    ObjectClass, Oriented, Output, PerFrame, Perceived, Pixels, Rig, RigCamera, Scene, SceneObject,
    Score, SizeLwh, SlopeEvidence, Timestamp, Track, TrackId,
    space::{Covariance, Point},
};
use std::{
    f64::consts::PI,
    sync::Arc,
    time::{Duration, Instant},
};

/// 0.1 s, between two frames of a camera.
pub(crate) const INTERVAL_NS: i64 = 100_000_000;
/// 1557539956.439383 s, a stamp that `f64` seconds cannot hold.
pub(crate) const START_NS: i64 = 1_557_539_956_439_383_000;

/// `front` looks forward through a plumb-bob lens, `rear` backward through none; both 1.5 m up.
pub(crate) fn two_cameras() -> Rig {
    let lens = Distortion::from_ros("plumb_bob", &[-0.1, 0.01, 0.0, 0.0, 0.0]).expect("known");
    let cameras = vec![
        camera("front", 0.0, 1.0, lens),
        camera("rear", PI, -1.0, Distortion::None),
    ];
    Rig::new(cameras, 0.0).expect("two names")
}

pub(crate) fn camera(name: &str, yaw_rad: f64, x_m: f64, distortion: Distortion) -> RigCamera {
    let mount = Mount {
        yaw_rad,
        ..Mount::ahead([x_m, 0.0, 1.5])
    };
    RigCamera {
        name: CameraName::new(name).expect("a token"),
        model: CameraModel {
            size: ImageSize {
                width_px: 960,
                height_px: 540,
            },
            intrinsics: Intrinsics {
                fx: 465.0,
                fy: 466.0,
                cx: 480.5,
                cy: 270.25,
            },
            distortion,
        },
        base_from_optical: mount.base_from_optical(),
        measured_focal: None,
    }
}

/// The outputs of rig round `round`: `front` sees a car without and a person with a heading, and a boat
/// that has no place; `rear`
/// fires a millisecond later and sees nothing, then the scene.
pub(crate) fn outputs(round: i64) -> Vec<Output> {
    let front_at = Timestamp::from_nanos(START_NS + round * INTERVAL_NS);
    let rear_at = Timestamp::from_nanos(START_NS + round * INTERVAL_NS + 1_000_000);
    let tracks = vec![track(1, "car", None), track(2, "person", Some(0.5))];
    let objects = tracks.iter().cloned().map(|track| SceneObject {
        track,
        seen_by: vec![CameraId(0)],
        seen_at: front_at,
        stamp: front_at,
        trail: Vec::new(),
    });
    let scene = Scene {
        seq: round.unsigned_abs(),
        stamp: rear_at,
        ego: Ego::default(),
        objects: objects.collect(),
    };
    vec![
        of_camera(0, round, front_at, tracks.clone()),
        of_camera(1, round, rear_at, Vec::new()),
        Output::Scene(Arc::new(scene)),
    ]
}

pub(crate) fn of_camera(id: u8, round: i64, captured_at: Timestamp, items: Vec<Track>) -> Output {
    // What is seen at all comes with one detection that no method could locate.
    let unlocated: Vec<_> = items.iter().take(1).map(|_| detection("boat")).collect();
    let size = ImageSize {
        width_px: 1,
        height_px: 1,
    };
    let frame = Frame {
        camera: CameraId(id),
        seq: round.unsigned_abs(),
        captured_at,
        received_at: Instant::now(),
        image: Image::decoded(Pixels::new(size, vec![0; 3]).expect("one pixel")),
    };
    Output::Camera(Arc::new(Perceived {
        tracks: PerFrame { frame, items },
        unlocated,
        ego: Ego::default(),
    }))
}

fn detection(class: &str) -> Detection {
    Detection {
        class: ObjectClass::new(class),
        score: Score::new(0.75).expect("a share"),
        input_pixel_px: 1.0,
        box_px: BoxPx::new(100.0, 200.0, 180.0, 250.0).expect("an area"),
    }
}

pub(crate) fn track(id: u64, class: &str, yaw_rad: Option<f64>) -> Track {
    let location = Location {
        position: Point::new(20.0, 2.0 + id as f64, 0.75),
        covariance: Covariance::new(Matrix3::new(4.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.25)),
        depth_m: 19.0,
        range_m: 19.25,
        size: SizeLwh {
            length_m: 4.5,
            width_m: 1.8,
            height_m: 1.5,
        },
        method: Method::Ground,
        headings: HeadingCandidates::default(),
        ground: None,
        held: false,
    };
    Track {
        id: TrackId(id),
        observed: Oriented {
            located: Located {
                detection: detection(class),
                location,
                slopes: SlopeEvidence::default(),
            },
            heading: yaw_rad.map(|yaw_rad| KeptHeading {
                heading: Heading {
                    yaw_rad,
                    std_dev_rad: 0.1,
                    flip_probability: 0.0,
                },
                age: Duration::ZERO,
            }),
            components: Vec::new(),
        },
        motion: None,
    }
}
