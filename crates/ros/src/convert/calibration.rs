//! What does not change while driving: how cameras see and where they sit.

use crate::msg::{
    geometry_msgs::TransformStamped, sensor_msgs::CameraInfo, std_msgs::Header, tf2_msgs::TFMessage,
};
use roadwatch_core::{Rig, RigCamera, Timestamp};

/// The camera's calibration. Images are published as they come, so nothing is rectified: `r` is no
/// rotation and `p` repeats `k`.
pub(crate) fn camera_info(camera: &RigCamera, stamp: Timestamp) -> CameraInfo {
    let model = &camera.model;
    let lens = &model.intrinsics;
    let (distortion_model, d) = model.distortion.to_ros();
    let (fx, fy, cx, cy) = (lens.fx, lens.fy, lens.cx, lens.cy);
    CameraInfo {
        header: Header::new(stamp, camera.name.optical_frame()),
        height: model.size.height_px,
        width: model.size.width_px,
        distortion_model: distortion_model.to_owned(),
        d,
        k: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
        ..CameraInfo::default()
    }
}

/// The base frame to every camera's optical frame.
pub(crate) fn tf_static(rig: &Rig, base_frame: &str, stamp: Timestamp) -> TFMessage {
    let transform = |camera: &RigCamera| TransformStamped {
        header: Header::new(stamp, base_frame),
        child_frame_id: camera.name.optical_frame(),
        transform: (&camera.base_from_optical.isometry).into(),
    };
    TFMessage {
        transforms: rig.cameras().iter().map(transform).collect(),
    }
}
