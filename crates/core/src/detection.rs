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

/// An upright box in an image, pixels; `min <= max` on both axes.
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

    /// The middle (the paper's `Center_x`, `Center_y`).
    #[must_use]
    pub fn center(&self) -> Pixel {
        Pixel::new(
            (f64::from(self.x_min) + f64::from(self.x_max)) / 2.0,
            (f64::from(self.y_min) + f64::from(self.y_max)) / 2.0,
        )
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
}
