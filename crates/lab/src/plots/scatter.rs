//! One panel per estimator, one dot per object and image.

use super::{
    Drawn, answers, reach_m, shown,
    style::{self, Area, Axes, REFERENCE},
};
use crate::{
    sample::{Estimate, Estimator, Target},
    sample_table::SampleTable,
    score::{COVERED_ACCURACY, MAJOR_ERROR_M},
};
use plotters::prelude::*;
use std::path::Path;

/// Of one panel, pixels.
const PANEL_PX: (u32, u32) = (640, 480);
const COLUMNS: usize = 3;
/// Relative errors beyond this are drawn at the edge, percent.
const MOST_PERCENT: f64 = 60.0;
const DOT_PX: i32 = 3;
const DOT_OPACITY: f64 = 0.5;
/// Steps of a curve.
const CURVE_STEPS: u32 = 200;

/// A dot of a sample.
type Dot = fn(&Target, &Estimate) -> (f64, f64);

/// What every panel of a picture shows.
struct Panels {
    title: &'static str,
    y: (std::ops::Range<f64>, &'static str),
    dot: Dot,
    /// Curves to compare with: y of x.
    curves: Vec<Box<dyn Fn(f64) -> f64>>,
}

/// The relative error against the distance, with the lines of 1.5 m (the paper, Fig. 3).
pub(super) fn relative_error(table: &SampleTable, file: &Path) -> Drawn {
    let panels = Panels {
        title: "relative error of the distance; grey: errors of 1.5 m",
        y: (-MOST_PERCENT..MOST_PERCENT, "error, %"),
        dot: |target, found| {
            let percent = (found.range_m / target.range_m - 1.0) * 100.0;
            (target.range_m, percent.clamp(-MOST_PERCENT, MOST_PERCENT))
        },
        curves: vec![
            Box::new(|range_m| MAJOR_ERROR_M / range_m * 100.0),
            Box::new(|range_m| -MAJOR_ERROR_M / range_m * 100.0),
        ],
    };
    panels.draw(table, file)
}

/// The estimated against the true distance, with the lines within which a place is covered.
pub(super) fn distance(table: &SampleTable, file: &Path) -> Drawn {
    let panels = Panels {
        title: "estimated distance; grey: exact, and 10 % off",
        y: (0.0..reach_m(table) * 1.2, "estimated, m"),
        dot: |target, found| (target.range_m, found.range_m),
        curves: vec![
            Box::new(|range_m| range_m),
            Box::new(|range_m| range_m * COVERED_ACCURACY),
            Box::new(|range_m| range_m * (2.0 - COVERED_ACCURACY)),
        ],
    };
    panels.draw(table, file)
}

impl Panels {
    fn draw(&self, table: &SampleTable, file: &Path) -> Drawn {
        let estimators = shown(table);
        let columns = estimators.len().clamp(1, COLUMNS);
        let rows = estimators.len().div_ceil(columns).max(1);
        let width = PANEL_PX.0 * COLUMNS.min(columns).max(2) as u32;
        let size = (width, PANEL_PX.1 * rows as u32 + style::TITLE_PX as u32 * 2);
        let picture = style::picture(file, size)?;
        let below = style::titled(&picture, self.title)?;
        let areas = below.split_evenly((rows, columns));
        for (area, estimator) in areas.iter().zip(estimators) {
            self.panel(area, table, estimator)?;
        }
        Ok(picture.present()?)
    }

    fn panel(&self, area: &Area<'_>, table: &SampleTable, estimator: Estimator) -> Drawn {
        let answers = answers(table, estimator);
        let reach_m = reach_m(table);
        let axes = Axes {
            title: format!("{estimator}, n {}", answers.len()),
            x: (0.0..reach_m, "true distance, m"),
            y: (self.y.0.clone(), self.y.1),
        };
        let mut chart = style::meshed(area, &axes)?;
        let within = |y: f64| axes.y.0.contains(&y);
        for curve in &self.curves {
            let steps = (1..=CURVE_STEPS).map(|step| f64::from(step) / f64::from(CURVE_STEPS));
            let points = steps.map(|share| (share * reach_m, curve(share * reach_m)));
            let points = points.filter(|&(_, y)| within(y));
            chart.draw_series(LineSeries::new(points, REFERENCE.stroke_width(2)))?;
        }
        let colour = style::colour(estimator).mix(DOT_OPACITY).filled();
        let dots = answers
            .iter()
            .map(|(target, found)| (self.dot)(target, found));
        chart.draw_series(dots.map(|at| Circle::new(at, DOT_PX, colour)))?;
        Ok(())
    }
}
