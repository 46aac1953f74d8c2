//! How far a detector's box edges stray from the object's.

use roadwatch_core::BoxPx;
use std::f64::consts::SQRT_2;

/// Standard deviation of each edge of a box: a floor in pixels of what was looked at and a share of the box's height,
/// added as independent errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxNoise {
    /// Floor, pixels of what was looked at: of the network's input ([`BoxNoise::seen_through`]), of the image where
    /// somebody looked at that.
    pub edge_px: f64,
    /// Share of the box's height.
    pub edge_share_of_height: f64,
}

impl Default for BoxNoise {
    /// One pixel, and 3 % of the height: on simulated cars with nothing in front of them the upper and lower
    /// edges of two small YOLOs stray by 1.5 to 2.5 px at 30 px of height and by 3.5 px at 120 px (median
    /// absolute deviation times 1.48).
    fn default() -> Self {
        Self {
            edge_px: 1.0,
            edge_share_of_height: 0.03,
        }
    }
}

impl BoxNoise {
    /// Of a box that was found at a coarser or finer scale than the image's: one pixel looked at is
    /// `input_pixel_px` pixels of the image ([`roadwatch_core::Detection::input_pixel_px`]).
    #[must_use]
    pub fn seen_through(self, input_pixel_px: f32) -> Self {
        Self {
            edge_px: self.edge_px * f64::from(input_pixel_px),
            ..self
        }
    }

    /// Standard deviation of one edge, pixels.
    #[must_use]
    pub fn edge_std_px(&self, box_px: &BoxPx) -> f64 {
        self.edge_px
            .hypot(self.edge_share_of_height * f64::from(box_px.height_px()))
    }

    /// Standard deviation of the middle of two opposite edges, pixels.
    #[must_use]
    pub fn center_std_px(&self, box_px: &BoxPx) -> f64 {
        self.edge_std_px(box_px) / SQRT_2
    }

    /// Standard deviation of the distance between two opposite edges, pixels.
    #[must_use]
    pub fn extent_std_px(&self, box_px: &BoxPx) -> f64 {
        self.edge_std_px(box_px) * SQRT_2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarser_look_raises_the_floor_alone() {
        let noise = BoxNoise {
            edge_px: 1.0,
            edge_share_of_height: 0.05,
        };
        let coarse = noise.seen_through(3.0);
        assert_eq!(coarse.edge_px, 3.0);
        assert_eq!(coarse.edge_share_of_height, 0.05);
    }

    #[test]
    fn small_boxes_have_the_floor_and_large_ones_their_share() {
        let noise = BoxNoise {
            edge_px: 1.0,
            edge_share_of_height: 0.05,
        };
        let of_height = |height| BoxPx::new(0.0, 0.0, 10.0, height).expect("a box");
        assert!((noise.edge_std_px(&of_height(1.0)) - 1.0).abs() < 0.01);
        assert!((noise.edge_std_px(&of_height(400.0)) - 20.0).abs() < 0.1);
    }
}
