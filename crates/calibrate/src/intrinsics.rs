//! Intrinsics and distortion from views of a board (Zhang, A Flexible New Technique for Camera Calibration,
//! 2000), by OpenCV.

use crate::{
    board::Board,
    board_views::{BoardView, BoardViews, Unused},
    opencv_fit::{Raw, projection},
};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use opencv::{
    core::{Mat, Vec3d},
    prelude::*,
};
use roadwatch_core::{
    CameraModel, Distortion, ImageSize, Intrinsics, camera_model::Pixel, space::Point,
};

/// Three views determine a camera; a few more show what is noise.
const LEAST_VIEWS: usize = 6;
/// A view this many times as far off as the median one is left out, if that is more than [`LEAST_OUTLIER_PX`].
const OUTLIER_FACTOR: f64 = 3.0;
const LEAST_OUTLIER_PX: f64 = 0.5;
/// Cells across and down in which corners are looked for to say how much of the image was covered.
const COVERAGE_CELLS: (u32, u32) = (12, 8);

/// Which lens is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// ROS's `plumb_bob`, k1 k2 p1 p2; k3 is held at zero, as ROS's own tool does unless told otherwise.
    PlumbBob,
    /// ROS's `equidistant`, k1 to k4.
    Equidistant,
}

/// One view after the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewFit {
    /// What the picture is called.
    pub name: String,
    /// Root of the mean squared distance of corners from where they should be, pixels.
    pub rms_px: f64,
    /// Where each corner is seen, and where it should be.
    pub corners: Vec<[Pixel; 2]>,
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraCalibration {
    /// The lens.
    pub model: CameraModel,
    /// Standard deviations of fx, fy, cx, cy, pixels; `None` for fisheye lenses, for which OpenCV gives none.
    pub std_px: Option<[f64; 4]>,
    /// Root of the mean squared reprojection error over all corners, pixels.
    pub rms_px: f64,
    /// Every view.
    pub views: Vec<ViewFit>,
    /// Share of the image in which corners were seen, 0 to 1.
    pub coverage: f64,
    /// The 3x4 projection of the rectified image, row by row, as ROS's tool chooses it: no black border.
    pub projection: [f64; 12],
}

/// Views that give no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// No view has the board.
    #[error(
        "none of {pictures} pictures shows a {board}: for a chessboard count the corners where four squares meet, \
         not the squares"
    )]
    NoBoard {
        /// The board.
        board: Board,
        /// How many pictures were looked at.
        pictures: usize,
    },
    /// Too few views have it.
    #[error(
        "the board is found in {found} pictures; {LEAST_VIEWS} are needed, and about 20 do well"
    )]
    TooFew {
        /// How many have it.
        found: usize,
    },
    /// The fit went astray.
    #[error(
        "the views give no possible camera ({what}): show the board tilted and at different distances, and check \
         its size"
    )]
    Impossible {
        /// What came out.
        what: String,
    },
    /// OpenCV fails.
    #[error(
        "OpenCV cannot calibrate from these views: show the board tilted, and in all parts of the image"
    )]
    OpenCv(#[from] opencv::Error),
}

/// Calibrates a camera from all views with a board. Views that fit badly are moved to the unused ones.
///
/// # Errors
/// With too few views, or when no possible camera comes out.
pub fn calibrate(
    board: Board,
    views: &mut BoardViews,
    lens: Lens,
) -> Result<CameraCalibration, CameraError> {
    let Some(size) = views.size.filter(|_| !views.used.is_empty()) else {
        let pictures = views.unused.len();
        return Err(CameraError::NoBoard { board, pictures });
    };
    let first = fit(&enough(&views.used)?, size, lens)?;
    let mut each: Vec<f64> = first.views.iter().map(|view| view.rms_px).collect();
    each.sort_by(f64::total_cmp);
    let limit_px = (OUTLIER_FACTOR * each[each.len() / 2]).max(LEAST_OUTLIER_PX);
    let outliers = first.views.iter().filter(|view| view.rms_px > limit_px);
    let outliers: Vec<_> = outliers
        .map(|view| (view.name.clone(), view.rms_px))
        .collect();
    if outliers.is_empty() {
        return Ok(first);
    }
    for (name, rms_px) in outliers {
        views.used.retain(|view| view.name != name);
        views.skip(&name, Unused::Outlier(rms_px));
    }
    fit(&enough(&views.used)?, size, lens)
}

fn enough(views: &[BoardView]) -> Result<Vec<&BoardView>, CameraError> {
    let found = views.len();
    if found < LEAST_VIEWS {
        return Err(CameraError::TooFew { found });
    }
    Ok(views.iter().collect())
}

fn fit(
    views: &[&BoardView],
    size: ImageSize,
    lens: Lens,
) -> Result<CameraCalibration, CameraError> {
    let raw = Raw::fit(views, size, lens)?;
    let model = CameraModel {
        size,
        intrinsics: intrinsics(&raw.camera)?,
        distortion: distortion(&raw.distortion, lens)?,
    };
    let fits: Vec<ViewFit> = views
        .iter()
        .zip(raw.turns.iter().zip(raw.shifts.iter()))
        .map(|(view, pose)| view_fit(&model, view, pose))
        .collect();
    let corners: Vec<_> = fits.iter().flat_map(|view| &view.corners).collect();
    let squares: f64 = corners
        .iter()
        .map(|[seen, put]| (seen - put).norm_squared())
        .sum();
    Ok(CameraCalibration {
        model,
        std_px: raw.std_px,
        rms_px: (squares / corners.len() as f64).sqrt(),
        coverage: coverage(corners.iter().map(|[seen, _]| *seen), size),
        projection: projection(&raw, size, lens)?,
        views: fits,
    })
}

fn intrinsics(camera: &Mat) -> Result<Intrinsics, CameraError> {
    let at = |row, column| camera.at_2d::<f64>(row, column).copied();
    let k = Intrinsics {
        fx: at(0, 0)?,
        fy: at(1, 1)?,
        cx: at(0, 2)?,
        cy: at(1, 2)?,
    };
    let possible = |focal: f64| focal.is_finite() && focal > 1.0;
    if possible(k.fx) && possible(k.fy) && k.cx.is_finite() && k.cy.is_finite() {
        return Ok(k);
    }
    let what = format!(
        "fx {:.1}, fy {:.1}, cx {:.1}, cy {:.1}",
        k.fx, k.fy, k.cx, k.cy
    );
    Err(CameraError::Impossible { what })
}

fn distortion(coefficients: &Mat, lens: Lens) -> Result<Distortion, CameraError> {
    let all = coefficients.data_typed::<f64>()?;
    let name = match lens {
        Lens::PlumbBob => "plumb_bob",
        Lens::Equidistant => "equidistant",
    };
    Distortion::from_ros(name, all).map_err(|error| CameraError::Impossible {
        what: error.to_string(),
    })
}

fn view_fit(model: &CameraModel, view: &BoardView, (turn, shift): (Vec3d, Vec3d)) -> ViewFit {
    let optical_from_board = Isometry3::from_parts(
        Translation3::new(shift[0], shift[1], shift[2]),
        UnitQuaternion::from_scaled_axis(Vector3::new(turn[0], turn[1], turn[2])),
    );
    let pairs = view.corners.board_m.iter().zip(&view.corners.pixels);
    let corners: Vec<[Pixel; 2]> = pairs
        .filter_map(|(&[x, y], &seen)| {
            let place = optical_from_board * Point3::new(x, y, 0.0);
            Some([seen, model.project(Point::from_coords(place))?])
        })
        .collect();
    let squares: f64 = corners
        .iter()
        .map(|[seen, put]| (seen - put).norm_squared())
        .sum();
    ViewFit {
        name: view.name.clone(),
        rms_px: (squares / corners.len().max(1) as f64).sqrt(),
        corners,
    }
}

fn coverage(corners: impl Iterator<Item = Pixel>, size: ImageSize) -> f64 {
    let (across, down) = COVERAGE_CELLS;
    let cell = |value: f64, whole: u32, cells: u32| {
        let share = ((value + 0.5) / f64::from(whole)).clamp(0.0, 1.0);
        ((share * f64::from(cells)) as u32).min(cells - 1)
    };
    let mut seen: Vec<_> = corners
        .map(|at| {
            (
                cell(at.x, size.width_px, across),
                cell(at.y, size.height_px, down),
            )
        })
        .collect();
    seen.sort_unstable();
    seen.dedup();
    seen.len() as f64 / f64::from(across * down)
}
