//! Accuracy and coverage against F and against errors of height (the paper, Fig. 5).

use crate::{
    plots::{
        Drawn,
        style::{self, Area, Axes, REFERENCE},
    },
    study::{FocalStudy, HEIGHT_ERRORS_M, Point},
};
use plotters::prelude::*;
use std::path::Path;

const PANEL_PX: (u32, u32) = (1300, 460);
const ACCURACY: RGBColor = RGBColor(0, 114, 178);
const COVERAGE: RGBColor = RGBColor(213, 94, 0);
const TOP_PERCENT: f64 = 103.0;
const LINE_PX: u32 = 3;

/// A line of a panel: its name, its colour and what it shows.
type Line = (&'static str, RGBColor, fn(&Point) -> Option<f64>);

struct Panel<'a> {
    title: &'static str,
    x_label: &'static str,
    points: &'a [Point],
    /// Upright lines.
    marks: Vec<f64>,
}

pub(super) fn curves(focal: &FocalStudy, file: &Path) -> Drawn {
    let published = focal.published.iter();
    let panels = [
        Panel {
            title: "real height in eq. 2; grey: the paper's four F",
            x_label: "F, px of an image 1080 rows high",
            points: &focal.over_focal,
            marks: published
                .map(|published| published.focal.focal_px)
                .collect(),
        },
        Panel {
            title: "right F, wrong height in eq. 2",
            x_label: "error of height, m",
            points: &focal.in_distance,
            marks: HEIGHT_ERRORS_M.into(),
        },
        Panel {
            title: "F measured with a wrong height (eq. 1), real height in eq. 2",
            x_label: "error of height, m",
            points: &focal.in_focal,
            marks: HEIGHT_ERRORS_M.into(),
        },
    ];
    let size = (
        PANEL_PX.0,
        PANEL_PX.1 * panels.len() as u32 + 2 * style::TITLE_PX as u32,
    );
    let picture = style::picture(file, size)?;
    let below = style::titled(&picture, "accuracy and coverage over the grid")?;
    for (area, panel) in below.split_evenly((panels.len(), 1)).iter().zip(&panels) {
        draw(area, panel)?;
    }
    Ok(picture.present()?)
}

fn draw(area: &Area<'_>, panel: &Panel<'_>) -> Drawn {
    let (Some(first), Some(last)) = (panel.points.first(), panel.points.last()) else {
        return Ok(());
    };
    let axes = Axes {
        title: panel.title.to_owned(),
        x: (
            first.at..last.at + (last.at - first.at) * 0.2,
            panel.x_label,
        ),
        y: (0.0..TOP_PERCENT, "%"),
    };
    let mut chart = style::meshed(area, &axes)?;
    for &at in &panel.marks {
        let upright = [(at, 0.0), (at, TOP_PERCENT)];
        chart.draw_series(LineSeries::new(upright, REFERENCE.stroke_width(1)))?;
    }
    let lines: [Line; 2] = [
        ("accuracy", ACCURACY, |point| point.accuracy),
        ("coverage", COVERAGE, |point| point.coverage_90),
    ];
    for (name, colour, figure) in lines {
        let points = panel.points.iter();
        let points = points.filter_map(|point| Some((point.at, figure(point)?.max(0.0) * 100.0)));
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(LINE_PX)))?
            .label(name)
            .legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(LINE_PX))
            });
    }
    style::legend(&mut chart, SeriesLabelPosition::UpperRight)
}
