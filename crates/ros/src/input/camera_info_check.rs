//! Whether a `CameraInfo` says of a camera what the rig says.

use crate::msg::sensor_msgs::CameraInfo;
use roadwatch_core::RigCamera;

/// Two calibrations of one lens differ by less; another lens, or another zoom, by more.
const FOCAL_TOLERANCE: f64 = 0.02;
/// The same for the principal point, as a share of the image's width.
const CENTRE_TOLERANCE: f64 = 0.02;

/// Why `info` cannot be this camera's; `None` where the two agree, or `info` is not calibrated (its `k` is zero).
pub(super) fn contradiction(info: &CameraInfo, camera: &RigCamera) -> Option<String> {
    let (size, lens) = (camera.model.size, &camera.model.intrinsics);
    if (info.width, info.height) != (size.width_px, size.height_px) {
        return Some(format!(
            "images of {}x{}, the rig says {size}",
            info.width, info.height
        ));
    }
    let [fx, _, cx, _, fy, cy, ..] = info.k;
    if fx == 0.0 {
        return None;
    }
    for (name, found, expected) in [("fx", fx, lens.fx), ("fy", fy, lens.fy)] {
        if !agree(found / expected - 1.0, FOCAL_TOLERANCE) {
            return Some(format!(
                "{name} is {found:.1} pixels, the rig says {expected:.1}"
            ));
        }
    }
    let tolerance = CENTRE_TOLERANCE * f64::from(size.width_px);
    for (name, found, expected) in [("cx", cx, lens.cx), ("cy", cy, lens.cy)] {
        if !agree(found - expected, tolerance) {
            return Some(format!(
                "{name} is {found:.1} pixels, the rig says {expected:.1}"
            ));
        }
    }
    None
}

/// Not a number is no agreement.
fn agree(difference: f64, tolerance: f64) -> bool {
    difference.abs() <= tolerance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{convert::camera_info, testing};
    use roadwatch_core::{CameraId, Timestamp};

    #[test]
    fn the_rigs_own_calibration_agrees_and_another_lens_does_not() {
        let rig = testing::two_cameras();
        let camera = rig.camera(CameraId(0));
        let good = camera_info(camera, Timestamp::from_nanos(1));
        assert_eq!(contradiction(&good, camera), None);
        let changed = |change: fn(&mut CameraInfo)| {
            let mut info = good.clone();
            change(&mut info);
            contradiction(&info, camera)
        };
        assert_eq!(changed(|info| info.k = [0.0; 9]), None, "not calibrated");
        assert_eq!(changed(|info| info.k[0] *= 1.01), None);
        for change in [
            (|info| info.k[0] *= 1.05) as fn(&mut CameraInfo),
            |info| info.k[4] = f64::NAN,
            |info| info.k[2] += 100.0,
            |info| info.width += 1,
        ] {
            let what = changed(change).expect("another camera");
            assert!(what.contains("the rig says"), "{what}");
        }
    }
}
