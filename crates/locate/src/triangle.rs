//! Distance by triangle similarity (eq. 1 and 2), placed along the ray through the box's middle.

use crate::{
    box_noise::BoxNoise,
    estimate::{Estimate, aside_of_middle, covariance_of_shifts},
    sizes::ClassSize,
};
use nalgebra::{Point3, Vector2, Vector3};
use roadwatch_core::{
    BoxPx, CameraModel, RigCamera,
    camera_model::Pixel,
    space::{Covariance, Optical, Point},
};
use std::f64::consts::PI;

/// Step of the numeric slope of rays, pixels: far below what lens distortion changes on.
const SLOPE_STEP_PX: f64 = 0.5;

/// Eq. 2: `depth_m` of an object `height_m` high that appears `height_px` high.
#[must_use]
pub fn depth_m(height_m: f64, focal_px: f64, height_px: f64) -> f64 {
    height_m * focal_px / height_px
}

/// Places a box at the depth of eq. 2 on the ray through its middle.
///
/// The covariance follows from five independent causes. Depth is off by the relative spread of the real
/// height and of the box's height together; the ray by the noise of the box's middle in columns and rows;
/// and eq. 2 measures to the outline that is seen, which is nearer than the centre by the object's mean
/// half extent and whose middle strays to the side. The paper corrects neither, so both count as errors.
/// `None` where the lens model has no ray.
#[must_use]
pub fn locate_by_triangle(
    camera: &RigCamera,
    focal_px: f64,
    class: &ClassSize,
    box_px: &BoxPx,
    noise: &BoxNoise,
) -> Option<Estimate> {
    let center = box_px.center();
    let ray = camera.model.ray(center)?;
    let height_px = f64::from(box_px.height_px());
    let depth_m = depth_m(class.size.height_m, focal_px, height_px);
    let relative_std = (class.std_dev.height_m / class.size.height_m)
        .hypot(noise.extent_std_px(box_px) / height_px);
    let center_std_px = noise.center_std_px(box_px);
    let in_camera = Point::<Optical>::from_coords(Point3::from(ray * depth_m));
    let position = camera.base_from_optical * in_camera;
    let aside = aside_of_middle(camera, position.coords.xy().coords, class);
    let to_base = |shift| camera.base_from_optical.rotate(shift);
    let shifts = [
        to_base(ray * depth_m * relative_std),
        to_base(ray_slope(&camera.model, center, Vector2::x()) * depth_m * center_std_px),
        to_base(ray_slope(&camera.model, center, Vector2::y()) * depth_m * center_std_px),
        to_base(ray.normalize() * mean_half_extent_m(class)),
        Vector3::new(aside.x, aside.y, 0.0),
    ];
    Some(Estimate {
        position,
        covariance: Covariance::new(covariance_of_shifts(shifts)),
    })
}

/// From the centre to the nearest outline, averaged over headings, metres: a rectangle `l` by `w` turned
/// through all angles reaches `(l + w) / pi`.
fn mean_half_extent_m(class: &ClassSize) -> f64 {
    (class.size.length_m + class.size.width_m) / PI
}

/// How the ray moves on the plane at depth 1 per pixel along `axis`; without distortion where the lens
/// model ends within the step.
fn ray_slope(model: &CameraModel, at: Pixel, axis: Vector2<f64>) -> Vector3<f64> {
    let moved = |by| model.ray(at + axis * by);
    match (moved(SLOPE_STEP_PX), moved(-SLOPE_STEP_PX)) {
        (Some(ahead), Some(behind)) => (ahead - behind) / (2.0 * SLOPE_STEP_PX),
        _ => Vector3::new(
            axis.x / model.intrinsics.fx,
            axis.y / model.intrinsics.fy,
            0.0,
        ),
    }
}
