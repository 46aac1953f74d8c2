//! The X path and the Y path: every method beside the paper's (its Fig. 3).

use super::{
    scene::{Shape, StudyScene},
    trial::{Bench, TrialError, by_height, true_height_m},
};
use crate::{
    sample::{Estimate, Estimator, Sample, Target},
    score::{DistanceScore, Figures, LocationScore, MAJOR_ERROR_M},
};
use roadwatch_core::Method;
use serde::Serialize;

/// Nearer than this a major error is a bad one: a car brakes for what is here, metres.
pub const FEW_METRES_M: f64 = 25.0;

/// One drive along a path with every method's answers.
#[derive(Debug, Clone)]
pub struct PathStudy {
    /// Which path.
    pub shape: Shape,
    /// What drives along it: the labels' name of its kind, or its class.
    pub vehicle: String,
    /// Eq. 2 as the paper means it, with the F of eq. 1 (`fy` without one) and the vehicle's real height.
    pub known: Vec<Sample>,
    /// Every method with the defaults of the daemon.
    pub samples: Vec<Sample>,
}

/// What is said of one method on a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PathFigures {
    /// Errors of `range_m` beyond 1.5 m.
    pub major_errors: usize,
    /// Places nearer than [`FEW_METRES_M`].
    pub near: usize,
    /// Major errors among those.
    pub major_errors_near: usize,
    /// Share of places with an accuracy of at least 90 %.
    pub coverage_90: Option<f64>,
    /// Of `range_m`.
    pub distance: DistanceScore,
    /// Of the place.
    pub location: LocationScore,
}

impl PathFigures {
    /// Counts and scores.
    pub fn of<'a>(samples: impl Iterator<Item = &'a Sample> + Clone) -> Self {
        let figures = Figures::of(samples.clone());
        let placed = samples.filter_map(|sample| Some((&sample.target, sample.estimate.as_ref()?)));
        let is_near = |target: &Target| target.range_m < FEW_METRES_M;
        let is_major = |target: &Target, found: &Estimate| {
            (found.range_m - target.range_m).abs() > MAJOR_ERROR_M
        };
        let major = placed.clone().filter(|(at, found)| is_major(at, found));
        Self {
            major_errors: major.clone().count(),
            near: placed.filter(|(at, _)| is_near(at)).count(),
            major_errors_near: major.filter(|(at, _)| is_near(at)).count(),
            coverage_90: figures.coverage_90,
            distance: figures.distance,
            location: figures.location,
        }
    }
}

/// Figures by name over some drives: eq. 2 with the real height first, then every method.
pub fn path_figures<'a>(
    paths: impl Iterator<Item = &'a PathStudy> + Clone,
) -> Vec<(&'static str, PathFigures)> {
    let known = paths.clone().flat_map(|path| &path.known);
    let known = ("real_height", PathFigures::of(known));
    let by_method = Method::ALL.into_iter().map(|method| {
        let samples = paths.clone().flat_map(|path| &path.samples);
        let of_method = samples.filter(move |sample| sample.estimator == Estimator::By(method));
        (method.as_str(), PathFigures::of(of_method))
    });
    let all = std::iter::once(known).chain(by_method);
    all.filter(|(_, figures)| figures.distance.n > 0).collect()
}

pub(super) fn study(bench: &Bench<'_>) -> Result<Vec<PathStudy>, TrialError> {
    let focal = bench.measured.map(|measured| measured.focal);
    let is_path = |scene: &&StudyScene| matches!(scene.shape, Shape::XPath | Shape::YPath);
    let drives = bench.scenes.iter().filter(is_path).filter_map(|scene| {
        let object = &scene.seen.first()?.target.object;
        let vehicle = object.label.as_ref().unwrap_or(&object.class).clone();
        let seen: Vec<_> = scene.seen.iter().map(|seen| (scene, seen)).collect();
        Some((scene.shape, vehicle, seen))
    });
    let mut paths = Vec::new();
    for (shape, vehicle, seen) in drives {
        paths.push(PathStudy {
            shape,
            vehicle,
            known: by_height(&seen, focal, true_height_m)?,
            samples: bench.methods(&seen)?,
        });
    }
    paths.sort_by_key(|path| path.shape);
    Ok(paths)
}
