//! The footprint of a cuboid and how near it comes.

use roadwatch_core::{
    SizeLwh,
    space::{BaseLink, Point},
};
use std::f64::consts::PI;

/// Headings over which the distance is averaged when none is known. A cuboid looks alike after half a turn, so
/// these lie 7.5 degrees apart; twice as many change the mean of a car at 5 m by less than a millimetre.
const UNKNOWN_HEADING_STEPS: u32 = 24;

/// A cuboid seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Centre in base_link.
    pub center: Point<BaseLink>,
    /// Length and width are used.
    pub size: SizeLwh,
}

impl Footprint {
    /// Horizontal distance from a point to the nearest place of the rectangle, metres; 0 inside it. Where the
    /// heading is not known, the mean over all headings.
    #[must_use]
    pub fn distance_m(&self, from: Point<BaseLink>, yaw_rad: Option<f64>) -> f64 {
        if let Some(yaw_rad) = yaw_rad {
            return self.distance_at(from, yaw_rad);
        }
        let yaws = (0..UNKNOWN_HEADING_STEPS)
            .map(|step| f64::from(step) * PI / f64::from(UNKNOWN_HEADING_STEPS));
        let sum: f64 = yaws.map(|yaw_rad| self.distance_at(from, yaw_rad)).sum();
        sum / f64::from(UNKNOWN_HEADING_STEPS)
    }

    fn distance_at(&self, from: Point<BaseLink>, yaw_rad: f64) -> f64 {
        let (sin, cos) = yaw_rad.sin_cos();
        let (dx, dy) = (from.x() - self.center.x(), from.y() - self.center.y());
        let ahead = (dx * cos + dy * sin).abs() - self.size.length_m / 2.0;
        let aside = (dy * cos - dx * sin).abs() - self.size.width_m / 2.0;
        ahead.max(0.0).hypot(aside.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const CAR: Footprint = Footprint {
        center: Point::from_coords(nalgebra::Point3::new(10.0, 0.0, 0.7)),
        size: SizeLwh {
            length_m: 4.0,
            width_m: 2.0,
            height_m: 1.5,
        },
    };

    #[test]
    fn the_nearest_face_counts() {
        let foot = Point::new(0.0, 0.0, 1.6);
        assert!((CAR.distance_m(foot, Some(0.0)) - 8.0).abs() < 1e-12);
        assert!((CAR.distance_m(foot, Some(FRAC_PI_2)) - 9.0).abs() < 1e-12);
        let corner = Point::new(5.0, -5.0, 0.0);
        assert!((CAR.distance_m(corner, Some(0.0)) - 5.0).abs() < 1e-12);
        assert_eq!(CAR.distance_m(CAR.center, Some(1.0)), 0.0);
    }

    #[test]
    fn without_a_heading_it_lies_between_end_and_side() {
        let unknown = CAR.distance_m(Point::new(0.0, 0.0, 0.0), None);
        assert!(unknown > 7.7 && unknown < 9.0, "{unknown}");
    }
}
