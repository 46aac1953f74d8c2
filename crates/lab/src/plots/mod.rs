//! Plots of an evaluation, made of the same samples as its figures.

mod bars;
mod car_rows;
mod from_above;
mod position_curve;
mod rotation;
mod scatter;
mod sigmas;
mod study;
mod style;
mod traces;

pub(crate) use car_rows::draw_car_rows;
pub use position_curve::draw_position_curve;
pub(crate) use rotation::draw_rotation;
pub use study::draw_study;
pub(crate) use traces::HUE_STEP;
pub use traces::{Traces, draw_headings, draw_trajectories};

use crate::{
    sample::{Estimate, Estimator, Target},
    sample_table::SampleTable,
};
use std::{
    error::Error,
    path::{Path, PathBuf},
};

/// A plot that was drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plot {
    /// Its file's name.
    pub file: &'static str,
    /// What it shows.
    pub title: &'static str,
}

/// A plot that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw the plot `{}`: {cause}", file.display())]
pub struct PlotError {
    file: PathBuf,
    cause: Box<dyn Error + Send + Sync>,
}

/// What drawing comes to.
type Drawn = Result<(), Box<dyn Error + Send + Sync>>;

/// How a plot is drawn into a file.
type Draw = fn(&SampleTable, &Path) -> Drawn;

/// Every plot.
const PLOTS: [(Plot, Draw); 6] = [
    (
        Plot {
            file: "relative_error.png",
            title: "relative error of the distance against the distance",
        },
        scatter::relative_error,
    ),
    (
        Plot {
            file: "distance.png",
            title: "estimated against true distance",
        },
        scatter::distance,
    ),
    (
        Plot {
            file: "error_by_band.png",
            title: "mean relative error by band of distance",
        },
        bars::error_by_band,
    ),
    (
        Plot {
            file: "coverage_by_band.png",
            title: "coverage by band of distance",
        },
        bars::coverage_by_band,
    ),
    (
        Plot {
            file: "honesty.png",
            title: "share of errors within so many standard deviations, against a Gaussian's",
        },
        sigmas::honesty,
    ),
    (
        Plot {
            file: "from_above.png",
            title: "true and estimated places from above",
        },
        from_above::from_above,
    ),
];

/// Draws every plot into a folder; none where no object was found.
///
/// # Errors
/// When a file cannot be written.
pub fn draw(table: &SampleTable, folder: &Path) -> Result<Vec<Plot>, PlotError> {
    if table.samples.iter().all(|sample| sample.estimate.is_none()) {
        return Ok(Vec::new());
    }
    for (plot, draw) in PLOTS {
        let file = folder.join(plot.file);
        draw(table, &file).map_err(|cause| PlotError { file, cause })?;
    }
    Ok(PLOTS.into_iter().map(|(plot, _)| plot).collect())
}

/// The estimators that are shown: every method, and what was published unless a method said just the same.
fn shown(table: &SampleTable) -> Vec<Estimator> {
    let published = answers(table, Estimator::Published);
    let repeats =
        |who: &Estimator| *who != Estimator::Published && answers(table, *who) == published;
    let estimators = table.estimators();
    let redundant = estimators.iter().any(repeats);
    let estimators = estimators.into_iter();
    // Single frames are compared with what was published in tables, where a method's own line is not beside theirs.
    estimators
        .filter(|who| *who != Estimator::Published || !redundant)
        .filter(|who| *who != Estimator::Single)
        .collect()
}

/// Every place that an estimator gave, with its truth.
fn answers(table: &SampleTable, estimator: Estimator) -> Vec<(&Target, &Estimate)> {
    let samples = table.of(estimator);
    samples
        .filter_map(|sample| Some((sample.target.as_ref(), sample.estimate.as_ref()?)))
        .collect()
}

/// The farthest true distance, rounded up to the next ten, metres.
fn reach_m(table: &SampleTable) -> f64 {
    let found = table.targets.iter().filter(|target| target.found);
    let farthest_m = found.map(|target| target.range_m).fold(1.0, f64::max);
    (farthest_m / 10.0).ceil() * 10.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made::{sample, table};
    use std::fs;

    #[test]
    fn every_plot_is_a_picture_that_shows_something() {
        let samples: Vec<_> = (1..40)
            .map(|at| sample(f64::from(at) * 1.6, f64::from(at) * 1.5))
            .collect();
        let folder = tempfile::tempdir().expect("a folder");
        let plots = draw(&table(samples), folder.path()).expect("drawn");
        assert_eq!(plots.len(), PLOTS.len());
        for plot in plots {
            let file = folder.path().join(plot.file);
            let size = imagesize::size(&file).expect("an image");
            assert!(size.width >= 1000, "{}", plot.file);
            // A blank picture of this size packs into a few kilobytes.
            let bytes = fs::metadata(&file).expect("a file").len();
            assert!(bytes > 10_000, "{}: {bytes}", plot.file);
        }
    }

    #[test]
    fn without_samples_nothing_is_drawn() {
        let folder = tempfile::tempdir().expect("a folder");
        let plots = draw(&SampleTable::default(), folder.path());
        assert_eq!(plots.expect("nothing fails"), []);
    }
}
