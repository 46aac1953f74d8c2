//! A chessboard as a camera of known lens photographed it.

#[path = "../../../calibrate/tests/support/rendered_board.rs"]
mod rendered_board;

use rendered_board::{chessboard, poses, render};
use roadwatch_core::{CameraModel, Distortion, ImageSize, Intrinsics};
use roadwatch_picture::Canvas;
use std::path::Path;

/// The command that calibrates from it.
pub(crate) const BOARD: [&str; 7] = [
    "calibrate",
    "camera",
    "--board",
    "8x6",
    "--square-m",
    "0.1",
    "--json",
];

/// Writes pictures of a chessboard with 8 x 6 inner corners and gives the camera that saw it.
pub(crate) fn photograph(folder: &Path) -> CameraModel {
    let camera = CameraModel {
        size: ImageSize {
            width_px: 640,
            height_px: 400,
        },
        intrinsics: Intrinsics {
            fx: 500.0,
            fy: 503.0,
            cx: 327.0,
            cy: 195.0,
        },
        distortion: Distortion::BrownConrady([-0.2, 0.05, 0.0005, -0.0005, 0.0, 0.0, 0.0, 0.0]),
    };
    for (at, pose) in poses(&camera, (0.7, 0.5)).iter().enumerate() {
        let picture = render(&camera, pose, &chessboard(8, 6, 0.1));
        let file = folder.join(format!("{at:02}.png"));
        let canvas = Canvas::of_image(&picture).expect("a picture");
        canvas.write(&file).expect("written");
    }
    camera
}
