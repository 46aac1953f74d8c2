//! The expected distance `d_` of a query.

use nalgebra::{Vector2, Vector4};
use roadwatch_core::{BoxPx, CameraModel, camera_model::Pixel};

/// How the expected distance `d_` of a query follows from the shape of its box, metres.
///
/// A box is `W` wide, `P` high and seen at an azimuth `a` off the optical axis (all of it without lens
/// distortion):
/// `d_ = (height_m + breadth_height_m * W/P) * F/P + cos(a) * (outline_m + breadth_m * cos(a) * W/P)`.
///
/// Plain eq. 2 has `height_m` alone. It measures to the outline that is seen, not to the object's centre:
/// on exact silhouettes of a car it is short by 1 to 3 m at every range, which no factor corrects.
/// `outline_m` is the way along the ray from outline to centre, `breadth_m` the part of it that a broad
/// box gives away (whoever shows a side is nearer by half a length less half a width), and
/// `breadth_height_m` what a rolled camera adds to the height of a broad box.
/// [`super::build_table`] fits the four numbers to the table's own boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedDistance {
    /// Effective height, metres.
    pub height_m: f64,
    /// What each unit of aspect ratio adds to that, metres.
    pub breadth_height_m: f64,
    /// From the outline to the centre, metres.
    pub outline_m: f64,
    /// What each unit of aspect ratio adds to that, metres.
    pub breadth_m: f64,
}

impl ExpectedDistance {
    /// Eq. 2 as the paper prints it, for an object `height_m` high.
    #[must_use]
    pub const fn literal(height_m: f64) -> Self {
        Self {
            height_m,
            breadth_height_m: 0.0,
            outline_m: 0.0,
            breadth_m: 0.0,
        }
    }

    /// `d_` of a box in a camera's image, metres; `None` where the lens model has no ray through it.
    #[must_use]
    pub fn depth_m(&self, model: &CameraModel, box_px: &BoxPx) -> Option<f64> {
        Some(self.numbers().dot(&terms(model, box_px)?))
    }

    /// The numbers, in the order of [`terms`].
    pub(super) fn numbers(&self) -> Vector4<f64> {
        Vector4::new(
            self.height_m,
            self.breadth_height_m,
            self.outline_m,
            self.breadth_m,
        )
    }

    pub(super) fn from_numbers(numbers: Vector4<f64>) -> Self {
        Self {
            height_m: numbers.x,
            breadth_height_m: numbers.y,
            outline_m: numbers.z,
            breadth_m: numbers.w,
        }
    }
}

/// What the four numbers are multiplied with.
pub(super) fn terms(model: &CameraModel, box_px: &BoxPx) -> Option<Vector4<f64>> {
    let center = box_px.center();
    let size = ray_size(model, box_px)?;
    let focal_over_height = 1.0 / size.y;
    let aspect = size.x / size.y;
    let cos_azimuth = 1.0 / model.ray(center)?.x.hypot(1.0);
    Some(Vector4::new(
        focal_over_height,
        focal_over_height * aspect,
        cos_azimuth,
        cos_azimuth.powi(2) * aspect,
    ))
}

/// Width and height of a box on the plane at depth 1, between the middles of its edges.
fn ray_size(model: &CameraModel, box_px: &BoxPx) -> Option<Vector2<f64>> {
    let center = box_px.center();
    let across = Pixel::x() * f64::from(box_px.width_px()) / 2.0;
    let down = Pixel::y() * f64::from(box_px.height_px()) / 2.0;
    Some(Vector2::new(
        model.ray(center + across)?.x - model.ray(center - across)?.x,
        model.ray(center + down)?.y - model.ray(center - down)?.y,
    ))
}
