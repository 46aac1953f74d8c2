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

#[cfg(test)]
mod tests {
    use super::*;

    const TRUE: [f64; 4] = [1.45, 0.01, 3.6, -0.45];

    /// The fit to `count` boxes from 6 to 50 m whose aspect ratios lie between two, straight ahead, with
    /// distances off by up to `off_m`.
    fn fit(count: u32, aspects: (f64, f64), off_m: f64) -> DistanceFit {
        let mut fit = DistanceFit::default();
        for at in 0..count {
            let share = f64::from(at) / f64::from(count);
            let aspect = aspects.0 + (aspects.1 - aspects.0) * (share * 7.0).fract();
            let focal_over_height = 4.0 + 30.0 * share;
            let terms = Vector4::new(focal_over_height, focal_over_height * aspect, 1.0, aspect);
            let sign = if at % 3 == 0 { 1.0 } else { -0.5 };
            fit.add(terms, terms.dot(&Vector4::from(TRUE)) + off_m * sign);
        }
        fit
    }

    #[test]
    fn boxes_of_every_kind_leave_nothing_open() {
        let fit = fit(1000, (1.2, 3.4), 0.0);
        let free = fit.solve(1.5).numbers();
        let held = fit.solve_near_literal(1.5).numbers();
        assert!((free - Vector4::from(TRUE)).norm() < 1e-6, "{free}");
        assert!((held - free).norm() < 0.05, "{held}");
    }

    #[test]
    fn boxes_of_one_kind_say_nothing_of_others() {
        let fit = fit(30, (1.30, 1.31), 0.3);
        let held = fit.solve_near_literal(1.5);
        assert!(held.breadth_m.abs() < 1.5, "{held:?}");
        assert!(held.breadth_height_m.abs() < 0.2, "{held:?}");
        let terms = Vector4::new(20.0, 26.0, 1.0, 1.3);
        let asked_m = held.numbers().dot(&terms);
        let true_m = Vector4::from(TRUE).dot(&terms);
        assert!((asked_m - true_m).abs() < 0.3, "{asked_m} {true_m}");
    }

    #[test]
    fn a_handful_of_boxes_leaves_eq_2_as_it_is() {
        let literal = ExpectedDistance::literal(1.5);
        assert_eq!(fit(7, (1.2, 3.4), 0.0).solve_near_literal(1.5), literal);
    }
}
