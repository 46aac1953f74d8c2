//! Figures of headings.

use crate::{
    sample::HeadingError,
    score::{mean, quantile, share},
};
use serde::Serialize;

/// A heading that is off by more than this is turned round rather than inexact, degrees.
pub const FLIP_DEG: f64 = 90.0;

/// Figures of headings; every one `None` without samples.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct HeadingScore {
    /// Headings that estimator and truth both have.
    pub n: usize,
    /// Mean error of the likeliest heading, degrees.
    pub mean_abs_deg: Option<f64>,
    /// Median of the same.
    pub median_abs_deg: Option<f64>,
    /// Share of likeliest headings more than [`FLIP_DEG`] off.
    pub flip_share: Option<f64>,
    /// Median error of the nearest heading that the box allows, degrees.
    pub folded_median_deg: Option<f64>,
}

impl HeadingScore {
    /// Scores headings.
    pub(crate) fn of(errors: impl Iterator<Item = HeadingError>) -> Self {
        let errors: Vec<HeadingError> = errors.collect();
        let best = || errors.iter().map(|error| error.best_deg);
        let flipped = best().filter(|&deg| deg > FLIP_DEG);
        Self {
            n: errors.len(),
            mean_abs_deg: mean(best()),
            median_abs_deg: quantile(best(), 0.5),
            flip_share: share(flipped.count(), errors.len()),
            folded_median_deg: quantile(errors.iter().map(|error| error.folded_deg), 0.5),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        made::{CAR_TRUTH, camera, location},
        sample::{Estimator, Sample, Target},
    };
    use roadwatch_core::{Heading, HeadingCandidate, Location};
    use std::sync::Arc;

    fn heading(deg: f64) -> Heading {
        Heading {
            yaw_rad: deg.to_radians(),
            std_dev_rad: 0.1,
            flip_probability: 0.0,
        }
    }

    /// The error against a car that points to 180 degrees.
    fn error(candidates_deg: &[f64], decided_deg: Option<f64>) -> Option<HeadingError> {
        let target = Arc::new(Target::new(&CAR_TRUTH, &camera(), true));
        let candidate = |&deg: &f64| HeadingCandidate {
            heading: heading(deg),
            weight: 1.0 / candidates_deg.len() as f64,
        };
        let answer = Location {
            headings: candidates_deg.iter().map(candidate).collect(),
            ..location(CAR_TRUTH.center)
        };
        let decided = decided_deg.map(heading);
        let sample = Sample::judge(Estimator::Published, &target, Some((&answer, decided)));
        sample.estimate.expect("a place").heading
    }

    #[test]
    fn the_folded_error_is_that_of_the_nearest_candidate() {
        let off = error(&[5.0, 175.0, -5.0, -175.0], None).expect("a heading");
        assert!((off.best_deg - 175.0).abs() < 1e-9 && (off.folded_deg - 5.0).abs() < 1e-9);
        let decided = error(&[5.0, 175.0], Some(-178.0)).expect("a heading");
        assert!((decided.best_deg - 2.0).abs() < 1e-9 && (decided.folded_deg - 2.0).abs() < 1e-9);
        assert_eq!(error(&[], None), None);
    }

    #[test]
    fn headings_turned_round_are_counted_apart() {
        let errors =
            [(1.0, 1.0), (3.0, 3.0), (170.0, 10.0)].map(|(best_deg, folded_deg)| HeadingError {
                best_deg,
                folded_deg,
                decided: true,
            });
        let score = HeadingScore::of(errors.into_iter());
        assert_eq!((score.n, score.median_abs_deg), (3, Some(3.0)));
        assert_eq!(score.folded_median_deg, Some(3.0));
        assert_eq!(score.flip_share, Some(1.0 / 3.0));
        assert_eq!(score.mean_abs_deg, Some(58.0));
    }
}
