//! OpenCV's two calibrations, plain and fisheye.

use crate::{
    board_views::BoardView,
    intrinsics::{CameraError, Lens},
};
use opencv::{
    calib3d::{
        self, CALIB_FIX_K3, Fisheye_CALIB_FIX_SKEW, Fisheye_CALIB_RECOMPUTE_EXTRINSIC,
        calibrate_camera_extended, get_optimal_new_camera_matrix_def,
    },
    core::{
        Mat, Point2f, Point3f, Size, TermCriteria, TermCriteria_COUNT, TermCriteria_EPS, Vec3d,
        Vector,
    },
    prelude::*,
};
use roadwatch_core::ImageSize;

/// Steps of OpenCV's own least squares, and the change at which they end.
const MOST_STEPS: i32 = 100;
const CONVERGED: f64 = 1e-9;

/// What OpenCV says.
pub(crate) struct Raw {
    pub(crate) camera: Mat,
    pub(crate) distortion: Mat,
    pub(crate) turns: Vector<Vec3d>,
    pub(crate) shifts: Vector<Vec3d>,
    pub(crate) std_px: Option<[f64; 4]>,
}

impl Raw {
    /// Calibrates a lens of that kind.
    pub(crate) fn fit(
        views: &[&BoardView],
        size: ImageSize,
        lens: Lens,
    ) -> Result<Self, CameraError> {
        match lens {
            Lens::PlumbBob => fit_plumb_bob(views, size),
            Lens::Equidistant => fit_equidistant(views, size),
        }
    }
}

/// Corners on the boards, and in the pictures.
type Pairs = (Vector<Vector<Point3f>>, Vector<Vector<Point2f>>);

fn pairs(views: &[&BoardView]) -> Pairs {
    let on_board = |view: &&BoardView| {
        let corners = view.corners.board_m.iter();
        corners
            .map(|[x, y]| Point3f::new(*x as f32, *y as f32, 0.0))
            .collect()
    };
    let in_picture = |view: &&BoardView| {
        let corners = view.corners.pixels.iter();
        corners
            .map(|at| Point2f::new(at.x as f32, at.y as f32))
            .collect()
    };
    (
        views.iter().map(on_board).collect(),
        views.iter().map(in_picture).collect(),
    )
}

fn fit_plumb_bob(views: &[&BoardView], size: ImageSize) -> Result<Raw, CameraError> {
    let (on_board, in_picture) = pairs(views);
    let (mut camera, mut distortion) = (Mat::default(), Mat::default());
    let (mut turns, mut shifts) = (Vector::new(), Vector::new());
    let (mut std, mut std_views, mut each) = (Mat::default(), Mat::default(), Mat::default());
    calibrate_camera_extended(
        &on_board,
        &in_picture,
        Size::new(size.width_px as i32, size.height_px as i32),
        &mut camera,
        &mut distortion,
        &mut turns,
        &mut shifts,
        &mut std,
        &mut std_views,
        &mut each,
        CALIB_FIX_K3,
        patience()?,
    )?;
    let mut std_px = [0.0; 4];
    for (at, value) in std_px.iter_mut().enumerate() {
        *value = *std.at::<f64>(at as i32)?;
    }
    Ok(Raw {
        camera,
        distortion,
        turns,
        shifts,
        std_px: Some(std_px),
    })
}

fn fit_equidistant(views: &[&BoardView], size: ImageSize) -> Result<Raw, CameraError> {
    let (on_board, in_picture) = pairs(views);
    let (mut camera, mut distortion) = (Mat::default(), Mat::default());
    let (mut turns, mut shifts) = (Vector::new(), Vector::new());
    calib3d::calibrate(
        &on_board,
        &in_picture,
        Size::new(size.width_px as i32, size.height_px as i32),
        &mut camera,
        &mut distortion,
        &mut turns,
        &mut shifts,
        Fisheye_CALIB_RECOMPUTE_EXTRINSIC | Fisheye_CALIB_FIX_SKEW,
        patience()?,
    )?;
    Ok(Raw {
        camera,
        distortion,
        turns,
        shifts,
        std_px: None,
    })
}

fn patience() -> opencv::Result<TermCriteria> {
    TermCriteria::new(TermCriteria_COUNT + TermCriteria_EPS, MOST_STEPS, CONVERGED)
}

/// Of the rectified image.
pub(crate) fn projection(raw: &Raw, size: ImageSize, lens: Lens) -> Result<[f64; 12], CameraError> {
    let size = Size::new(size.width_px as i32, size.height_px as i32);
    let new = match lens {
        Lens::PlumbBob => {
            get_optimal_new_camera_matrix_def(&raw.camera, &raw.distortion, size, 0.0)?
        }
        Lens::Equidistant => raw.camera.clone(),
    };
    let mut projection = [0.0; 12];
    for row in 0..3 {
        for column in 0..3 {
            projection[(row * 4 + column) as usize] = *new.at_2d::<f64>(row, column)?;
        }
    }
    Ok(projection)
}
