//! What a detector says about one object in one image.

use crate::{camera_model::Pixel, object_class::ObjectClass};

/// A confidence in `0.0..=1.0`.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Score(f32);

impl Score {
    /// `None` when the value is not a number in `0.0..=1.0`.
    #[must_use]
    pub fn new(value: f32) -> Option<Self> {
        (0.0..=1.0).contains(&value).then_some(Self(value))
    }

    /// The value, `0.0..=1.0`.
    #[must_use]
    pub fn get(self) -> f32 {
        self.0
    }
}

/// Half a pixel: from the edges that boxes are measured by to the centres that lenses project to.
const HALF_PIXEL: f64 = 0.5;

/// An upright box in an image, pixels; `min <= max` on both axes.
///
/// Its numbers are edges, as detectors and labels give them: 0 is the left edge of the first column and the
/// image's width the right edge of the last. Pixel positions, which lenses project to, have the *centre* of
/// the first pixel at 0; [`BoxPx::center`] and its like give those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxPx {
    /// Left edge.
    pub x_min: f32,
    /// Top edge.
    pub y_min: f32,
    /// Right edge.
    pub x_max: f32,
    /// Bottom edge.
    pub y_max: f32,
}

impl BoxPx {
    /// A box from two opposite corners, pixels; `None` unless all are finite and it has an area.
    #[must_use]
    pub fn new(x_min: f32, y_min: f32, x_max: f32, y_max: f32) -> Option<Self> {
        let finite = [x_min, y_min, x_max, y_max].iter().all(|v| v.is_finite());
        (finite && x_max > x_min && y_max > y_min).then_some(Self {
            x_min,
            y_min,
            x_max,
            y_max,
        })
    }

    /// Columns covered.
    #[must_use]
    pub fn width_px(&self) -> f32 {
        self.x_max - self.x_min
    }

    /// Rows covered.
    #[must_use]
    pub fn height_px(&self) -> f32 {
        self.y_max - self.y_min
    }

    /// Square pixels covered (the paper's `Area`).
    #[must_use]
    pub fn area_px2(&self) -> f32 {
        self.width_px() * self.height_px()
    }

    /// The box between two pixel positions.
    #[must_use]
    pub fn between(min: Pixel, max: Pixel) -> Option<Self> {
        let edge = |position: f64| (position + HALF_PIXEL) as f32;
        Self::new(edge(min.x), edge(min.y), edge(max.x), edge(max.y))
    }

    /// The pixel position of the middle (the paper's `Center_x`, `Center_y`).
    #[must_use]
    pub fn center(&self) -> Pixel {
        let y = (f64::from(self.y_min) + f64::from(self.y_max)) / 2.0;
        Pixel::new(self.center_x(), y - HALF_PIXEL)
    }

    /// The pixel position of the middle of the lower edge.
    #[must_use]
    pub fn bottom_center(&self) -> Pixel {
        Pixel::new(self.center_x(), f64::from(self.y_max) - HALF_PIXEL)
    }

    fn center_x(&self) -> f64 {
        (f64::from(self.x_min) + f64::from(self.x_max)) / 2.0 - HALF_PIXEL
    }

    /// Intersection over union, `0.0..=1.0`.
    #[must_use]
    pub fn iou(&self, other: &Self) -> f32 {
        let width = self.x_max.min(other.x_max) - self.x_min.max(other.x_min);
        let height = self.y_max.min(other.y_max) - self.y_min.max(other.y_min);
        if width <= 0.0 || height <= 0.0 {
            return 0.0;
        }
        let shared = width * height;
        shared / (self.area_px2() + other.area_px2() - shared)
    }
}

/// One object found in one image.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// What it is.
    pub class: ObjectClass,
    /// How sure the network is.
    pub score: Score,
    /// Where it is in the camera's own image, pixels.
    pub box_px: BoxPx,
    /// Side of one pixel of what the detector looked at, in pixels of the camera's own image: how coarsely the box
    /// was seen. 1 for who looked at the image itself, 3 for a 1920 px wide image seen by a 640 px wide network.
    pub input_pixel_px: f32,
}
