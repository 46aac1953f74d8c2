//! Which way a located object points, from what one frame shows of it (docs/method.md, sections 4 to 6).
//!
//! A box becomes a [`Crop`] of one size, a small network over a detector's features finds key components in it
//! ([`ComponentNetwork`]), their columns make a [`Row`], and a [`Forest`] turns the row into an observation angle,
//! which the ray to the object turns into a heading. [`decide`] weighs that against the headings that the object's
//! place allows. Nothing here remembers earlier frames.

pub mod angle;
pub mod crop;
pub mod decision;
pub mod estimator;
pub mod forest;
pub mod network;
pub mod position_curve;
pub mod recipe;
pub mod row;

pub use angle::{ObservationAngle, RayAngle, Yaw};
pub use crop::Crop;
pub use decision::decide;
pub use estimator::{Calibration, EstimatorError, KeyComponentEstimator, RotationOptions};
pub use forest::{Forest, ForestFileError, ForestOptions, Turned};
pub use network::{ComponentModelError, ComponentNetwork};
pub use position_curve::{PositionCurve, PositionCurveError};
pub use recipe::Recipe;
pub use row::{Component, LabelledRow, Row, RowTable};
