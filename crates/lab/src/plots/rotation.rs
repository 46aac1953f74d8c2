//! Estimated against true observation angles over a full turn (the paper, Fig. 10).

use super::{
    Drawn, PlotError,
    style::{self, Axes, REFERENCE},
};
use crate::rotation::Answer;
use plotters::prelude::*;
use std::path::Path;

const PANEL_PX: (u32, u32) = (640, 640);
const DOT_PX: i32 = 3;
const DOT: RGBColor = RGBColor(31, 90, 150);
const DOT_OPACITY: f64 = 0.45;
const TURN_DEG: f64 = 360.0;

/// One panel per forest.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn draw_rotation(
    forests: &[(String, Vec<Answer>)],
    file: &Path,
) -> Result<(), PlotError> {
    drawn(forests, file).map_err(|cause| PlotError {
        file: file.to_owned(),
        cause,
    })
}

fn drawn(forests: &[(String, Vec<Answer>)], file: &Path) -> Drawn {
    let columns = forests.len().max(1);
    let size = (
        PANEL_PX.0 * columns as u32,
        PANEL_PX.1 + style::TITLE_PX as u32 * 2,
    );
    let picture = style::picture(file, size)?;
    let below = style::titled(&picture, "angle to the ray, estimated against true")?;
    for (area, (name, answers)) in below.split_evenly((1, columns)).iter().zip(forests) {
        let axes = Axes {
            title: format!("{name}, n {}", answers.len()),
            x: (0.0..TURN_DEG, "true, degrees"),
            y: (0.0..TURN_DEG, "estimated, degrees"),
        };
        let mut chart = style::meshed(area, &axes)?;
        let ends = [0.0, TURN_DEG].map(|deg| (deg, deg));
        chart.draw_series(LineSeries::new(ends, REFERENCE.stroke_width(2)))?;
        let dots = answers
            .iter()
            .map(|answer| [answer.true_deg, answer.found_deg].map(|deg| deg.rem_euclid(TURN_DEG)))
            .map(|[truth, found]| (truth, found));
        let colour = DOT.mix(DOT_OPACITY).filled();
        chart.draw_series(dots.map(|at| Circle::new(at, DOT_PX, colour)))?;
    }
    Ok(picture.present()?)
}
