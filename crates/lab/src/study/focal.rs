//! How much F and the assumed height matter (the paper, Fig. 4 and 5).

use super::{
    scene::{Shape, in_camera},
    trial::{Bench, SeenIn, TrialError, by_height, true_height_m},
};
use crate::{
    sample::Sample,
    score::{Figures, score_range},
};
use roadwatch_core::{ImageSize, rig::MeasuredFocal};
use serde::Serialize;

/// The paper's four measurements: heights `W` of a vehicle seen `P` px high at `D` m.
pub const PUBLISHED: [f64; 4] = [1.4, 2.0, 1.55, 1.7];
const PUBLISHED_HEIGHT_PX: f64 = 55.0;
const PUBLISHED_AT_M: f64 = 50.0;
/// Rows of the image that the paper's F belongs to.
const PUBLISHED_ROWS: u32 = 1080;
/// The errors of height that the paper speaks of, and their mirror images, metres.
pub const HEIGHT_ERRORS_M: [f64; 4] = [-0.4, -0.2, 0.2, 0.4];
/// Curves over F run from and to, px, in steps.
const FOCAL_PX: (u32, u32, usize) = (900, 2200, 25);
/// Curves over errors of height run this far to both sides, in steps, centimetres.
const HEIGHT_CM: (i32, usize) = (50, 5);

/// How good eq. 2 is at one setting.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// The setting: F in px, or an error of height in m.
    pub at: f64,
    /// Mean of `1 - |d - d'| / d`.
    pub accuracy: Option<f64>,
    /// Share of places with an accuracy of at least 90 %.
    pub coverage_90: Option<f64>,
}

/// The accuracy at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heat {
    /// Along the optical axis, metres.
    pub along_m: f64,
    /// To its right, metres.
    pub aside_m: f64,
    /// `1 - |d - d'| / d`.
    pub accuracy: f64,
}

/// One of the paper's F values.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedFocal {
    /// The height that it was measured with, metres.
    pub size_m: f64,
    /// F, px of an image 1080 rows high.
    pub focal: MeasuredFocal,
    /// How good it is here; `at` is F.
    pub point: Point,
    /// Place by place.
    pub heat: Vec<Heat>,
}

/// Everything about F and heights, over the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct FocalStudy {
    /// F where only the height is wrong.
    pub right: MeasuredFocal,
    /// The paper's F values with the real height in eq. 2.
    pub published: Vec<PublishedFocal>,
    /// Over F, with the real height in eq. 2.
    pub over_focal: Vec<Point>,
    /// Over errors of height in eq. 2, with the right F.
    pub in_distance: Vec<Point>,
    /// Over errors of height in eq. 1, which measures F, with the real height in eq. 2.
    pub in_focal: Vec<Point>,
}

impl FocalStudy {
    /// The point of a curve at an error of height.
    #[must_use]
    pub fn at(curve: &[Point], error_m: f64) -> Option<&Point> {
        curve.iter().find(|point| (point.at - error_m).abs() < 1e-6)
    }
}

/// F of one of the paper's measurements.
pub(super) fn published_focal(size_m: f64) -> MeasuredFocal {
    let (height_px, at_m) = (PUBLISHED_HEIGHT_PX, PUBLISHED_AT_M);
    MeasuredFocal::from_known_object(height_px, at_m, size_m, PUBLISHED_ROWS)
}

pub(super) fn study(bench: &Bench<'_>) -> Result<Option<FocalStudy>, TrialError> {
    let seen = bench.seen(Shape::Grid);
    let Some((scene, _)) = seen.first() else {
        return Ok(None);
    };
    let model = &scene.camera.model;
    let right = bench.measured.map_or_else(
        || focal_of(model.intrinsics.fy, model.size),
        |measured| measured.focal,
    );
    let published = PUBLISHED.into_iter().map(|size_m| published(&seen, size_m));
    let (first, last, step) = FOCAL_PX;
    let focals = (first..=last).step_by(step).map(|focal_px| {
        let focal = MeasuredFocal {
            focal_px: f64::from(focal_px),
            image_height_px: PUBLISHED_ROWS,
        };
        let samples = by_height(&seen, Some(focal), true_height_m)?;
        Ok(point(focal.focal_px, &samples))
    });
    Ok(Some(FocalStudy {
        right,
        published: published.collect::<Result<_, TrialError>>()?,
        over_focal: focals.collect::<Result<_, TrialError>>()?,
        in_distance: errors_m()
            .map(|error_m| in_distance(&seen, right, error_m))
            .collect::<Result<_, _>>()?,
        in_focal: errors_m()
            .map(|error_m| in_focal(&seen, right, error_m))
            .collect::<Result<_, _>>()?,
    }))
}

fn errors_m() -> impl Iterator<Item = f64> {
    let (reach_cm, step) = HEIGHT_CM;
    let errors = (-reach_cm..=reach_cm).step_by(step);
    errors.map(|error_cm| f64::from(error_cm) / 100.0)
}

fn focal_of(focal_px: f64, size: ImageSize) -> MeasuredFocal {
    MeasuredFocal {
        focal_px,
        image_height_px: size.height_px,
    }
}

fn published(seen: &[SeenIn<'_>], size_m: f64) -> Result<PublishedFocal, TrialError> {
    let focal = published_focal(size_m);
    let samples = by_height(seen, Some(focal), true_height_m)?;
    let places = seen.iter().zip(&samples);
    let heat = places.filter_map(|((scene, _), sample)| {
        let found = sample.estimate.as_ref()?;
        let (along_m, aside_m) = in_camera(&sample.target.object, &scene.camera);
        let error = score_range(&[(&sample.target, found)]).mean_relative_error?;
        Some(Heat {
            along_m,
            aside_m,
            accuracy: 1.0 - error,
        })
    });
    Ok(PublishedFocal {
        size_m,
        focal,
        point: point(focal.focal_px, &samples),
        heat: heat.collect(),
    })
}

/// A wrong height in eq. 2 alone.
fn in_distance(
    seen: &[SeenIn<'_>],
    right: MeasuredFocal,
    error_m: f64,
) -> Result<Point, TrialError> {
    let samples = by_height(seen, Some(right), |seen| {
        Some(true_height_m(seen)? + error_m)
    })?;
    Ok(point(error_m, &samples))
}

/// A wrong height in eq. 1 alone: whoever measures F believes the vehicle to be so much higher.
fn in_focal(seen: &[SeenIn<'_>], right: MeasuredFocal, error_m: f64) -> Result<Point, TrialError> {
    let mut samples = Vec::with_capacity(seen.len());
    for vehicle in seen {
        let Some(height_m) = true_height_m(vehicle.1) else {
            continue;
        };
        // P * D of eq. 1 is what the right F was measured from.
        let product = right.focal_px * height_m;
        let rows = right.image_height_px;
        let focal = MeasuredFocal::from_known_object(product, 1.0, height_m + error_m, rows);
        samples.extend(by_height(&[*vehicle], Some(focal), true_height_m)?);
    }
    Ok(point(error_m, &samples))
}

fn point(at: f64, samples: &[Sample]) -> Point {
    let figures = Figures::of(samples);
    let error = figures.distance.mean_relative_error;
    Point {
        at,
        accuracy: error.map(|error| 1.0 - error),
        coverage_90: figures.coverage_90,
    }
}
