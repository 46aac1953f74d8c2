//! Cars in a row from above, with the headings that each calibration gives them (the paper, Fig. 13.1 and 13.3).

use super::{
    Drawn, PlotError,
    style::{self, Area, Axes, REFERENCE},
};
use crate::{
    rotation::{CALIBRATIONS, CarRow},
    sample::Estimator,
};
use plotters::prelude::*;
use roadwatch_core::Method;
use std::path::Path;

const PANEL_PX: (u32, u32) = (560, 760);
/// Free ground around the outermost car, metres.
const MARGIN_M: f64 = 6.0;
/// Length of an arrow on the ground, metres.
const ARROW_M: f64 = 5.0;
/// Its point's sides, as a share of it, and how far they are turned, degrees.
const POINT: (f64, f64) = (0.25, 155.0);
const DOT_PX: i32 = 5;

/// One panel per calibration; arrows point where cars are said to, thin lines where they do.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn draw_car_rows(rows: &[CarRow], file: &Path) -> Result<(), PlotError> {
    drawn(rows, file).map_err(|cause| PlotError {
        file: file.to_owned(),
        cause,
    })
}

fn drawn(rows: &[CarRow], file: &Path) -> Drawn {
    let panels = CALIBRATIONS.len();
    let size = (
        PANEL_PX.0 * panels as u32,
        PANEL_PX.1 + style::TITLE_PX as u32 * 2,
    );
    let picture = style::picture(file, size)?;
    let title = "cars that point the same way: where they are said to point, by calibration";
    let below = style::titled(&picture, title)?;
    for (at, area) in below.split_evenly((1, panels)).iter().enumerate() {
        panel(area, rows, at)?;
    }
    Ok(picture.present()?)
}

fn panel(area: &Area<'_>, rows: &[CarRow], at: usize) -> Drawn {
    let places = rows.iter().flat_map(|row| &row.places);
    let aside = places.map(|place| place.loc_x_m.abs()).fold(0.0, f64::max) + MARGIN_M;
    let ahead = rows.iter().map(|row| row.loc_y_m).fold(0.0, f64::max) + MARGIN_M + ARROW_M;
    let axes = Axes {
        title: CALIBRATIONS[at].to_owned(),
        x: (-aside..aside, "LocX, m"),
        y: (0.0..ahead, "LocY, m"),
    };
    let mut chart = style::meshed(area, &axes)?;
    let colour = style::colour(Estimator::By(Method::Fused));
    for row in rows {
        for place in &row.places {
            let foot = (place.loc_x_m, row.loc_y_m);
            let truth = [foot, ahead_of(foot, 0.0, ARROW_M)];
            chart.draw_series(LineSeries::new(truth, REFERENCE))?;
            let off_deg = place.off_deg[at];
            let tip = ahead_of(foot, off_deg, ARROW_M);
            let (side_m, turned_deg) = (POINT.0 * ARROW_M, POINT.1);
            let sides = [-turned_deg, turned_deg].map(|turn| ahead_of(tip, off_deg + turn, side_m));
            for line in [[foot, tip], [tip, sides[0]], [tip, sides[1]]] {
                chart.draw_series(LineSeries::new(line, colour.stroke_width(3)))?;
            }
            chart.draw_series([Circle::new(foot, DOT_PX, BLACK.filled())])?;
        }
    }
    Ok(())
}

/// So many metres from a place, turned counter-clockwise from ahead.
fn ahead_of((x, y): (f64, f64), turned_deg: f64, metres: f64) -> (f64, f64) {
    let (sin, cos) = turned_deg.to_radians().sin_cos();
    (x - metres * sin, y + metres * cos)
}
