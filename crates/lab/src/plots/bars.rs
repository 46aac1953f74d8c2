//! Bars by band of distance, one per estimator.

use super::{
    Drawn, shown,
    style::{self, Axes},
};
use crate::{grouping::Grouping, sample_table::SampleTable, score::Figures};
use plotters::prelude::*;
use std::path::Path;

const SIZE_PX: (u32, u32) = (1500, 720);
/// Share of a band's width that its bars take.
const FILLED: f64 = 0.8;
/// Room above the highest bar.
const HEADROOM: f64 = 1.1;
/// Room above the highest possible share, percent.
const COVERAGE_TOP_PERCENT: f64 = 103.0;
/// Room for the legend on the right, in widths of a band.
const LEGEND_BANDS: f64 = 1.1;

/// Mean relative errors.
pub(super) fn error_by_band(table: &SampleTable, file: &Path) -> Drawn {
    let bars = Bars {
        title: "mean relative error of the distance",
        y_label: "mean relative error, %",
        figure: |figures| figures.distance.mean_relative_error,
        top_percent: None,
    };
    bars.draw(table, file)
}

/// Shares of places with an accuracy of 90 % or more.
pub(super) fn coverage_by_band(table: &SampleTable, file: &Path) -> Drawn {
    let bars = Bars {
        title: "coverage: share of distances accurate to 90 % or more",
        y_label: "covered, %",
        figure: |figures| figures.coverage_90,
        top_percent: Some(COVERAGE_TOP_PERCENT),
    };
    bars.draw(table, file)
}

struct Bars {
    title: &'static str,
    y_label: &'static str,
    /// A share.
    figure: fn(&Figures) -> Option<f64>,
    /// `None` for as high as the highest bar needs.
    top_percent: Option<f64>,
}

impl Bars {
    fn draw(&self, table: &SampleTable, file: &Path) -> Drawn {
        let mut groups = table.groups(Grouping::Distance);
        groups.retain(|group| group.found > 0);
        let estimators = shown(table);
        let percent = |figures: &Figures| (self.figure)(figures).map(|share| share * 100.0);
        let all = groups
            .iter()
            .flat_map(|group| group.figures.values().filter_map(percent));
        let highest = all.fold(1.0, f64::max) * HEADROOM;
        let names: Vec<_> = groups
            .iter()
            .map(|group| format!("{} m, n {}", group.name, group.found))
            .collect();
        let axes = Axes {
            title: self.title.to_owned(),
            x: (
                -0.5..names.len() as f64 - 0.5 + LEGEND_BANDS,
                "true distance",
            ),
            y: (0.0..self.top_percent.unwrap_or(highest), self.y_label),
        };
        let picture = style::picture(file, SIZE_PX)?;
        let mut chart = style::banded(&picture, &axes, &names)?;
        let width = FILLED / estimators.len() as f64;
        for (at, estimator) in estimators.iter().enumerate() {
            let colour = style::colour(*estimator);
            let left = -FILLED / 2.0 + at as f64 * width;
            let bars = groups.iter().enumerate().filter_map(|(band, group)| {
                let height = percent(&group.figures[estimator])?;
                let x = band as f64 + left;
                Some(Rectangle::new(
                    [(x, 0.0), (x + width * 0.92, height)],
                    colour.filled(),
                ))
            });
            let series = chart.draw_series(bars)?;
            series.label(estimator.as_str()).legend(move |(x, y)| {
                Rectangle::new([(x, y - 6), (x + 16, y + 6)], colour.filled())
            });
        }
        style::legend(&mut chart, SeriesLabelPosition::UpperRight)?;
        Ok(picture.present()?)
    }
}
