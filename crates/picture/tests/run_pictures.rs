//! Pictures of a small rig: boxes lie where the camera sees them, and the fullest round is drawn.

use nalgebra::Matrix3;
use roadwatch_core::{
    BoxPx, CameraId, CameraModel, CameraName, Detection, Distortion, Ego, Frame, HeadingCandidates,
    Image, ImageSize, Intrinsics, Located, Location, Method, Mount, ObjectClass, Oriented, Output,
    PerFrame, Perceived, Pixels, Rig, RigCamera, Scene, SceneObject, Score, Sink, SizeLwh,
    SlopeEvidence, Timestamp, Track, TrackId,
    space::{Covariance, Point},
};
use roadwatch_picture::{Canvas, PictureSink, SCENE_FILE, VIEWS_FILE, camera_view};
use std::{fs, sync::Arc, time::Instant};

const SIZE: ImageSize = ImageSize {
    width_px: 320,
    height_px: 180,
};

/// Looks ahead from 1.5 m above the ground.
fn camera() -> RigCamera {
    RigCamera {
        name: CameraName::new("front").expect("a name"),
        model: CameraModel {
            size: SIZE,
            intrinsics: Intrinsics {
                fx: 200.0,
                fy: 200.0,
                cx: 159.5,
                cy: 89.5,
            },
            distortion: Distortion::None,
        },
        base_from_optical: Mount::ahead([0.0, 0.0, 1.5]).base_from_optical(),
        measured_focal: None,
    }
}

/// A car straight ahead.
fn car(ahead_m: f64) -> Track {
    let located = Located {
        detection: Detection {
            class: ObjectClass::new("car"),
            score: Score::new(0.9).expect("a score"),
            input_pixel_px: 1.0,
            box_px: BoxPx::new(140.0, 80.0, 180.0, 120.0).expect("a box"),
        },
        location: Location {
            position: Point::new(ahead_m, 0.0, 0.75),
            covariance: Covariance::new(Matrix3::identity()),
            depth_m: ahead_m,
            range_m: ahead_m,
            size: SizeLwh {
                length_m: 4.0,
                width_m: 2.0,
                height_m: 1.5,
            },
            method: Method::Table,
            headings: HeadingCandidates::default(),
            ground: None,
            held: false,
        },
        slopes: SlopeEvidence::default(),
    };
    Track {
        id: TrackId(7),
        observed: Oriented {
            located,
            heading: None,
            components: Vec::new(),
        },
        motion: None,
    }
}

fn perceived(tracks: Vec<Track>) -> Arc<Perceived> {
    let pixels = Pixels::new(SIZE, vec![0; 320 * 180 * 3]).expect("pixels");
    Arc::new(Perceived {
        tracks: PerFrame {
            frame: Frame {
                camera: CameraId(0),
                seq: 0,
                captured_at: Timestamp::from_nanos(0),
                received_at: Instant::now(),
                image: Image::decoded(pixels),
            },
            items: tracks,
        },
        unlocated: Vec::new(),
        ego: Ego::default(),
    })
}

fn scene(seq: u64, tracks: &[Track]) -> Output {
    let objects = tracks.iter().map(|track| SceneObject {
        track: track.clone(),
        seen_by: vec![CameraId(0)],
        seen_at: Timestamp::from_nanos(0),
        stamp: Timestamp::from_nanos(0),
        trail: Vec::new(),
    });
    Output::Scene(Arc::new(Scene {
        seq,
        stamp: Timestamp::from_nanos(0),
        ego: Ego::default(),
        objects: objects.collect(),
    }))
}

fn is_drawn(view: &Canvas, x: f64, y: f64) -> bool {
    let pixels = view.pixels().expect("pixels");
    let at = (y.round() as usize * SIZE.width_px as usize + x.round() as usize) * 3;
    pixels.bgr()[at..at + 3].iter().any(|&value| value > 60)
}

#[test]
fn the_corners_of_a_box_are_drawn_where_the_camera_sees_them() {
    let view = camera_view(&camera(), &perceived(vec![car(12.0)])).expect("drawn");
    // Rear face of the car: 10 m ahead, 1 m to each side, from the ground to 1.5 m: f = 200 px.
    for (x, y) in [(139.5, 89.5 + 30.0), (179.5, 89.5 + 30.0)] {
        assert!(is_drawn(&view, x, y), "({x}, {y})");
    }
    assert!(!is_drawn(&view, 20.0, 150.0));
}

#[test]
fn a_box_that_reaches_behind_the_camera_is_cut() {
    let view = camera_view(&camera(), &perceived(vec![car(1.0)])).expect("drawn");
    assert_eq!(view.size(), SIZE);
}

#[test]
fn the_fullest_round_is_drawn_when_the_run_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let rig = Arc::new(Rig::new(vec![camera()], 0.0).expect("a rig"));
    let pictures = folder.path().join("pictures");
    let mut sink = PictureSink::create(&pictures, rig).expect("a sink");
    for (seq, cars) in [
        (0, vec![car(9.0)]),
        (1, vec![car(9.0), car(20.0)]),
        (2, vec![]),
    ] {
        sink.publish(&Output::Camera(perceived(cars.clone())))
            .expect("kept");
        sink.publish(&scene(seq, &cars)).expect("kept");
    }
    sink.finish().expect("drawn");
    for file in [VIEWS_FILE, SCENE_FILE] {
        let size = fs::metadata(pictures.join(file)).expect("written").len();
        assert!(size > 1000, "{file}: {size} bytes");
    }
}

#[test]
fn a_run_without_a_round_draws_nothing_and_does_not_fail() {
    let folder = tempfile::tempdir().expect("a folder");
    let rig = Arc::new(Rig::new(vec![camera()], 0.0).expect("a rig"));
    let mut sink = PictureSink::create(folder.path(), rig).expect("a sink");
    sink.finish().expect("nothing to do");
    assert!(!folder.path().join(VIEWS_FILE).exists());
}
