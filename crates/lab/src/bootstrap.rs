//! How far figures would move with other objects: the bootstrap over objects.
//!
//! Boxes of one object in neighbouring images err alike, so that resampling boxes would promise too much. Whole
//! objects are drawn with replacement instead, each with all of its boxes (cluster bootstrap; Davison and
//! Hinkley 1997, section 3.8).

use crate::{
    sample::Sample,
    score::{Located, coverage, quantile, score_location, score_range},
};
use serde::Serialize;
use std::collections::BTreeMap;

/// Enough that the ends of an interval stay put within about 5 % of its width.
pub const RESAMPLES: usize = 1000;

/// The intervals hold this share of the resamples.
pub const CONFIDENCE: f64 = 0.95;

/// Any number does, as long as it is always the same: equal samples give equal reports.
const SEED: u64 = 20_240_611;

/// Fewer objects than this say nothing of other objects.
const MIN_OBJECTS: usize = 2;

/// Low and high end of an interval.
pub type Interval = [f64; 2];

/// 95 % intervals of an estimator's main figures; `None` with fewer than two objects.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Intervals {
    /// Different objects that were drawn from.
    pub objects: usize,
    /// Of the distance's mean of `|error| / truth`.
    pub mean_relative_error: Option<Interval>,
    /// Of its mean of `error / truth`.
    pub bias_relative: Option<Interval>,
    /// Of the median error of the location, metres.
    pub location_p50_m: Option<Interval>,
    /// Of the coverage.
    pub coverage_90: Option<Interval>,
}

/// The figures of one resample.
struct Resampled {
    mean_relative_error: Option<f64>,
    bias_relative: Option<f64>,
    location_p50_m: Option<f64>,
    coverage_90: Option<f64>,
}

impl Intervals {
    /// The intervals of one estimator's samples. What it gave no place is left out.
    #[must_use]
    pub fn of<'a>(samples: impl IntoIterator<Item = &'a Sample>) -> Self {
        let mut objects: BTreeMap<&str, Vec<Located<'a>>> = BTreeMap::new();
        for sample in samples {
            if let Some(estimate) = &sample.estimate {
                let boxes = objects.entry(&sample.target.object.id).or_default();
                boxes.push((sample.target.as_ref(), estimate));
            }
        }
        let objects: Vec<_> = objects.into_values().collect();
        let resampled = if objects.len() < MIN_OBJECTS {
            Vec::new()
        } else {
            resample(&objects)
        };
        let of =
            |figure: fn(&Resampled) -> Option<f64>| interval(resampled.iter().filter_map(figure));
        Self {
            objects: objects.len(),
            mean_relative_error: of(|figures| figures.mean_relative_error),
            bias_relative: of(|figures| figures.bias_relative),
            location_p50_m: of(|figures| figures.location_p50_m),
            coverage_90: of(|figures| figures.coverage_90),
        }
    }
}

fn resample(objects: &[Vec<Located<'_>>]) -> Vec<Resampled> {
    let mut random = fastrand::Rng::with_seed(SEED);
    let mut draw = || {
        let drawn = (0..objects.len()).map(|_| &objects[random.usize(..objects.len())]);
        let boxes: Vec<Located<'_>> = drawn.flatten().copied().collect();
        let distance = score_range(&boxes);
        Resampled {
            mean_relative_error: distance.mean_relative_error,
            bias_relative: distance.bias_relative,
            location_p50_m: score_location(&boxes).p50_m,
            coverage_90: coverage(&boxes),
        }
    };
    (0..RESAMPLES).map(|_| draw()).collect()
}

fn interval(values: impl Iterator<Item = f64> + Clone) -> Option<Interval> {
    let tail = (1.0 - CONFIDENCE) / 2.0;
    Some([
        quantile(values.clone(), tail)?,
        quantile(values, 1.0 - tail)?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made::sample_of;

    /// Two cars with many boxes each, one found 10 % too far and the other exactly.
    fn two_cars() -> Vec<Sample> {
        let boxes = (0..50).flat_map(|_| [sample_of("a", 22.0, 20.0), sample_of("b", 20.0, 20.0)]);
        boxes.collect()
    }

    #[test]
    fn many_boxes_of_few_objects_are_few_objects() {
        let intervals = Intervals::of(&two_cars());
        assert_eq!(intervals.objects, 2);
        // One time in four both draws are the same car.
        let [low, high] = intervals.bias_relative.expect("an interval");
        assert!(
            low.abs() < 1e-9 && (high - 0.1).abs() < 1e-9,
            "{low} {high}"
        );
    }

    #[test]
    fn equal_samples_give_equal_intervals() {
        let spread: Vec<_> = (0..40)
            .map(|at| sample_of(&at.to_string(), 20.0 + f64::from(at) / 10.0, 20.0))
            .collect();
        let intervals = Intervals::of(&spread);
        assert_eq!(intervals, Intervals::of(&spread));
        let [low, high] = intervals.mean_relative_error.expect("an interval");
        let mean = 0.0975;
        assert!(
            low < mean && mean < high && high - low < 0.05,
            "{low} {high}"
        );
    }

    #[test]
    fn one_object_has_no_interval() {
        let intervals = Intervals::of(&[sample_of("a", 21.0, 20.0), sample_of("a", 22.0, 20.0)]);
        assert_eq!(intervals.objects, 1);
        assert_eq!(intervals.bias_relative, None);
    }
}
