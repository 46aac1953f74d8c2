//! The scorer: from samples to figures.

use crate::{
    heading_score::HeadingScore,
    honesty::NeesScore,
    sample::{Estimate, Sample, Target},
};
use serde::Serialize;

/// An error beyond this is *major* (the paper, section B), metres.
pub const MAJOR_ERROR_M: f64 = 1.5;

/// An estimate is *covered* when its accuracy `1 - |d - d'| / d` is at least this (the paper, section B).
pub const COVERED_ACCURACY: f64 = 0.9;

/// Differences of accuracies below this are the arithmetic's: exactly 90 % counts as 90 %.
const ACCURACY_ROUNDING: f64 = 1e-9;

/// A place and its truth, of one object in one image.
pub type Located<'a> = (&'a Target, &'a Estimate);

/// Figures of a distance; every one `None` without samples.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct DistanceScore {
    /// Number of samples.
    pub n: usize,
    /// Mean absolute error, metres.
    pub mae_m: Option<f64>,
    /// Root of the mean squared error, metres.
    pub rmse_m: Option<f64>,
    /// Mean of `|error| / truth`.
    pub mean_relative_error: Option<f64>,
    /// Median of `|error| / truth`.
    pub median_relative_error: Option<f64>,
    /// Mean of `error / truth`; positive when estimated too far.
    pub bias_relative: Option<f64>,
    /// Mean of the error, metres; positive when estimated too far.
    pub bias_m: Option<f64>,
    /// Share of errors beyond [`MAJOR_ERROR_M`].
    pub major_error_share: Option<f64>,
}

/// Figures of the location; every one `None` without samples.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct LocationScore {
    /// Number of samples.
    pub n: usize,
    /// Mean error, metres.
    pub mae_m: Option<f64>,
    /// Root of the mean squared error, metres.
    pub rmse_m: Option<f64>,
    /// Half of the errors are smaller, metres.
    pub p50_m: Option<f64>,
    /// Nine in ten errors are smaller, metres.
    pub p90_m: Option<f64>,
    /// Share of errors of at most [`MAJOR_ERROR_M`].
    pub minor_error_share: Option<f64>,
}

/// Everything that is said of one estimator's answers, all of them or a group's.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Figures {
    /// Of `range_m`.
    pub distance: DistanceScore,
    /// Of `depth_m`.
    pub depth: DistanceScore,
    /// Of the distance to the nearest surface, where the truth has a size and a heading.
    pub surface: DistanceScore,
    /// Of the place.
    pub location: LocationScore,
    /// Share of places with an accuracy of at least [`COVERED_ACCURACY`]; `None` without samples.
    pub coverage_90: Option<f64>,
    /// How honest the covariances are.
    pub nees: NeesScore,
    /// Of the likeliest heading, decided for or not.
    pub heading: HeadingScore,
    /// Of the headings that were decided for.
    pub decided_heading: HeadingScore,
    /// Objects that were given no place.
    pub unlocated: usize,
}

impl Figures {
    /// Scores samples of one estimator.
    #[must_use]
    pub fn of<'a>(samples: impl IntoIterator<Item = &'a Sample>) -> Self {
        let (mut located, mut unlocated) = (Vec::new(), 0);
        for sample in samples {
            match &sample.estimate {
                Some(estimate) => located.push((sample.target.as_ref(), estimate)),
                None => unlocated += 1,
            }
        }
        let each = || located.iter().copied();
        Self {
            distance: score_range(&located),
            depth: score_distance(each().map(|(target, found)| (found.depth_m, target.depth_m))),
            surface: score_distance(
                each().filter_map(|(target, found)| Some((found.surface_m, target.surface_m?))),
            ),
            location: score_location(&located),
            coverage_90: coverage(&located),
            nees: NeesScore::of(each().map(|(_, found)| found)),
            heading: HeadingScore::of(each().filter_map(|(_, found)| found.heading)),
            decided_heading: HeadingScore::of(
                each()
                    .filter_map(|(_, found)| found.heading)
                    .filter(|error| error.decided),
            ),
            unlocated,
        }
    }
}

/// Scores `range_m`.
#[must_use]
pub fn score_range(located: &[Located<'_>]) -> DistanceScore {
    let each = located.iter();
    score_distance(each.map(|(target, found)| (found.range_m, target.range_m)))
}

/// Scores distances, each estimated and true, metres.
pub fn score_distance(distances: impl IntoIterator<Item = (f64, f64)>) -> DistanceScore {
    let (mut errors, mut relative) = (Vec::new(), Vec::new());
    for (found, truth) in distances {
        errors.push(found - truth);
        relative.push((found - truth) / truth);
    }
    let absolute = || relative.iter().map(|share: &f64| share.abs());
    let major = errors.iter().filter(|error| error.abs() > MAJOR_ERROR_M);
    DistanceScore {
        n: errors.len(),
        mae_m: mean(errors.iter().map(|error| error.abs())),
        rmse_m: root_mean_square(&errors),
        mean_relative_error: mean(absolute()),
        median_relative_error: quantile(absolute(), 0.5),
        bias_relative: mean(relative.iter().copied()),
        bias_m: mean(errors.iter().copied()),
        major_error_share: share(major.count(), errors.len()),
    }
}

/// Scores locations.
#[must_use]
pub fn score_location(located: &[Located<'_>]) -> LocationScore {
    let each = located.iter();
    let errors: Vec<f64> = each.map(|(_, found)| found.location_error_m()).collect();
    let minor = errors.iter().filter(|&&error| error <= MAJOR_ERROR_M);
    LocationScore {
        n: errors.len(),
        mae_m: mean(errors.iter().copied()),
        rmse_m: root_mean_square(&errors),
        p50_m: quantile(errors.iter().copied(), 0.5),
        p90_m: quantile(errors.iter().copied(), 0.9),
        minor_error_share: share(minor.count(), errors.len()),
    }
}

/// Share of the places whose distance is accurate to [`COVERED_ACCURACY`]; `None` of nothing.
#[must_use]
pub fn coverage(located: &[Located<'_>]) -> Option<f64> {
    let accuracy = |target: &Target, found: &Estimate| {
        1.0 - (found.range_m - target.range_m).abs() / target.range_m
    };
    let covered = located
        .iter()
        .filter(|(target, found)| accuracy(target, found) >= COVERED_ACCURACY - ACCURACY_ROUNDING);
    share(covered.count(), located.len())
}

/// `part / whole`; `None` of nothing.
#[must_use]
pub fn share(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

pub(crate) fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = values.len();
    (count > 0).then(|| values.sum::<f64>() / count as f64)
}

fn root_mean_square(values: &[f64]) -> Option<f64> {
    mean(values.iter().map(|value| value * value)).map(f64::sqrt)
}

/// The value at a quantile, linear between the two nearest ranks; `None` of nothing.
pub(crate) fn quantile(values: impl Iterator<Item = f64>, quantile: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let place = quantile * (sorted.len().checked_sub(1)? as f64);
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    // Two equal infinities have no difference.
    Some(if below == above {
        below
    } else {
        below + (above - below) * place.fract()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made::{sample, without_place};

    fn near(value: Option<f64>, expected: f64) -> bool {
        (value.unwrap_or(f64::NAN) - expected).abs() < 1e-9
    }

    #[test]
    fn figures_follow_their_definitions() {
        let samples = [
            sample(9.0, 10.0),
            sample(22.0, 20.0),
            sample(40.0, 40.0),
            without_place(30.0),
        ];
        let figures = Figures::of(&samples);
        let distance = figures.distance;
        assert_eq!((distance.n, figures.unlocated), (3, 1));
        assert!(near(distance.mae_m, 1.0));
        assert!(near(distance.rmse_m, (5.0_f64 / 3.0).sqrt()));
        assert!(near(distance.mean_relative_error, 0.2 / 3.0));
        assert!(near(distance.median_relative_error, 0.1));
        assert!(near(distance.bias_relative, 0.0));
        assert!(near(distance.bias_m, 1.0 / 3.0));
        assert!(near(distance.major_error_share, 1.0 / 3.0));
        let location = figures.location;
        assert!(near(location.p50_m, 1.0) && near(location.p90_m, 1.8));
        assert!(near(location.minor_error_share, 2.0 / 3.0));
    }

    #[test]
    fn exactly_nine_tenths_are_covered_and_less_is_not() {
        let samples = [sample(9.0, 10.0), sample(22.0, 20.0), sample(44.1, 40.0)];
        assert!(near(Figures::of(&samples).coverage_90, 2.0 / 3.0));
    }

    #[test]
    fn the_surface_is_scored_where_the_truth_has_one() {
        // A car 4 m long, head on: its nearest surface is 2 m nearer than its centre.
        let figures = Figures::of(&[sample(11.0, 10.0)]);
        assert_eq!(figures.surface.n, 1);
        assert!(near(figures.surface.mean_relative_error, 1.0 / 8.0));
    }

    #[test]
    fn nothing_scores_as_nothing() {
        assert_eq!(Figures::of(&[]), Figures::default());
    }
}
