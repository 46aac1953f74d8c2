//! From what a `camera_info` file says to a lens that can be.

use super::{CameraInfo, numbers::is_rotation};
use roadwatch_core::{CameraModel, Distortion, ImageSize, Intrinsics};
use serde::Deserialize;

/// More columns or rows than any sensor has.
const MAX_SIDE_PX: u32 = 16_384;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    image_width: u32,
    image_height: u32,
    #[serde(default)]
    camera_name: String,
    camera_matrix: Matrix,
    distortion_model: String,
    distortion_coefficients: Matrix,
    #[serde(default)]
    rectification_matrix: Option<Matrix>,
    #[serde(default)]
    projection_matrix: Option<Matrix>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

/// A key, and what is wrong with it.
type Wrong = (&'static str, String);

pub(super) fn check(file: File) -> Result<CameraInfo, Wrong> {
    let size = ImageSize {
        width_px: side("image_width", file.image_width)?,
        height_px: side("image_height", file.image_height)?,
    };
    let camera: [f64; 9] = of_size("camera_matrix", file.camera_matrix, (3, 3))?;
    let intrinsics = intrinsics(&camera)?;
    let distortion = distortion(&file.distortion_model, file.distortion_coefficients)?;
    if let Some(given) = file.rectification_matrix {
        const KEY: &str = "rectification_matrix";
        if !is_rotation(&of_size(KEY, given, (3, 3))?) {
            let what = "not a rotation: its rows must have length 1 and stand at right angles";
            return Err((KEY, what.to_owned()));
        }
    }
    let [fx, _, cx, _, fy, cy, ..] = camera;
    let plain = [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0];
    let projection = file.projection_matrix.map(|given| {
        const KEY: &str = "projection_matrix";
        let given: [f64; 12] = of_size(KEY, given, (3, 4))?;
        let focals = [("fx", given[0]), ("fy", given[5])];
        focals
            .into_iter()
            .try_for_each(|(name, value)| positive(KEY, name, value))?;
        Ok(given)
    });
    Ok(CameraInfo {
        name: file.camera_name,
        model: CameraModel {
            size,
            intrinsics,
            distortion,
        },
        projection: projection.transpose()?.unwrap_or(plain),
    })
}

fn side(key: &'static str, pixels: u32) -> Result<u32, Wrong> {
    let possible = (1..=MAX_SIDE_PX).contains(&pixels);
    let what = || format!("{pixels} is out of range; expected 1 to {MAX_SIDE_PX}");
    possible.then_some(pixels).ok_or_else(|| (key, what()))
}

/// The numbers of a matrix that must have these rows and columns.
fn of_size<const N: usize>(
    key: &'static str,
    given: Matrix,
    (rows, cols): (usize, usize),
) -> Result<[f64; N], Wrong> {
    let found = given.data.len();
    let what = format!(
        "expected {rows} x {cols} with {N} numbers, found {} x {} with {found}",
        given.rows, given.cols
    );
    if (given.rows, given.cols) != (rows, cols) {
        return Err((key, what));
    }
    if let Some(wrong) = given.data.iter().find(|value| !value.is_finite()) {
        return Err((key, format!("{wrong} is not a finite number")));
    }
    given.data.try_into().map_err(|_| (key, what))
}

fn intrinsics(
    &[fx, skew, cx, zero, fy, cy, ref last @ ..]: &[f64; 9],
) -> Result<Intrinsics, Wrong> {
    const KEY: &str = "camera_matrix";
    positive(KEY, "fx", fx)?;
    positive(KEY, "fy", fy)?;
    if skew != 0.0 || zero != 0.0 || last != &[0.0, 0.0, 1.0] {
        let what = "expected the form [fx, 0, cx, 0, fy, cy, 0, 0, 1]";
        return Err((KEY, what.to_owned()));
    }
    Ok(Intrinsics { fx, fy, cx, cy })
}

fn positive(key: &'static str, name: &str, focal: f64) -> Result<(), Wrong> {
    if focal > 0.0 {
        return Ok(());
    }
    let what = format!("{name} is {focal}: expected a focal length above 0, in pixels");
    Err((key, what))
}

fn distortion(model: &str, given: Matrix) -> Result<Distortion, Wrong> {
    const KEY: &str = "distortion_coefficients";
    let count = given.data.len();
    if given.rows.saturating_mul(given.cols) != count {
        let what = format!(
            "{} x {} numbers are announced, {count} are there",
            given.rows, given.cols
        );
        return Err((KEY, what));
    }
    if let Some(wrong) = given.data.iter().find(|value| !value.is_finite()) {
        return Err((KEY, format!("{wrong} is not a finite number")));
    }
    if matches!(model, "" | "none") && given.data.iter().any(|k| *k != 0.0) {
        let what = "coefficients are given, but no model: name one, such as plumb_bob";
        return Err(("distortion_model", what.to_owned()));
    }
    Distortion::from_ros(model, &given.data)
        .map_err(|error| ("distortion_model", error.to_string()))
}
