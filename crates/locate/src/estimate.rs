//! What every method of this crate comes to: a place and how sure it is.

use crate::sizes::ClassSize;
use nalgebra::{Matrix3, Vector2, Vector3};
use roadwatch_core::{
    RigCamera,
    space::{BaseLink, Covariance, Point},
};

/// A position in base_link with its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Centre of the object's box, metres.
    pub position: Point<BaseLink>,
    /// Of the position, square metres.
    pub covariance: Covariance<BaseLink>,
}

/// How far the middle of a box strays to the side of its object's centre, one standard deviation as a
/// share of the object's width: a car seen at a slant shows more of its nearer end.
const MIDDLE_STD_SHARE: f64 = 0.15;

/// That shift in base_link for an object at `place`, metres: level, across the ray.
pub(crate) fn aside_of_middle(
    camera: &RigCamera,
    place: Vector2<f64>,
    class: &ClassSize,
) -> Vector2<f64> {
    let ray = place - camera.base_from_optical.origin().coords.xy().coords;
    let across = Vector2::new(-ray.y, ray.x).try_normalize(f64::EPSILON);
    across.unwrap_or_default() * (class.size.width_m * MIDDLE_STD_SHARE)
}

/// The covariance of independent causes, each given as the shift that one standard deviation of it makes.
pub(crate) fn covariance_of_shifts(shifts: impl IntoIterator<Item = Vector3<f64>>) -> Matrix3<f64> {
    let outer = shifts.into_iter().map(|shift| shift * shift.transpose());
    outer.fold(Matrix3::zeros(), |sum, term| sum + term)
}
