//! Accuracy from above for each of the paper's F values (its Fig. 4).

use crate::{
    plots::{
        Drawn,
        style::{self, Area, Axes, REFERENCE},
    },
    score::COVERED_ACCURACY,
    study::{FocalStudy, PublishedFocal},
};
use plotters::prelude::*;
use std::path::Path;

const PANEL_PX: (u32, u32) = (760, 760);
const COLUMNS: usize = 2;
const HALF_CELL_M: f64 = 1.2;
const RING_PX: i32 = 9;
/// Around a place that is covered.
const RING: RGBColor = RGBColor(20, 60, 200);
/// From the worst accuracy that is told apart to the best.
const WORST: f64 = 0.5;
const RAMP: [(f64, f64, f64); 3] = [
    (68.0, 1.0, 84.0),
    (225.0, 100.0, 60.0),
    (253.0, 231.0, 140.0),
];

pub(super) fn heat(focal: &FocalStudy, file: &Path) -> Drawn {
    let rows = focal.published.len().div_ceil(COLUMNS);
    let size = (
        PANEL_PX.0 * COLUMNS as u32,
        PANEL_PX.1 * rows as u32 + 3 * style::TITLE_PX as u32,
    );
    let picture = style::picture(file, size)?;
    let title = "accuracy of eq. 2: dark 50 % or less, light 100 %; blue rings: 90 % or more";
    let below = style::titled(&picture, title)?;
    let areas = below.split_evenly((rows, COLUMNS));
    for (area, published) in areas.iter().zip(&focal.published) {
        panel(area, published)?;
    }
    Ok(picture.present()?)
}

fn panel(area: &Area<'_>, published: &PublishedFocal) -> Drawn {
    let places = published.heat.iter();
    let aside = places.fold(1.0_f64, |most, heat| most.max(heat.aside_m.abs()));
    let along = published
        .heat
        .iter()
        .fold(1.0_f64, |most, heat| most.max(heat.along_m));
    let covered = published.point.coverage_90.unwrap_or_default() * 100.0;
    let axes = Axes {
        title: format!(
            "F {:.2} (W {} m), covered {covered:.0} %",
            published.focal.focal_px, published.size_m
        ),
        x: (-aside - 2.0..aside + 2.0, "right of the optical axis, m"),
        y: (0.0..along + 2.0, "ahead, m"),
    };
    let mut chart = style::meshed(area, &axes)?;
    let cells = published.heat.iter().map(|heat| {
        let (x, y) = (heat.aside_m, heat.along_m);
        let corners = [
            (x - HALF_CELL_M, y - HALF_CELL_M),
            (x + HALF_CELL_M, y + HALF_CELL_M),
        ];
        Rectangle::new(corners, colour(heat.accuracy).filled())
    });
    chart.draw_series(cells)?;
    let covered = published.heat.iter();
    let covered = covered.filter(|heat| heat.accuracy >= COVERED_ACCURACY);
    chart
        .draw_series(covered.map(|heat| {
            Circle::new((heat.aside_m, heat.along_m), RING_PX, RING.stroke_width(3))
        }))?;
    chart.draw_series([TriangleMarker::new((0.0, 0.6), 12, REFERENCE.filled())])?;
    Ok(())
}

fn colour(accuracy: f64) -> RGBColor {
    let share = ((accuracy - WORST) / (1.0 - WORST)).clamp(0.0, 1.0);
    let place = share * (RAMP.len() - 1) as f64;
    let at = (place as usize).min(RAMP.len() - 2);
    let part = place - at as f64;
    let (from, to) = (RAMP[at], RAMP[at + 1]);
    let mix = |from: f64, to: f64| (from + (to - from) * part).round() as u8;
    RGBColor(mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}
