//! The scorer: from pairs of estimate and truth to figures.

use serde::Serialize;

/// An error beyond this is *major* (the paper, section B), metres.
pub const MAJOR_ERROR_M: f64 = 1.5;

/// Estimated and true distance (`range_m`) of one object, and how far apart the places are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Estimated horizontal distance from the camera's foot, metres.
    pub range_m: f64,
    /// True one, metres.
    pub true_range_m: f64,
    /// Horizontal distance between the estimated and the true centre, metres.
    pub location_error_m: f64,
}

/// Figures of the distance; every one `None` without samples.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct DistanceScore {
    /// Number of samples.
    pub n: usize,
    /// Mean absolute error, metres.
    pub mae_m: Option<f64>,
    /// Mean of `|error| / truth`.
    pub mean_relative_error: Option<f64>,
    /// Median of `|error| / truth`.
    pub median_relative_error: Option<f64>,
    /// Mean of `error / truth`; positive when estimated too far.
    pub bias_relative: Option<f64>,
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
    /// Half of the errors are smaller, metres.
    pub p50_m: Option<f64>,
    /// Nine in ten errors are smaller, metres.
    pub p90_m: Option<f64>,
    /// Share of errors of at most [`MAJOR_ERROR_M`].
    pub minor_error_share: Option<f64>,
}

/// Scores distances.
#[must_use]
pub fn score_distance(samples: &[Sample]) -> DistanceScore {
    let error = |sample: &Sample| sample.range_m - sample.true_range_m;
    let relative = |sample: &Sample| error(sample) / sample.true_range_m;
    let major = |sample: &&Sample| error(sample).abs() > MAJOR_ERROR_M;
    DistanceScore {
        n: samples.len(),
        mae_m: mean(samples.iter().map(|s| error(s).abs())),
        mean_relative_error: mean(samples.iter().map(|s| relative(s).abs())),
        median_relative_error: quantile(samples.iter().map(|s| relative(s).abs()), 0.5),
        bias_relative: mean(samples.iter().map(relative)),
        major_error_share: share(samples.iter().filter(major).count(), samples.len()),
    }
}

/// Scores locations.
#[must_use]
pub fn score_location(samples: &[Sample]) -> LocationScore {
    let errors = || samples.iter().map(|sample| sample.location_error_m);
    let minor = errors().filter(|&error| error <= MAJOR_ERROR_M).count();
    LocationScore {
        n: samples.len(),
        mae_m: mean(errors()),
        p50_m: quantile(errors(), 0.5),
        p90_m: quantile(errors(), 0.9),
        minor_error_share: share(minor, samples.len()),
    }
}

/// `part / whole`; `None` of nothing.
#[must_use]
pub fn share(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = values.len();
    (count > 0).then(|| values.sum::<f64>() / count as f64)
}

/// The value at a quantile, linear between the two nearest ranks.
fn quantile(values: impl Iterator<Item = f64>, quantile: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let place = quantile * (sorted.len().checked_sub(1)? as f64);
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(range_m: f64, true_range_m: f64) -> Sample {
        Sample {
            range_m,
            true_range_m,
            location_error_m: (range_m - true_range_m).abs(),
        }
    }

    #[test]
    fn figures_follow_their_definitions() {
        let samples = [sample(9.0, 10.0), sample(22.0, 20.0), sample(40.0, 40.0)];
        let distance = score_distance(&samples);
        let near =
            |value: Option<f64>, expected: f64| (value.unwrap_or(f64::NAN) - expected).abs() < 1e-9;
        assert_eq!(distance.n, 3);
        assert!(near(distance.mae_m, 1.0));
        assert!(near(distance.mean_relative_error, 0.2 / 3.0));
        assert!(near(distance.median_relative_error, 0.1));
        assert!(near(distance.bias_relative, 0.0));
        assert!(near(distance.major_error_share, 1.0 / 3.0));
        let location = score_location(&samples);
        assert!(near(location.p50_m, 1.0) && near(location.p90_m, 1.8));
        assert!(near(location.minor_error_share, 2.0 / 3.0));
    }

    #[test]
    fn nothing_scores_as_nothing() {
        assert_eq!(score_distance(&[]), DistanceScore::default());
        assert_eq!(score_location(&[]), LocationScore::default());
    }
}
