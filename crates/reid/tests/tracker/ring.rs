//! Six cameras in a ring, and what they would see of objects on the ground: exact places, exact boxes.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use roadwatch_core::{
    BoxPx, CameraId, CameraModel, CameraName, Detection, Distortion, Ego, Frame, Heading,
    HeadingCandidates, Image, ImageSize, Intrinsics, KeptHeading, Located, Location, Method, Mount,
    ObjectClass, Oriented, PerFrame, Pixels, Rig, RigCamera, Score, SizeLwh, SlopeEvidence,
    Timestamp,
    camera_model::Pixel,
    space::{Covariance, Point},
};
use std::{
    f64::consts::TAU,
    time::{Duration, Instant},
};

/// As cars are expected to be.
pub(crate) const CAR: SizeLwh = SizeLwh {
    length_m: 4.6,
    width_m: 1.85,
    height_m: 1.6,
};

/// `cameras` of 92 degrees, looking in directions evenly apart, the first ahead.
pub(crate) fn ring(cameras: u8) -> Rig {
    let camera = |at: u8| {
        let mount = Mount {
            yaw_rad: TAU * f64::from(at) / f64::from(cameras),
            ..Mount::ahead([0.0, 0.0, 1.6])
        };
        RigCamera {
            name: CameraName::new(&format!("camera_{at}")).expect("a token"),
            model: CameraModel {
                size: ImageSize {
                    width_px: 960,
                    height_px: 540,
                },
                intrinsics: Intrinsics {
                    fx: 465.0,
                    fy: 465.0,
                    cx: 479.5,
                    cy: 269.5,
                },
                distortion: Distortion::None,
            },
            base_from_optical: mount.base_from_optical(),
            measured_focal: None,
        }
    };
    Rig::new((0..cameras).map(camera).collect(), 0.0).expect("a rig")
}

pub(crate) fn at(millis: i64) -> Timestamp {
    Timestamp::from_nanos(1_000_000_000 + millis * 1_000_000)
}

pub(crate) fn frame(camera: u8, at: Timestamp) -> Frame {
    let size = ImageSize {
        width_px: 1,
        height_px: 1,
    };
    Frame {
        camera: CameraId(camera),
        seq: 0,
        captured_at: at,
        received_at: Instant::now(),
        image: Image::decoded(Pixels::new(size, vec![0; 3]).expect("a pixel")),
    }
}

/// What a camera sees of cars at these places of the steady frame, and where it says they are.
pub(crate) fn seen(
    rig: &Rig,
    camera: u8,
    stamp: Timestamp,
    (ego, places): (&Ego, &[(f64, f64)]),
) -> PerFrame<Oriented> {
    let base_from_steady = ego.steady_from_base.isometry.inverse();
    let rig_camera = rig.camera(CameraId(camera));
    let items = places.iter().filter_map(|&(x, y)| {
        let center = base_from_steady * Point3::new(x, y, CAR.height_m / 2.0);
        let box_px = box_of(rig_camera, center)?;
        Some(oriented(rig_camera, center, box_px))
    });
    PerFrame {
        items: items.collect(),
        frame: frame(camera, stamp),
    }
}

/// Around an upright square as wide as a car is, on the whole; `None` where part of it is outside the image.
fn box_of(camera: &RigCamera, center: Point3<f64>) -> Option<BoxPx> {
    let to_optical = camera.base_from_optical.inverse();
    let (mut least, mut most) = (Pixel::repeat(f64::MAX), Pixel::repeat(f64::MIN));
    for corner in 0..8_u8 {
        let side = |bit: u8| if corner >> bit & 1 == 1 { 0.5 } else { -0.5 };
        let offset = Vector3::new(side(0) * 3.0, side(1) * 3.0, side(2) * CAR.height_m);
        let corner = to_optical * Point::from_coords(center + offset);
        let pixel = camera.model.project(corner)?;
        (least, most) = (least.inf(&pixel), most.sup(&pixel));
    }
    let inside = least.x > 0.0 && least.y > 0.0 && most.x < 959.0 && most.y < 539.0;
    BoxPx::between(least, most).filter(|_| inside)
}

fn oriented(camera: &RigCamera, center: Point3<f64>, box_px: BoxPx) -> Oriented {
    let position = Point::from_coords(center);
    let range_m = camera.range_m(position);
    let std_dev_m = 0.2 + 0.05 * range_m;
    Oriented {
        located: Located {
            detection: Detection {
                class: ObjectClass::new("car"),
                score: Score::new(0.8).expect("a share"),
                input_pixel_px: 1.0,
                box_px,
            },
            location: Location {
                position,
                covariance: Covariance::new(Matrix3::identity() * std_dev_m.powi(2)),
                depth_m: camera.depth_m(position),
                range_m,
                size: CAR,
                method: Method::Fused,
                headings: HeadingCandidates::default(),
                ground: None,
                held: false,
            },
            slopes: SlopeEvidence::default(),
        },
        heading: None,
        components: Vec::new(),
    }
}

/// As a look at the parts would give it.
pub(crate) fn heading(yaw_rad: f64, flip_probability: f64) -> Option<KeptHeading> {
    Some(KeptHeading {
        heading: Heading {
            yaw_rad,
            std_dev_rad: 0.1,
            flip_probability,
        },
        age: Duration::ZERO,
    })
}

/// The vehicle at a place, as measured by odometry that began at the origin.
pub(crate) fn ego(x_m: f64, yaw_rad: f64) -> Ego {
    let pose = Isometry3::new(Vector3::new(x_m, 0.0, 0.0), Vector3::z() * yaw_rad);
    Ego {
        steady_from_base: roadwatch_core::space::Transform::new(pose),
        odom_from_base: roadwatch_core::space::Transform::new(pose),
        knowledge: roadwatch_core::EgoKnowledge::Measured,
    }
}
