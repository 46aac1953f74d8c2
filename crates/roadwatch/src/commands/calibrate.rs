//! `roadwatch calibrate`.

mod board_pictures;
pub mod camera;
mod camera_report;
mod drive_boxes;
pub mod focal;
pub mod mount;
mod mount_report;
pub mod rotation;
mod still;

use crate::{cli::CalibrateCommand, failure::Failure};

/// Calibrates what the command names.
///
/// # Errors
/// See each command.
pub fn run(command: &CalibrateCommand) -> Result<(), Failure> {
    match command {
        CalibrateCommand::Focal(args) => focal::run(args),
        CalibrateCommand::Camera(args) => camera::run(args),
        CalibrateCommand::Mount(args) => mount::run(args),
        CalibrateCommand::Rotation(args) => rotation::run(args),
    }
}
