//! Pose and 6x6 covariance of an object.

use super::seen::Placed;
use crate::msg::geometry_msgs::{PoseWithCovariance, Vector3};
use nalgebra::{Isometry3, Matrix6, Translation3, UnitQuaternion, Vector3 as Axis};
use roadwatch_core::{
    Heading, SizeLwh,
    space::{BaseLink, Optical, Transform},
};
use std::f64::consts::PI;

/// Variance of a heading that nothing is known about: a uniform angle over a full turn, square radians.
pub const YAW_UNKNOWN_VARIANCE_RAD2: f64 = PI * PI / 3.0;

/// Variance of roll and pitch, square radians: objects stand upright on a road whose slope against the
/// vehicle stays within some five degrees. Zero would make the matrix singular, and filters invert it.
pub const UPRIGHT_VARIANCE_RAD2: f64 = 0.0076;

/// An object's pose in some frame, with the covariance of position and rotation about that frame's axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UncertainPose {
    /// Centre and axes of the object's box.
    pub(crate) isometry: Isometry3<f64>,
    covariance: Matrix6<f64>,
}

/// Variance of the yaw, square radians, with the chance of a flip; that of a uniform angle without a heading.
pub(crate) fn yaw_variance(heading: Option<Heading>) -> f64 {
    let known = heading.map(|heading| heading.variance_rad2());
    known.map_or(YAW_UNKNOWN_VARIANCE_RAD2, |variance| {
        variance.min(YAW_UNKNOWN_VARIANCE_RAD2)
    })
}

/// Length, width and height as extents along x, y and z.
pub(crate) fn extents(size: SizeLwh) -> Vector3 {
    Vector3 {
        x: size.length_m,
        y: size.width_m,
        z: size.height_m,
    }
}

impl UncertainPose {
    /// The pose; not turned when the heading is unknown.
    pub(crate) fn of(placed: &Placed) -> Self {
        let yaw_rad = placed.heading.map_or(0.0, |heading| heading.yaw_rad);
        let diagonal = [
            UPRIGHT_VARIANCE_RAD2,
            UPRIGHT_VARIANCE_RAD2,
            yaw_variance(placed.heading),
        ];
        let mut covariance = Matrix6::zeros();
        covariance
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&placed.covariance);
        covariance
            .fixed_view_mut::<3, 3>(3, 3)
            .set_diagonal(&diagonal.into());
        Self {
            isometry: Isometry3::from_parts(
                Translation3::from(placed.position),
                UnitQuaternion::from_axis_angle(&Axis::z_axis(), yaw_rad),
            ),
            covariance,
        }
    }

    /// The same pose, of one placed in base_link, in a camera's optical frame.
    pub(crate) fn in_optical(
        placed: &Placed,
        base_from_optical: Transform<BaseLink, Optical>,
    ) -> Self {
        let optical_from_base = base_from_optical.inverse().isometry;
        let in_base = Self::of(placed);
        let turn = optical_from_base.rotation.to_rotation_matrix();
        let mut turn_both = Matrix6::zeros();
        turn_both
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(turn.matrix());
        turn_both
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(turn.matrix());
        Self {
            isometry: optical_from_base * in_base.isometry,
            covariance: turn_both * in_base.covariance * turn_both.transpose(),
        }
    }
}

impl From<&UncertainPose> for PoseWithCovariance {
    fn from(pose: &UncertainPose) -> Self {
        Self {
            pose: (&pose.isometry).into(),
            // Columns of a symmetric matrix are its rows.
            covariance: pose.covariance.into(),
        }
    }
}
