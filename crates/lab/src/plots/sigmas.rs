//! Whether covariances are honest, at a glance.

use super::{
    Drawn, answers, shown,
    style::{self, Area, Axes, REFERENCE},
};
use crate::{
    honesty::share_within,
    sample::{Deviation, Estimate},
    sample_table::SampleTable,
};
use plotters::prelude::*;
use std::path::Path;

const SIZE_PX: (u32, u32) = (1500, 760);
const MOST_SIGMAS: f64 = 3.0;
const STEPS: u32 = 120;

/// Shares of errors within so many standard deviations, along and across the ray. Above the grey line an estimator is
/// too modest, below it too sure.
pub(super) fn honesty(table: &SampleTable, file: &Path) -> Drawn {
    let picture = style::picture(file, SIZE_PX)?;
    let title =
        "errors within k standard deviations; above the Gaussian: too modest, below: too sure";
    let below = style::titled(&picture, title)?;
    let areas = below.split_evenly((1, 2));
    panel(&areas[0], table, "along the ray", |estimate| {
        estimate.radial
    })?;
    panel(&areas[1], table, "across the ray", |estimate| {
        estimate.tangential
    })?;
    Ok(picture.present()?)
}

fn panel(
    area: &Area<'_>,
    table: &SampleTable,
    title: &str,
    direction: fn(&Estimate) -> Deviation,
) -> Drawn {
    let axes = Axes {
        title: title.to_owned(),
        x: (0.0..MOST_SIGMAS, "k, standard deviations"),
        y: (0.0..102.0, "share of errors within, %"),
    };
    let mut chart = style::meshed(area, &axes)?;
    let steps = || (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS) * MOST_SIGMAS);
    let gaussian = steps().map(|k| (k, gaussian_share(k) * 100.0));
    chart
        .draw_series(LineSeries::new(gaussian, REFERENCE.stroke_width(5)))?
        .label("a Gaussian")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], REFERENCE.stroke_width(5)));
    for estimator in shown(table) {
        let answers = answers(table, estimator);
        let deviations: Vec<_> = answers.iter().map(|(_, found)| direction(found)).collect();
        let share = |k| share_within(&deviations, k).unwrap_or_default();
        let colour = style::colour(estimator);
        let curve = steps().map(|k| (k, share(k) * 100.0));
        chart
            .draw_series(LineSeries::new(curve, colour.stroke_width(3)))?
            .label(estimator.as_str())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
    }
    style::legend(&mut chart, SeriesLabelPosition::LowerRight)
}

/// Share of a Gaussian within `k` standard deviations, `erf(k / sqrt 2)`, by Abramowitz and Stegun's 7.1.26, which is
/// exact to 1.5e-7.
fn gaussian_share(k: f64) -> f64 {
    let x = k / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let factors = [
        1.061_405_429,
        -1.453_152_027,
        1.421_413_741,
        -0.284_496_736,
        0.254_829_592,
    ];
    let polynomial = factors
        .into_iter()
        .fold(0.0, |sum, factor| (sum + factor) * t);
    1.0 - polynomial * (-x * x).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gaussian_has_its_well_known_shares() {
        for (k, share) in [
            (0.0, 0.0),
            (1.0, 0.682_689_5),
            (2.0, 0.954_499_7),
            (3.0, 0.997_300_2),
        ] {
            assert!((gaussian_share(k) - share).abs() < 1e-6, "{k}");
        }
    }
}
