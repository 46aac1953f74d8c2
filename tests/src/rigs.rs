//! Rigs to look with.

use roadwatch_core::{
    CameraModel, CameraName, Distortion, ImageSize, Intrinsics, MeasuredFocal, Mount, Rig,
    RigCamera,
};

/// Every camera's image.
const IMAGE: ImageSize = ImageSize {
    width_px: 960,
    height_px: 540,
};
/// A lens of 52 degrees.
const NARROW_PX: f64 = 985.0;
/// A lens of 92 degrees.
const WIDE_PX: f64 = 465.0;
/// How far cameras look down, degrees.
const PITCH_DEG: f64 = 1.0;

/// One camera that looks ahead, 2.2 m above the ground.
///
/// # Panics
/// Never: the rig is a fixed one.
#[must_use]
pub fn one_camera() -> Rig {
    let front = camera("front", NARROW_PX, [0.85, 0.0, 2.2], 0.0);
    Rig::new(vec![front], 0.0).expect("one camera is a rig")
}

/// Six cameras around a vehicle whose origin is 0.35 m above the ground.
///
/// # Panics
/// Never: the rig is a fixed one.
#[must_use]
pub fn six_cameras() -> Rig {
    let cameras = vec![
        camera("front_left", WIDE_PX, [1.5, 0.6, 1.55], 60.0),
        camera("front", NARROW_PX, [1.8, 0.0, 1.6], 0.0),
        camera("front_right", WIDE_PX, [1.5, -0.6, 1.55], -60.0),
        camera("right", WIDE_PX, [0.5, -0.7, 1.55], -120.0),
        camera("back", WIDE_PX, [-0.5, 0.0, 1.6], 180.0),
        camera("left", WIDE_PX, [0.5, 0.7, 1.55], 120.0),
    ];
    Rig::new(cameras, -0.35).expect("six cameras are a rig")
}

fn camera(name: &str, focal_px: f64, position_m: [f64; 3], azimuth_deg: f64) -> RigCamera {
    let mount = Mount {
        yaw_rad: azimuth_deg.to_radians(),
        pitch_rad: PITCH_DEG.to_radians(),
        ..Mount::ahead(position_m)
    };
    RigCamera {
        name: CameraName::new(name).expect("a legal name"),
        model: CameraModel {
            size: IMAGE,
            intrinsics: Intrinsics {
                fx: focal_px,
                fy: focal_px,
                cx: 482.0,
                cy: 262.0,
            },
            distortion: Distortion::None,
        },
        base_from_optical: mount.base_from_optical(),
        measured_focal: Some(MeasuredFocal {
            focal_px,
            image_height_px: IMAGE.height_px,
        }),
    }
}
