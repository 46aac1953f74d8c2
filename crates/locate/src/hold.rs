//! Keeping an object's last location for a while when this frame gives none (docs/method.md, section 3).

use nalgebra::{Matrix3, Vector3};
use roadwatch_core::{Location, Prior, space::Covariance};
use std::time::Duration;

/// How fast an object may move against the vehicle while nobody looks, metres per second: base_link moves
/// with the vehicle, so this is a difference of two speeds in city traffic.
const SPEED_STD_M_S: f64 = 5.0;

/// For how long a location may be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HoldOptions {
    /// Age at which a location is dropped; zero keeps none.
    pub max_age: Duration,
}

impl Default for HoldOptions {
    /// Half a second: by then the place may be off by 2.5 m, more than a car's width.
    fn default() -> Self {
        Self {
            max_age: Duration::from_millis(500),
        }
    }
}

impl HoldOptions {
    /// The prior's location, marked as held, its horizontal covariance grown by what may have moved in
    /// the meantime; `None` when it is `max_age` old or older.
    #[must_use]
    pub fn keep(&self, prior: &Prior) -> Option<Location> {
        if prior.age >= self.max_age {
            return None;
        }
        let moved_m = SPEED_STD_M_S * prior.age.as_secs_f64();
        let grown = Matrix3::from_diagonal(&Vector3::new(moved_m, moved_m, 0.0).map(|m| m * m));
        Some(Location {
            covariance: Covariance::new(prior.location.covariance.matrix + grown),
            ground: None,
            held: true,
            ..prior.location.clone()
        })
    }
}
