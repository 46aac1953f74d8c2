//! Three angles that must not be mixed up (docs/method.md, section 6).

use roadwatch_core::angle::wrapped;
use std::f64::consts::PI;

/// An object's heading relative to the ray it is seen along, counter-clockwise about the vertical, radians in
/// `-pi..=pi`: 0 shows its rear, pi its front. What a crop shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservationAngle(f64);

/// The horizontal direction from a camera to an object, about base_link's z, radians in `-pi..=pi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayAngle(f64);

/// An object's heading in base_link, about z, zero along the vehicle's forward axis (REP-103), radians in
/// `-pi..=pi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yaw(f64);

impl ObservationAngle {
    /// Of an angle in radians, wrapped.
    #[must_use]
    pub fn new(angle_rad: f64) -> Self {
        Self(wrapped(angle_rad))
    }

    /// Radians in `-pi..=pi`.
    #[must_use]
    pub fn radians(self) -> f64 {
        self.0
    }

    /// `yaw = wrap(observation angle + ray angle)`.
    #[must_use]
    pub fn seen_along(self, ray: RayAngle) -> Yaw {
        Yaw(wrapped(self.0 + ray.0))
    }

    /// The smaller angle between two, radians in `0..=pi`.
    #[must_use]
    pub fn apart_rad(self, other: Self) -> f64 {
        wrapped(self.0 - other.0).abs()
    }

    /// The same object turned round.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self::new(self.0 + PI)
    }
}

impl RayAngle {
    /// Of an angle in radians, wrapped.
    #[must_use]
    pub fn new(angle_rad: f64) -> Self {
        Self(wrapped(angle_rad))
    }

    /// Of the horizontal vector from the camera to the object in base_link, metres.
    #[must_use]
    pub fn towards(dx_m: f64, dy_m: f64) -> Self {
        Self(dy_m.atan2(dx_m))
    }

    /// Radians in `-pi..=pi`.
    #[must_use]
    pub fn radians(self) -> f64 {
        self.0
    }
}

impl Yaw {
    /// Of an angle in radians, wrapped.
    #[must_use]
    pub fn new(angle_rad: f64) -> Self {
        Self(wrapped(angle_rad))
    }

    /// Radians in `-pi..=pi`.
    #[must_use]
    pub fn radians(self) -> f64 {
        self.0
    }

    /// What a camera sees of an object with this heading along a ray.
    #[must_use]
    pub fn seen_along(self, ray: RayAngle) -> ObservationAngle {
        ObservationAngle::new(self.0 - ray.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn seen_along_a_ray_and_back_is_the_same_heading(yaw in -10.0..10.0_f64, x in -9.0..9.0_f64, y in 0.1..9.0_f64) {
            let ray = RayAngle::towards(x, y);
            let yaw = Yaw::new(yaw);
            let back = yaw.seen_along(ray).seen_along(ray);
            prop_assert!(wrapped(back.radians() - yaw.radians()).abs() < 1e-12);
            prop_assert!(back.radians().abs() <= PI);
        }
    }

    #[test]
    fn three_cars_that_point_the_same_way_are_seen_at_three_angles() {
        let seen = [-3.0, 0.0, 3.0].map(|left_m| {
            let ray = RayAngle::towards(10.0, left_m);
            Yaw::new(0.0).seen_along(ray).radians().to_degrees().round()
        });
        assert_eq!(seen, [17.0, 0.0, -17.0]);
    }
}
