//! A mount from points of known place: marks on the ground, a tape, and where they are in the image.

use crate::{
    csv_rows::{self, Columns, RowError},
    least_squares::{Minimum, Normal, minimise},
    mount_estimate::{Free, MountEstimate},
};
use nalgebra::{DVector, Vector2};
use roadwatch_core::{
    CameraModel, Mount,
    camera_model::Pixel,
    space::{BaseLink, Point},
};
use std::{f64::consts::TAU, path::Path};

const COLUMNS: Columns = Columns {
    required: &["u", "v", "x", "y"],
    optional: &["z"],
};
/// Marks are clicked to about this, pixels. Deviations never claim less noise, for few points fit too well.
const LEAST_NOISE_PX: f64 = 0.5;
/// Directions from which a fit begins, so that a camera whose yaw nobody knows is found too.
const STARTS: u32 = 8;

/// A point of known place, and where it is in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPoint {
    /// Its line in the file, from 1.
    pub line: u64,
    /// Where it is seen.
    pub pixel: Pixel,
    /// Where it is.
    pub place: Point<BaseLink>,
}

/// What of the mount is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solve {
    /// Yaw, pitch, roll.
    Angles,
    /// The angles and the height.
    Height,
    /// The angles and the whole position.
    Position,
}

impl Solve {
    const fn free(self) -> &'static [Free] {
        use Free::{Pitch, Roll, X, Y, Yaw, Z};
        match self {
            Self::Angles => &[Yaw, Pitch, Roll],
            Self::Height => &[Yaw, Pitch, Roll, Z],
            Self::Position => &[Yaw, Pitch, Roll, Z, X, Y],
        }
    }

    /// Fewest points: two numbers each, and at least one more than is looked for; three points leave a
    /// position four answers (Grunert 1841).
    const fn least_points(self) -> usize {
        match self {
            Self::Angles => 2,
            Self::Height => 3,
            Self::Position => 4,
        }
    }
}

/// The mount, and how well it explains the points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointsFit {
    /// The mount.
    pub estimate: MountEstimate,
    /// From where each point is seen to where the mount puts it, pixels, in the order of the points.
    pub residuals_px: Vec<Vector2<f64>>,
}

/// Points that give no mount.
#[derive(Debug, thiserror::Error)]
pub enum PointsError {
    /// The file is wrong.
    #[error(transparent)]
    Rows(#[from] RowError),
    /// Too few points.
    #[error("{found} points are too few: {needed} are needed for what is looked for")]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Points on the ground are seen above the horizon.
    #[error(
        "line {line}: row {row_px:.0} lies above the horizon of the mount that the points give, so nothing on the \
         ground can be there: check u and v, or leave the point out"
    )]
    AboveHorizon {
        /// The line of the first.
        line: u64,
        /// Its row, pixels.
        row_px: f64,
    },
    /// Nothing explains them.
    #[error(
        "no mount explains the points: they may lie in one line, or u,v and x,y may be swapped"
    )]
    Undetermined,
}

/// Reads `u,v,x,y[,z]`: pixels, and metres in base_link; `ground_z_m` where there is no column z.
///
/// # Errors
/// With file and line, see [`RowError`].
pub fn read_points(file: &Path, ground_z_m: f64) -> Result<Vec<GroundPoint>, PointsError> {
    let rows = csv_rows::read(file, &COLUMNS)?;
    let points = rows.into_iter().map(|row| {
        let number = |at: usize| row.numbers[at].unwrap_or(ground_z_m);
        GroundPoint {
            line: row.line,
            pixel: Pixel::new(number(0), number(1)),
            place: Point::new(number(2), number(3), number(4)),
        }
    });
    Ok(points.collect())
}

/// The mount from which the points are seen where they are seen, by robust nonlinear least squares over
/// reprojection errors; what is not looked for stays as in `start`.
///
/// # Errors
/// With too few points, points above the horizon, or points that no mount explains.
pub fn mount_from_points(
    model: &CameraModel,
    start: &Mount,
    points: &[GroundPoint],
    solve: Solve,
) -> Result<PointsFit, PointsError> {
    let needed = solve.least_points();
    if points.len() < needed {
        let found = points.len();
        return Err(PointsError::TooFew { found, needed });
    }
    let free = solve.free();
    let (begun, found) = best(model, start, points, free).ok_or(PointsError::Undetermined)?;
    let mount = Free::moved(free, &begun, &found.at);
    check_horizon(model, &mount, points)?;
    let residuals = residuals(model, &mount, points).ok_or(PointsError::Undetermined)?;
    let covariance = found.covariance().ok_or(PointsError::Undetermined)?;
    let left_over = (2 * points.len()).saturating_sub(free.len()).max(1) as f64;
    let noise_px = (2.0 * found.normal.cost / left_over)
        .sqrt()
        .max(LEAST_NOISE_PX);
    Ok(PointsFit {
        estimate: MountEstimate {
            mount,
            std: Free::deviations(free, &(covariance * noise_px.powi(2))),
        },
        residuals_px: residuals,
    })
}

/// The lowest of the minima found from several directions, with the mount it was begun at.
fn best(
    model: &CameraModel,
    start: &Mount,
    points: &[GroundPoint],
    free: &[Free],
) -> Option<(Mount, Minimum)> {
    let steps = vec![Free::STEP; free.len()];
    let from = |turn: u32| {
        let begun = Mount {
            yaw_rad: start.yaw_rad + TAU * f64::from(turn) / f64::from(STARTS),
            ..*start
        };
        let errors = |by: &DVector<f64>| {
            let all = residuals(model, &Free::moved(free, &begun, by), points)?;
            Some(
                all.into_iter()
                    .flat_map(|error| [error.x, error.y])
                    .collect(),
            )
        };
        let normal = |by: &DVector<f64>| Normal::of_residuals(by, &steps, &errors);
        Some((begun, minimise(DVector::zeros(free.len()), &normal)?))
    };
    (0..STARTS)
        .filter_map(from)
        .min_by(|(_, a), (_, b)| a.normal.cost.total_cmp(&b.normal.cost))
}

/// `None` when a point is behind the camera.
fn residuals(
    model: &CameraModel,
    mount: &Mount,
    points: &[GroundPoint],
) -> Option<Vec<Vector2<f64>>> {
    let optical_from_base = mount.base_from_optical().inverse();
    let seen = points.iter().map(|point| {
        let pixel = model.project(optical_from_base * point.place)?;
        Some(pixel - point.pixel)
    });
    seen.collect()
}

/// What lies below the camera is not seen above the horizon.
fn check_horizon(
    model: &CameraModel,
    mount: &Mount,
    points: &[GroundPoint],
) -> Result<(), PointsError> {
    let base_from_optical = mount.base_from_optical();
    let rises = |point: &&GroundPoint| {
        let ray = model.ray(point.pixel);
        let is_below = point.place.z() < mount.position_m[2];
        is_below && ray.is_some_and(|ray| base_from_optical.rotate(ray).z >= 0.0)
    };
    match points.iter().find(rises) {
        None => Ok(()),
        Some(point) => Err(PointsError::AboveHorizon {
            line: point.line,
            row_px: point.pixel.y,
        }),
    }
}
