//! Calibration: focal values, lenses and mounts from what cameras saw.
//!
//! Every estimate comes with standard deviations from the information matrix of its fit, and with what it had
//! to trust. Nothing here writes a user's file.

pub mod board;
pub mod board_views;
mod csv_rows;
pub mod drive;
mod drive_fit;
pub mod focal;
pub mod intrinsics;
mod least_squares;
pub mod mount_drive;
pub mod mount_estimate;
pub mod mount_lines;
pub mod mount_points;
mod opencv_fit;
mod size_model;
mod track_effect;

pub use board::{Board, BoardKind, Corners, NoCorners, UnreadablePicture, read_picture};
pub use board_views::{Alike, BoardView, BoardViews, OtherSize, Unused, UnusedView};
pub use csv_rows::RowError;
pub use drive::{BoxSighting, LeftOut, SeenBox, Sightings};
pub use focal::{FocalError, FocalFit, KnownObject};
pub use intrinsics::{CameraCalibration, CameraError, Lens, ViewFit, calibrate};
pub use mount_drive::{DriveError, DriveFit, DriveOptions, Trust, mount_from_drive};
pub use mount_estimate::{Free, MountEstimate, MountStd};
pub use mount_lines::{LineSegment, LinesError, LinesFit, mount_from_lines, read_lines};
pub use mount_points::{
    GroundPoint, PointsError, PointsFit, Solve, mount_from_points, read_points,
};
