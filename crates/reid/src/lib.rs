//! Who is who: the only memory, of objects and of the ground they stand on.
//!
//! [`ByCamera`] has the baselines (docs/method.md, section 7): the paper's places from left to right, and overlap.

pub mod by_camera;
mod ground_memory;
pub mod rule;

pub use by_camera::ByCamera;
pub use rule::Rule;
