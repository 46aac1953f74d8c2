//! The rig: all cameras of one vehicle, how they see and where they sit.

use crate::{
    camera_model::{CameraModel, ImageSize},
    frame::CameraId,
    name::CameraName,
    space::{BaseLink, CameraGround, Optical, Point, Transform},
};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// A camera whose optical axis is closer than this to vertical has no usable azimuth (docs/method.md, section 3).
const MIN_ANGLE_FROM_VERTICAL_DEG: f64 = 20.0;

/// A focal value measured with an object of known size at a known distance (eq. 1), pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredFocal {
    /// `F = P * D / W` in pixels of an image `image_height_px` high.
    pub focal_px: f64,
    /// Height of the image it was measured in, pixels.
    pub image_height_px: u32,
}

impl MeasuredFocal {
    /// Eq. 1: an object `size_m` high that appears `height_px` high at `distance_m`.
    #[must_use]
    pub fn from_known_object(
        height_px: f64,
        distance_m: f64,
        size_m: f64,
        image_height_px: u32,
    ) -> Self {
        Self {
            focal_px: height_px * distance_m / size_m,
            image_height_px,
        }
    }

    /// The value for an image of another size: scaled by the ratio of heights.
    #[must_use]
    pub fn for_size(&self, size: ImageSize) -> f64 {
        self.focal_px * f64::from(size.height_px) / f64::from(self.image_height_px)
    }
}

/// One camera of the rig.
#[derive(Clone, Debug, PartialEq)]
pub struct RigCamera {
    /// Its name.
    pub name: CameraName,
    /// How it sees.
    pub model: CameraModel,
    /// Where it sits.
    pub base_from_optical: Transform<BaseLink, Optical>,
    /// Focal value measured by eq. 1; `None` where nobody measured one.
    pub measured_focal: Option<MeasuredFocal>,
}

/// The camera looks so steeply up or down that "ahead on the ground" has no direction.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the optical axis is {angle_deg:.1} degrees from vertical; at least 20 are needed for a direction on the ground"
)]
pub struct LooksVertical {
    /// Angle between the optical axis and the vertical, degrees.
    pub angle_deg: f64,
}

impl RigCamera {
    /// The camera-ground space of docs/method.md, section 3: `base = Rz(azimuth) * (LocY, -LocX) + foot`.
    ///
    /// # Errors
    /// When the optical axis is within 20 degrees of vertical.
    pub fn base_from_ground(
        &self,
        ground_z_m: f64,
    ) -> Result<Transform<BaseLink, CameraGround>, LooksVertical> {
        self.base_from_optical.to_ground(ground_z_m)
    }

    /// Horizontal distance from the camera's foot to a point (`range_m`), metres.
    #[must_use]
    pub fn range_m(&self, point: Point<BaseLink>) -> f64 {
        let foot = self.base_from_optical.origin();
        (point.x() - foot.x()).hypot(point.y() - foot.y())
    }

    /// Component along the optical axis (`depth_m`), metres; negative behind the camera.
    #[must_use]
    pub fn depth_m(&self, point: Point<BaseLink>) -> f64 {
        (self.base_from_optical.inverse() * point).z()
    }
}

impl Transform<BaseLink, Optical> {
    /// The camera-ground space of a camera at this pose, over ground at `ground_z_m` of base_link.
    ///
    /// # Errors
    /// See [`RigCamera::base_from_ground`].
    pub fn to_ground(
        &self,
        ground_z_m: f64,
    ) -> Result<Transform<BaseLink, CameraGround>, LooksVertical> {
        let axis = self.rotate(Vector3::z());
        let angle_deg = axis.xy().norm().atan2(axis.z.abs()).to_degrees();
        if angle_deg < MIN_ANGLE_FROM_VERTICAL_DEG {
            return Err(LooksVertical { angle_deg });
        }
        let foot = self.origin();
        let azimuth = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), axis.y.atan2(axis.x));
        Ok(Transform::new(Isometry3::from_parts(
            Translation3::new(foot.x(), foot.y(), ground_z_m),
            azimuth,
        )))
    }
}

/// All cameras of one vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    cameras: Vec<RigCamera>,
    /// Height of the ground plane in base_link, metres (its origin may be the rear axle).
    pub ground_z_m: f64,
}

/// A rig that cannot be: no camera, too many, or two of one name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidRig {
    /// No camera at all.
    #[error("the rig has no camera")]
    Empty,
    /// More cameras than a [`CameraId`] can count.
    #[error("the rig has {0} cameras; at most 255 are supported")]
    TooMany(usize),
    /// Two cameras share a name.
    #[error("two cameras are called `{0}`")]
    SameName(CameraName),
}

impl Rig {
    /// A rig from its cameras, in order of their ids.
    ///
    /// # Errors
    /// When there is no camera, more than 255, or two of one name.
    pub fn new(cameras: Vec<RigCamera>, ground_z_m: f64) -> Result<Self, InvalidRig> {
        if cameras.is_empty() {
            return Err(InvalidRig::Empty);
        }
        if cameras.len() > usize::from(u8::MAX) {
            return Err(InvalidRig::TooMany(cameras.len()));
        }
        for (at, camera) in cameras.iter().enumerate() {
            if cameras[..at].iter().any(|other| other.name == camera.name) {
                return Err(InvalidRig::SameName(camera.name.clone()));
            }
        }
        Ok(Self {
            cameras,
            ground_z_m,
        })
    }

    /// The cameras, in order of their ids.
    #[must_use]
    pub fn cameras(&self) -> &[RigCamera] {
        &self.cameras
    }

    /// One camera.
    ///
    /// # Panics
    /// When the id is not of this rig.
    #[must_use]
    pub fn camera(&self, id: CameraId) -> &RigCamera {
        &self.cameras[id.index()]
    }

    /// The ids of all cameras, ascending.
    pub fn ids(&self) -> impl Iterator<Item = CameraId> + use<> {
        // `new` bounds the number of cameras by 255.
        (0..self.cameras.len()).map(|index| CameraId(index as u8))
    }

    /// The camera of that name; `None` when there is none.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<CameraId> {
        self.ids().find(|&id| self.camera(id).name.as_str() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_focal_values_follow_from_its_measurement() {
        for (size_m, expected) in [
            (1.4, 1964.28),
            (2.0, 1375.0),
            (1.55, 1774.19),
            (1.7, 1617.64),
        ] {
            let focal = MeasuredFocal::from_known_object(55.0, 50.0, size_m, 1080);
            assert!((focal.focal_px - expected).abs() < 0.01, "{size_m}");
        }
    }

    #[test]
    fn a_focal_value_belongs_to_an_image_size() {
        let focal = MeasuredFocal {
            focal_px: 1964.0,
            image_height_px: 1080,
        };
        let half = ImageSize {
            width_px: 960,
            height_px: 540,
        };
        assert!((focal.for_size(half) - 982.0).abs() < 1e-9);
    }
}
