//! What boxes say of the ground they stand on: a plane under the rig, tilted by two slopes.

use nalgebra::{Matrix2, Vector2};

/// What is known of the two slopes of the ground under the rig: its rise per metre ahead and per metre to the
/// left of base_link (docs/method.md, section 3), as evidence, which adds up.
///
/// The vehicle's own pitch and roll over its wheels tilt the ground by as much in base_link, so they are the
/// same two numbers. Without evidence, both are zero: nothing is known, and a locator expects what it is
/// configured to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeEvidence {
    /// Inverse of the slopes' covariance.
    pub information: Matrix2<f64>,
    /// The information times the slopes.
    pub pull: Vector2<f64>,
    /// How uneven the ground is, against what a locator is configured to expect: every deviation of a slope is that many times
    /// the configured one. 1 where nobody said anything.
    pub unevenness: f64,
}

impl Default for SlopeEvidence {
    fn default() -> Self {
        Self {
            information: Matrix2::zeros(),
            pull: Vector2::zeros(),
            unevenness: 1.0,
        }
    }
}

/// What one box says of the ground's height where its object stands, by itself: without what was expected of
/// the ground there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundReading {
    /// Where, in base_link, metres.
    pub place: Vector2<f64>,
    /// Height over the rig's ground plane, metres.
    pub height_m: f64,
    /// Standard deviation of that, metres, for an object of its own size and a box of its own noise; more where it is far from what
    /// was expected.
    pub std_dev_m: f64,
    /// What it is off, metres, when all objects of the class are larger than expected by one standard
    /// deviation of their mean size: the same mistake in every reading.
    pub by_mean_size_m: f64,
    /// What it is off, metres, when the ground on this camera's side of the rig deviates from the plane by one
    /// standard deviation: the same slope for everything that this camera sees.
    pub by_side_m: f64,
    /// Standard deviation of that, metres, on even ground: by the box, the object's size and the ground's height.
    pub by_box_m: f64,
    /// Standard deviation of the height there, metres, of ground as uneven as it is configured to be.
    pub configured_m: f64,
}
