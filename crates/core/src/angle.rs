//! Angles are angles whatever the number of turns.

use std::f64::consts::TAU;

/// Wraps an angle to `-pi..=pi`, radians.
#[must_use]
pub fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - TAU * (angle_rad / TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    proptest! {
        #[test]
        fn it_points_the_same_way_within_half_a_turn(angle_rad in -100.0..100.0_f64) {
            let found = wrapped(angle_rad);
            prop_assert!((-PI..=PI).contains(&found));
            prop_assert!((found.sin() - angle_rad.sin()).abs() < 1e-9);
            prop_assert!((found.cos() - angle_rad.cos()).abs() < 1e-9);
        }
    }
}
