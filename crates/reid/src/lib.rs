//! Who is who: the only memory, of objects and of the ground they stand on.
//!
//! [`Tracker`] follows objects in the steady frame, one identity for one object. [`ByCamera`] has the baselines (docs/method.md, section 7): the paper's places from left to right, and overlap.

mod assignment;
pub mod by_bearing;
pub mod by_camera;
mod ground_memory;
pub mod rule;
pub mod tracking;
mod unevenness;

pub use by_bearing::ByBearing;
pub use by_camera::ByCamera;
pub use rule::Rule;
pub use tracking::{Tracker, TrackingOptions};
