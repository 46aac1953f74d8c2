//! Who is who: the only memory, of objects and of the ground they stand on.
//!
//! [`LeftToRight`] is the paper's way (docs/method.md, section 7): objects keep their places in the row.

mod ground_memory;
pub mod left_to_right;

pub use left_to_right::LeftToRight;
