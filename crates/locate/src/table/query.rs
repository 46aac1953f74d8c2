//! One question to a table and its score (eq. 4-7).

use super::TableRow;
use roadwatch_core::{BoxPx, ImageSize};

/// Pixels that a metre of depth is worth in the score, by default, in an image
/// [`DEFAULT_WEIGHT_WIDTH_PX`] wide (see [`Weight::default`]).
pub const DEFAULT_PX_PER_METRE: f32 = 20.0;
/// The image width that [`DEFAULT_PX_PER_METRE`] belongs to.
pub const DEFAULT_WEIGHT_WIDTH_PX: u32 = 960;
/// Pixels and metres beyond this come from no camera, and their sums would overflow.
const LARGEST_NUMBER: f32 = 1e9;

/// The paper's `W` or `dis_weight` in eq. 7, which it calls both a weighting factor and the known width
/// of the object's bounding box (docs/method.md, section 3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// A number, in pixels per metre of an image of the stated width.
    PxPerMetre {
        /// Pixels that a metre of depth is worth.
        value: f32,
        /// The width of the image that `value` belongs to, pixels.
        at_image_width_px: u32,
    },
    /// The width of the queried box in pixels, as a number.
    BoxWidth,
}

impl Default for Weight {
    /// Twenty pixels a metre at 960 columns: what a metre sideways is worth at 50 m in a 50-degree lens.
    /// Nearer than about 10 m the row of the middle then decides, farther away the distance, and columns
    /// everywhere. On exact silhouettes the 90th percentile of location errors has its floor from 15 to
    /// 50 px/m; box width is as good, less than 10 lets far rows win by their columns.
    fn default() -> Self {
        Self::PxPerMetre {
            value: DEFAULT_PX_PER_METRE,
            at_image_width_px: DEFAULT_WEIGHT_WIDTH_PX,
        }
    }
}

impl Weight {
    /// The weight of one query, pixels per metre of an image of `size`.
    #[must_use]
    pub fn px_per_metre(self, box_px: &BoxPx, size: ImageSize) -> f32 {
        match self {
            Self::PxPerMetre {
                value,
                at_image_width_px,
            } => value * size.width_px as f32 / at_image_width_px as f32,
            Self::BoxWidth => box_px.width_px(),
        }
    }

    /// By what a limit on scores, stated for an image [`DEFAULT_WEIGHT_WIDTH_PX`] wide, is multiplied for
    /// one query: with a numeric weight by the image's width, as its scores are; with box width by
    /// how many times [`DEFAULT_PX_PER_METRE`] that weighs, so that the limit stands for as many metres of
    /// depth as with the default weight.
    #[must_use]
    pub fn limit_scale(self, box_px: &BoxPx, size: ImageSize) -> f32 {
        match self {
            Self::PxPerMetre { .. } => size.width_px as f32 / DEFAULT_WEIGHT_WIDTH_PX as f32,
            Self::BoxWidth => box_px.width_px() / DEFAULT_PX_PER_METRE,
        }
    }
}

/// A question: which row looks most like this?
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableQuery {
    /// Column of the box's middle, a pixel position.
    pub center_x_px: f32,
    /// Row of the box's middle, a pixel position.
    pub center_y_px: f32,
    /// The expected distance `d_` (`depth_m`), metres.
    pub distance_m: f32,
    /// What a metre is worth, pixels; not negative.
    pub px_per_metre: f32,
}

impl TableQuery {
    /// Eq. 7 for one row: `(|dx| + |dy| + w*|dd|) / 3`, pixels, in `f32` and in this order.
    #[must_use]
    pub fn score(&self, row: &TableRow) -> f32 {
        self.score_at(row.center_x_px, row.center_y_px, row.distance_m)
    }

    pub(super) fn score_at(&self, x: f32, y: f32, d: f32) -> f32 {
        let sum = self.sum_of(
            (x - self.center_x_px).abs(),
            (y - self.center_y_px).abs(),
            (d - self.distance_m).abs(),
        );
        sum / 3.0
    }

    /// Eq. 7 before its division, from the three distances.
    pub(super) fn sum_of(&self, dx: f32, dy: f32, dd: f32) -> f32 {
        dx + dy + self.px_per_metre * dd
    }

    /// False for what has no nearest row: numbers that are not finite or absurdly large, negative weights.
    pub(super) fn is_answerable(&self) -> bool {
        let numbers = [
            self.center_x_px,
            self.center_y_px,
            self.distance_m,
            self.px_per_metre,
        ];
        numbers.iter().all(|number| number.abs() < LARGEST_NUMBER) && self.px_per_metre >= 0.0
    }
}
