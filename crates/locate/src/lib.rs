//! Distance and location of a detected box, with covariance.
//!
//! Every method of docs/method.md, sections 2 and 3, for one camera: triangle similarity, the look-up table
//! with its exact index, and the ground plane. Nothing here sees an image or remembers a frame: what
//! earlier frames know comes in as a [`roadwatch_core::Prior`].

pub mod box_noise;
pub mod camera_locator;
pub mod estimate;
pub mod fused;
pub mod ground;
pub mod hold;
pub mod hull;
pub mod sizes;
pub mod table;
pub mod table_locator;
pub mod triangle;

pub use box_noise::BoxNoise;
pub use camera_locator::{CameraLocator, LocatorError, LocatorOptions};
pub use estimate::Estimate;
pub use fused::{FusedEstimate, FusedLocator, HiddenShares};
pub use ground::{GroundPlane, MountNoise};
pub use hold::HoldOptions;
pub use hull::{GroundPose, HullSpec, SilhouetteCamera};
pub use sizes::{CarCategory, ClassSize, ClassSizes, SizeStatistic, Standing};
pub use table::{
    CalibrationHash, ExpectedDistance, GridSpec, LocationTable, SizeGroup, TableIndex, TableQuery,
    TableRow, Weight, build_table,
};
pub use table_locator::{QueryDistance, SplitMode, TableLocator, TableMismatch, TableOptions};
