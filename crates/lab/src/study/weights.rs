//! What a metre of depth is worth in the look-up table's score (the paper, eq. 7 and Fig. 8).

use super::{
    scene::{GROUND_Z_M, Shape},
    trial::{Bench, SeenIn, TrialError, default_table, per_scene},
};
use crate::{
    sample::Estimator,
    score::{Figures, LocationScore},
};
use roadwatch_core::Method;
use roadwatch_locate::{
    CameraLocator, LocatorOptions, QueryDistance, SplitMode, TableOptions, Weight,
    table::DEFAULT_WEIGHT_WIDTH_PX,
};
use serde::Serialize;
use std::collections::BTreeMap;

/// Weights tried, px per metre at 960 columns; 20 is the default. With none at all the box's middle alone decides.
const WEIGHTS: [f32; 11] = [0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 200.0];
/// Every box is to get a place, whatever the weight makes of its score.
const NO_LIMIT_PX: f32 = 1e6;
/// The class of the table.
const CLASS: &str = "car";

/// A weight as it is configured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", untagged)]
pub enum WeightValue {
    /// Px per metre, at an image width of 960 px.
    PxPerMetre(f32),
    /// The width of the box.
    BoxWidth(&'static str),
}

/// How good one weight is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WeightPoint {
    /// The weight.
    pub weight: WeightValue,
    /// Of the place.
    pub location: LocationScore,
}

/// The sweep, over the cars of the grid and of the scene with all vehicles.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightStudy {
    /// With the expected distance fitted to the table, and split at the optical axis (the default).
    pub fitted: Vec<WeightPoint>,
    /// With plain eq. 2, and split at half the image's width (as the paper prints it).
    pub literal: Vec<WeightPoint>,
}

pub(super) fn study(bench: &Bench<'_>) -> Result<Option<WeightStudy>, TrialError> {
    let all = [bench.seen(Shape::Grid), bench.seen(Shape::Vehicles)].concat();
    let is_car = |(_, seen): &SeenIn<'_>| {
        seen.detection.class.as_str() == CLASS && seen.target.object.class == CLASS
    };
    let cars: Vec<_> = all.into_iter().filter(is_car).collect();
    if cars.is_empty() {
        return Ok(None);
    }
    let fitted = sweep(&cars, SplitMode::Axis, QueryDistance::Fitted)?;
    let literal = sweep(&cars, SplitMode::Literal, QueryDistance::Literal)?;
    Ok(Some(WeightStudy { fitted, literal }))
}

fn sweep(
    seen: &[SeenIn<'_>],
    split: SplitMode,
    distance: QueryDistance,
) -> Result<Vec<WeightPoint>, TrialError> {
    let mut tables = BTreeMap::new();
    for (scene, _) in seen {
        if !tables.contains_key(&scene.folder) {
            tables.insert(&scene.folder, default_table(&scene.camera)?);
        }
    }
    let numbers = WEIGHTS.into_iter().map(WeightValue::PxPerMetre);
    let weights = numbers.chain([WeightValue::BoxWidth("box_width")]);
    let points = weights.map(|value| {
        let options = TableOptions {
            split,
            distance,
            weight: weight(value),
            score_limit_px: NO_LIMIT_PX,
        };
        let samples = per_scene(Estimator::By(Method::Table), seen, |scene| {
            let options = LocatorOptions {
                table: tables.get(&scene.folder).cloned(),
                table_options: options,
                ..LocatorOptions::new(Method::Table)
            };
            Ok(CameraLocator::new(&scene.camera, GROUND_Z_M, options)?)
        })?;
        Ok(WeightPoint {
            weight: value,
            location: Figures::of(&samples).location,
        })
    });
    points.collect()
}

fn weight(value: WeightValue) -> Weight {
    match value {
        WeightValue::PxPerMetre(value) => Weight::PxPerMetre {
            value,
            at_image_width_px: DEFAULT_WEIGHT_WIDTH_PX,
        },
        WeightValue::BoxWidth(_) => Weight::BoxWidth,
    }
}
