//! How a camera is mounted, in the terms people measure it in.

use crate::space::{BaseLink, Optical, Transform};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};

/// Where a camera sits and where it looks, in base_link: turned by roll, then pitch, then yaw (REP-103), from
/// a camera that looks along x with its image's x axis level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// Position of the optical centre, metres.
    pub position_m: [f64; 3],
    /// About z, counter-clockwise: 0 looks ahead, a quarter turn to the left, radians.
    pub yaw_rad: f64,
    /// About y, radians; positive looks down.
    pub pitch_rad: f64,
    /// About x, radians; positive tips the camera's right side down.
    pub roll_rad: f64,
}

impl Mount {
    /// A level camera that looks ahead.
    #[must_use]
    pub fn ahead(position_m: [f64; 3]) -> Self {
        Self {
            position_m,
            yaw_rad: 0.0,
            pitch_rad: 0.0,
            roll_rad: 0.0,
        }
    }

    /// The mount of a camera at that pose. At a pitch of a quarter turn roll and yaw are one; roll is then 0.
    #[must_use]
    pub fn of(base_from_optical: &Transform<BaseLink, Optical>) -> Self {
        let isometry = &base_from_optical.isometry;
        let turned = isometry.rotation.to_rotation_matrix() * body_from_optical().inverse();
        let (roll_rad, pitch_rad, yaw_rad) = turned.euler_angles();
        let position = isometry.translation.vector;
        Self {
            position_m: [position.x, position.y, position.z],
            yaw_rad,
            pitch_rad,
            roll_rad,
        }
    }

    /// The camera's pose in base_link.
    #[must_use]
    pub fn base_from_optical(&self) -> Transform<BaseLink, Optical> {
        let turned = Rotation3::from_euler_angles(self.roll_rad, self.pitch_rad, self.yaw_rad);
        Transform::new(Isometry3::from_parts(
            Translation3::from(self.position_m),
            UnitQuaternion::from_rotation_matrix(&(turned * body_from_optical())),
        ))
    }
}

/// Axes of a camera that looks ahead (REP-103): the optical x, y, z axes are the columns.
fn body_from_optical() -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::new(
        0.0, 0.0, 1.0, //
        -1.0, 0.0, 0.0, //
        0.0, -1.0, 0.0,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    #[test]
    fn a_camera_ahead_sees_its_right_to_the_right_and_the_ground_below() {
        let pose = Mount::ahead([1.0, 2.0, 3.0]).base_from_optical();
        assert!((pose.rotate(Vector3::z()) - Vector3::x()).norm() < 1e-12);
        assert!((pose.rotate(Vector3::x()) + Vector3::y()).norm() < 1e-12);
        assert!((pose.rotate(Vector3::y()) + Vector3::z()).norm() < 1e-12);
        assert_eq!(pose.origin().coords.coords, Vector3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn positive_pitch_looks_down_and_positive_yaw_to_the_left() {
        let axis = |yaw_rad: f64, pitch_rad: f64| {
            let mount = Mount {
                yaw_rad,
                pitch_rad,
                ..Mount::ahead([0.0; 3])
            };
            mount.base_from_optical().rotate(Vector3::z())
        };
        assert!(axis(0.0, 0.1).z < 0.0);
        assert!(axis(0.1, 0.0).y > 0.0);
    }

    proptest! {
        #[test]
        fn angles_come_back(yaw_rad in -3.1..3.1_f64, pitch_rad in -1.5..1.5_f64, roll_rad in -3.1..3.1_f64) {
            let mount = Mount { position_m: [0.5, -1.0, 2.0], yaw_rad, pitch_rad, roll_rad };
            let back = Mount::of(&mount.base_from_optical());
            prop_assert!((back.yaw_rad - yaw_rad).abs() < 1e-9);
            prop_assert!((back.pitch_rad - pitch_rad).abs() < 1e-9);
            prop_assert!((back.roll_rad - roll_rad).abs() < 1e-9);
        }
    }
}
