//! Pitch and yaw from lines on the road that are parallel to the vehicle, and the height from a lane's width.

use crate::{
    csv_rows::{self, Columns, RowError},
    least_squares::{Normal, minimise},
    mount_estimate::{Free, MountEstimate},
};
use nalgebra::{DVector, Vector2, Vector3};
use roadwatch_core::{CameraModel, Mount, camera_model::Pixel};
use std::path::Path;

const COLUMNS: Columns = Columns {
    required: &["u1", "v1", "u2", "v2"],
    optional: &[],
};
const FREE: [Free; 2] = [Free::Yaw, Free::Pitch];
/// Ends of painted lines are clicked to about this, pixels. Deviations never claim less noise.
const LEAST_NOISE_PX: f64 = 0.5;
/// A deviation beyond this means that the lines say next to nothing, radians (3 degrees).
const USELESS_STD_RAD: f64 = 0.052;
/// Pitches and yaws from which a fit begins, radians apart (10 degrees), and how many to either side.
const START_STEP_RAD: f64 = 0.175;
const STARTS: i32 = 2;
/// Shorter than this a segment has no direction, pixels.
const SHORTEST_PX: f64 = 5.0;

/// A piece of a line in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSegment {
    /// Its line in the file, from 1.
    pub line: u64,
    /// Its ends.
    pub ends: [Pixel; 2],
}

/// The mount, and how well it explains the lines.
#[derive(Clone, Debug, PartialEq)]
pub struct LinesFit {
    /// The mount; roll and position as they were, but for the height where a lane's width was given.
    pub estimate: MountEstimate,
    /// Where lines along the vehicle's x axis meet in the image; `None` where that has no pixel.
    pub vanishing_point: Option<Pixel>,
    /// Distance of each segment's ends from the line through its middle and the vanishing point, pixels.
    pub residuals_px: Vec<f64>,
}

/// Lines that give no mount.
#[derive(Debug, thiserror::Error)]
pub enum LinesError {
    /// The file is wrong.
    #[error(transparent)]
    Rows(#[from] RowError),
    /// Fewer than two.
    #[error("{found} line segments are too few: two that are parallel on the ground are needed")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// A segment too short to have a direction.
    #[error(
        "line {line}: the segment is shorter than 5 px; give two points far apart on the same line"
    )]
    TooShort {
        /// Its line.
        line: u64,
    },
    /// A segment that the lens model has no rays for.
    #[error("line {line}: the lens model ends before this pixel")]
    NoRay {
        /// Its line.
        line: u64,
    },
    /// On the ground, but seen above the horizon.
    #[error(
        "line {line}: the segment lies above the horizon of the mount that the lines give, so it is not on the ground"
    )]
    AboveHorizon {
        /// Its line.
        line: u64,
    },
    /// They do not meet, or the camera looks sideways.
    #[error(
        "the lines determine no pitch and yaw: they must be at least two different lines along the vehicle's x \
         axis, and the camera must look along it rather than across"
    )]
    Undetermined,
    /// No two lines stand apart.
    #[error("the segments lie on one line: a lane's width needs both of its borders")]
    OneLine,
}

/// Reads `u1,v1,u2,v2`, pixels.
///
/// # Errors
/// With file and line, see [`RowError`].
pub fn read_lines(file: &Path) -> Result<Vec<LineSegment>, LinesError> {
    let rows = csv_rows::read(file, &COLUMNS)?;
    let segment = |row: csv_rows::Row| {
        let number = |at: usize| row.numbers[at].unwrap_or(0.0);
        LineSegment {
            line: row.line,
            ends: [
                Pixel::new(number(0), number(1)),
                Pixel::new(number(2), number(3)),
            ],
        }
    };
    Ok(rows.into_iter().map(segment).collect())
}

/// Pitch and yaw under which all segments point at one vanishing point, that of the vehicle's x axis. One
/// vanishing point says nothing about roll, which stays as in `start`. With `lane_width_m`, the distance between
/// the two lines that the segments lie on, the height over the ground at `ground_z_m` follows too.
///
/// # Errors
/// With fewer than two segments, segments too short, outside the lens model or above the horizon, or lines that
/// determine nothing.
pub fn mount_from_lines(
    model: &CameraModel,
    start: &Mount,
    segments: &[LineSegment],
    (lane_width_m, ground_z_m): (Option<f64>, f64),
) -> Result<LinesFit, LinesError> {
    check(model, segments)?;
    let residuals = |mount: &Mount| distances_px(model, mount, segments);
    let errors_from =
        |begun: Mount| move |by: &DVector<f64>| residuals(&Free::moved(&FREE, &begun, by));
    let found = starts(start).into_iter().filter_map(|begun| {
        let errors = errors_from(begun);
        let normal =
            |by: &DVector<f64>| Normal::of_residuals(by, &[Free::STEP, Free::STEP], &errors);
        Some((begun, minimise(DVector::zeros(2), &normal)?))
    });
    let found = found.min_by(|(_, a), (_, b)| a.normal.cost.total_cmp(&b.normal.cost));
    let (begun, found) = found.ok_or(LinesError::Undetermined)?;
    let mut mount = Free::moved(&FREE, &begun, &found.at);
    let residuals_px = residuals(&mount).ok_or(LinesError::Undetermined)?;
    // A segment's two ends mirror each other about its middle, so that it is one observation.
    let left_over = segments.len().saturating_sub(2).max(1) as f64;
    let noise_px = (2.0 * found.normal.cost / left_over)
        .sqrt()
        .max(LEAST_NOISE_PX);
    let covariance = found.covariance().ok_or(LinesError::Undetermined)? * noise_px.powi(2);
    let mut std = Free::deviations(&FREE, &covariance);
    let mut angles = [std.pitch_rad, std.yaw_rad].into_iter().flatten();
    if angles.any(|angle| angle > USELESS_STD_RAD) {
        return Err(LinesError::Undetermined);
    }
    let lateral = laterals(model, &mount, segments)?;
    if let Some(width_m) = lane_width_m {
        let (height_m, std_m) = height(&lateral, width_m)?;
        mount.position_m[2] = ground_z_m + height_m;
        std.position_m[2] = Some(std_m.hypot(height_m * noise_share(model, segments, noise_px)));
    }
    Ok(LinesFit {
        vanishing_point: vanishing_point(model, &mount),
        estimate: MountEstimate { mount, std },
        residuals_px,
    })
}

fn check(model: &CameraModel, segments: &[LineSegment]) -> Result<(), LinesError> {
    if segments.len() < 2 {
        let found = segments.len();
        return Err(LinesError::TooFew { found });
    }
    for segment in segments {
        let [a, b] = segment.ends;
        if (a - b).norm() < SHORTEST_PX {
            return Err(LinesError::TooShort { line: segment.line });
        }
        if model.ray(a).is_none() || model.ray(b).is_none() {
            return Err(LinesError::NoRay { line: segment.line });
        }
    }
    Ok(())
}

fn starts(start: &Mount) -> Vec<Mount> {
    let moved = |(yaw, pitch): (i32, i32)| Mount {
        yaw_rad: start.yaw_rad + f64::from(yaw) * START_STEP_RAD,
        pitch_rad: start.pitch_rad + f64::from(pitch) * START_STEP_RAD,
        ..*start
    };
    let steps = -STARTS..=STARTS;
    let all = steps
        .clone()
        .flat_map(|yaw| steps.clone().map(move |pitch| (yaw, pitch)));
    all.map(moved).collect()
}

/// The vehicle's x axis in a camera's optical axes; the end in front of the camera.
fn ahead(mount: &Mount) -> Vector3<f64> {
    let axis = mount.base_from_optical().inverse().rotate(Vector3::x());
    axis * axis.z.signum()
}

fn vanishing_point(model: &CameraModel, mount: &Mount) -> Option<Pixel> {
    model.project(roadwatch_core::space::Point::from_coords(
        ahead(mount).into(),
    ))
}

/// How far the ends of each segment are from the plane through its middle and the vanishing direction, two per
/// segment, pixels at the focal length; `None` where the axis is across the image.
fn distances_px(model: &CameraModel, mount: &Mount, segments: &[LineSegment]) -> Option<Vec<f64>> {
    let axis = ahead(mount);
    let distance = |segment: &LineSegment| {
        let [a, b] = segment.ends.map(|end| model.ray(end));
        let (a, b) = (a?, b?);
        let plane = ((a + b) / 2.0).cross(&axis);
        // A plane cuts the image at z = 1 in a line whose normal is the plane's own x and y.
        let scale = model.intrinsics.fx / plane.xy().norm().max(f64::EPSILON);
        Some([plane.dot(&a) * scale, plane.dot(&b) * scale])
    };
    let all: Option<Vec<_>> = segments.iter().map(distance).collect();
    Some(all?.into_iter().flatten().collect())
}

/// Where each segment's line lies to the left of the camera, in heights of the camera.
fn laterals(
    model: &CameraModel,
    mount: &Mount,
    segments: &[LineSegment],
) -> Result<Vec<f64>, LinesError> {
    let base_from_optical = mount.base_from_optical();
    let lateral = |segment: &LineSegment| {
        let [a, b] = segment.ends.map(|end| {
            let ray = model.ray(end).map(|ray| base_from_optical.rotate(ray));
            ray.filter(|ray| ray.z < 0.0).map(|ray| ray.y / -ray.z)
        });
        // The nearer end says it better, but either stands for a line that is straight.
        let above = LinesError::AboveHorizon { line: segment.line };
        a.zip(b).map(|(a, b)| (a + b) / 2.0).ok_or(above)
    };
    segments.iter().map(lateral).collect()
}

/// Height in metres and its deviation by how the segments of each line scatter.
fn height(lateral: &[f64], width_m: f64) -> Result<(f64, f64), LinesError> {
    let mut sorted = lateral.to_vec();
    sorted.sort_by(f64::total_cmp);
    let gap = (1..sorted.len()).max_by(|&a, &b| {
        let gap = |at: usize| sorted[at] - sorted[at - 1];
        gap(a).total_cmp(&gap(b))
    });
    let (right, left) = sorted.split_at(gap.ok_or(LinesError::OneLine)?);
    let (right, left) = (mean_and_error(right), mean_and_error(left));
    let apart = left.x - right.x;
    let error = right.y.hypot(left.y);
    if apart <= 3.0 * error || apart < f64::EPSILON.sqrt() {
        return Err(LinesError::OneLine);
    }
    let height_m = width_m / apart;
    Ok((height_m, height_m * error / apart))
}

/// Mean, and its standard error (zero for one).
fn mean_and_error(values: &[f64]) -> Vector2<f64> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Vector2::new(mean, (squares / (count - 1.0).max(1.0) / count).sqrt())
}

/// Which share of the lane's width in the image the noise of two borders is, where it is seen widest.
fn noise_share(model: &CameraModel, segments: &[LineSegment], noise_px: f64) -> f64 {
    let columns = segments
        .iter()
        .flat_map(|segment| segment.ends.map(|end| end.x));
    let (least, most) = columns.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(x), b.max(x))
    });
    let width_px = (most - least).clamp(1.0, f64::from(model.size.width_px));
    noise_px * std::f64::consts::SQRT_2 / width_px
}
