//! The fit of the expected distance to the boxes of a table.

use super::ExpectedDistance;
use nalgebra::{Matrix4, Vector4};

/// How far the four numbers of real objects may be from eq. 2's, one standard deviation: heights and what a
/// roll adds to them by decimetres, the way from outline to centre by half a car.
const PRIOR_STD_DEV_M: Vector4<f64> = Vector4::new(0.5, 0.1, 2.5, 1.0);
/// How far off the distance of one labelled box at 1 m is, metres; the variance grows with the distance, which
/// is the weight that [`DistanceFit::add`] gives.
const LABEL_STD_DEV_M: f64 = 0.1;

/// Least squares of [`ExpectedDistance`] over the boxes of a table.
#[derive(Default)]
pub(super) struct DistanceFit {
    normal: Matrix4<f64>,
    moments: Vector4<f64>,
    boxes: u32,
}

impl DistanceFit {
    /// Fewer boxes than this say too little; eq. 2 stays as printed.
    const MIN_BOXES: u32 = 8;

    /// Cells at a range are as many as the range is long, so each weighs by the inverse of its depth.
    pub(super) fn add(&mut self, terms: Vector4<f64>, depth_m: f64) {
        self.normal += terms * terms.transpose() / depth_m;
        self.moments += terms;
        self.boxes += 1;
    }

    /// The fit to boxes of every kind, as a grid with headings has them.
    pub(super) fn solve(&self, height_m: f64) -> ExpectedDistance {
        self.solve_normal(self.normal, self.moments, height_m)
    }

    /// The fit to whatever boxes there were: what they leave open stays near eq. 2. Cars that all point the
    /// same way do not tell what a broad box means, and noise would.
    pub(super) fn solve_near_literal(&self, height_m: f64) -> ExpectedDistance {
        let certainty = PRIOR_STD_DEV_M.map(|std_dev| (LABEL_STD_DEV_M / std_dev).powi(2));
        let literal = ExpectedDistance::literal(height_m).numbers();
        self.solve_normal(
            self.normal + Matrix4::from_diagonal(&certainty),
            self.moments + certainty.component_mul(&literal),
            height_m,
        )
    }

    fn solve_normal(
        &self,
        normal: Matrix4<f64>,
        moments: Vector4<f64>,
        height_m: f64,
    ) -> ExpectedDistance {
        let solved = normal.try_inverse().map(|inverse| inverse * moments);
        match solved {
            Some(fit) if self.boxes >= Self::MIN_BOXES && fit.x > 0.0 => {
                ExpectedDistance::from_numbers(fit)
            }
            _ => ExpectedDistance::literal(height_m),
        }
    }
}
