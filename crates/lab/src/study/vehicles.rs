//! Every kind of vehicle at random headings: each method against the best that one constant height can do.

use super::{
    scene::Shape,
    trial::{Bench, SeenIn, TrialError, by_height, figures_of},
};
use crate::score::{DistanceScore, Figures};
use roadwatch_core::Method;
use serde::Serialize;
use std::collections::BTreeMap;

/// Constant heights tried, centimetres: from the lowest sports car to the highest bus.
const HEIGHTS_CM: std::ops::RangeInclusive<u32> = 100..=400;
const STEP_CM: usize = 2;
/// The group of the class that is met most.
const CARS: &str = "car";
/// The group of everything.
const ALL: &str = "car, truck and bus";

/// All groups of vehicles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VehicleStudy {
    /// The groups, each with its name.
    pub groups: Vec<Group>,
}

/// A group of vehicles and how well they were placed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Its classes.
    pub name: &'static str,
    /// Boxes.
    pub n: usize,
    /// The one height with which eq. 2 (with `fy`, placed along the ray) has the least mean relative error of
    /// `range_m`, metres.
    pub best_height_m: f64,
    /// Its figures.
    pub best: DistanceScore,
    /// Every method with the daemon's defaults.
    pub methods: BTreeMap<&'static str, Figures>,
    /// By what share the fused method's mean relative error is smaller than the best constant height's.
    pub fused_gain: Option<f64>,
}

pub(super) fn study(bench: &Bench<'_>) -> Result<Option<VehicleStudy>, TrialError> {
    let all = bench.seen(Shape::Vehicles);
    let is_car = |(_, seen): &&SeenIn<'_>| seen.target.object.class == CARS;
    let cars: Vec<_> = all.iter().filter(is_car).copied().collect();
    let mut groups = Vec::new();
    for (name, seen) in [(CARS, cars), (ALL, all)] {
        groups.extend(group(bench, name, &seen)?);
    }
    Ok((!groups.is_empty()).then_some(VehicleStudy { groups }))
}

/// `None` without vehicles, and where not one can be placed.
fn group(
    bench: &Bench<'_>,
    name: &'static str,
    seen: &[SeenIn<'_>],
) -> Result<Option<Group>, TrialError> {
    let Some((best_height_m, best)) = best_height(seen)? else {
        return Ok(None);
    };
    let samples = bench.methods(seen)?;
    let figures = |method| figures_of(&samples, method);
    let methods = Method::ALL
        .into_iter()
        .map(|method| (method.as_str(), figures(method)));
    let error = |score: &DistanceScore| score.mean_relative_error;
    let fused = error(&figures(Method::Fused).distance).zip(error(&best));
    Ok(Some(Group {
        name,
        n: seen.len(),
        best_height_m,
        best,
        fused_gain: fused.map(|(fused, best)| 1.0 - fused / best),
        methods: methods.filter(|(_, f)| f.distance.n > 0).collect(),
    }))
}

fn best_height(seen: &[SeenIn<'_>]) -> Result<Option<(f64, DistanceScore)>, TrialError> {
    let mut best: Option<(f64, DistanceScore)> = None;
    for height_cm in HEIGHTS_CM.step_by(STEP_CM) {
        let height_m = f64::from(height_cm) / 100.0;
        let samples = by_height(seen, None, |_| Some(height_m))?;
        let score = Figures::of(&samples).distance;
        let smaller = |best: &(f64, DistanceScore)| {
            score.n == seen.len() && score.mean_relative_error < best.1.mean_relative_error
        };
        if score.n > 0 && best.as_ref().is_none_or(smaller) {
            best = Some((height_m, score));
        }
    }
    Ok(best)
}
