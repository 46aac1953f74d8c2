//! Where objects were and where they were said to be, from above.

use super::{
    Drawn,
    style::{self, Area, Axes, REFERENCE},
};
use crate::{
    sample::{Estimator, Sample},
    sample_table::SampleTable,
};
use plotters::prelude::*;
use std::{collections::BTreeMap, ops::Range, path::Path};

const SIZE_PX: (u32, u32) = (1200, 1000);
const DOT_PX: i32 = 4;
/// Free ground around the outermost place, metres.
const MARGIN_M: f64 = 4.0;

/// What was published of the camera that found most: true places as rings, estimates as dots, a line between.
pub(super) fn from_above(table: &SampleTable, file: &Path) -> Drawn {
    let samples = busiest(table);
    let Some(first) = samples.first() else {
        return Ok(());
    };
    let foot = first.target.foot;
    let lines: Vec<_> = samples.iter().filter_map(|sample| line(sample)).collect();
    let picture = style::picture(file, SIZE_PX)?;
    let title = format!(
        "camera {}: true places (rings) and published ones (dots), triangle: the camera",
        first.target.camera
    );
    let below = style::titled(&picture, &title)?;
    draw(&below, &lines, to_plot(foot))?;
    Ok(picture.present()?)
}

/// A true place and the estimate of it, as they are plotted.
type Line = [(f64, f64); 2];

fn draw(area: &Area<'_>, lines: &[Line], foot: (f64, f64)) -> Drawn {
    let places = || lines.iter().flatten().copied().chain([foot]);
    let (x, y) = square(
        range(places().map(|(x, _)| x)),
        range(places().map(|(_, y)| y)),
        area.dim_in_pixel(),
    );
    let axes = Axes {
        title: String::new(),
        x: (x, "to the right of base_link, m"),
        y: (y, "ahead of base_link, m"),
    };
    let mut chart = style::meshed(area, &axes)?;
    let colour = style::colour(Estimator::By(roadwatch_core::Method::Fused));
    let paths = lines
        .iter()
        .map(|line| PathElement::new(*line, colour.mix(0.5)));
    chart.draw_series(paths)?;
    let rings = lines
        .iter()
        .map(|[truth, _]| Circle::new(*truth, DOT_PX + 1, REFERENCE));
    chart.draw_series(rings)?;
    let dots = lines
        .iter()
        .map(|[_, found]| Circle::new(*found, DOT_PX - 1, colour.filled()));
    chart.draw_series(dots)?;
    chart.draw_series([TriangleMarker::new(foot, 3 * DOT_PX, BLACK.filled())])?;
    Ok(())
}

/// The samples of what was published, of the camera with the most of them.
fn busiest(table: &SampleTable) -> Vec<&Sample> {
    let mut cameras: BTreeMap<&str, Vec<&Sample>> = BTreeMap::new();
    for sample in table.of(Estimator::Published) {
        if sample.estimate.is_some() {
            cameras
                .entry(&sample.target.camera)
                .or_default()
                .push(sample);
        }
    }
    cameras
        .into_values()
        .max_by_key(Vec::len)
        .unwrap_or_default()
}

fn line(sample: &Sample) -> Option<Line> {
    let center = sample.target.object.center;
    let found = sample.estimate?.place;
    Some([to_plot([center.x(), center.y()]), to_plot(found)])
}

/// The vehicle's forward axis points up the picture.
pub(super) fn to_plot([x, y]: [f64; 2]) -> (f64, f64) {
    (-y, x)
}

pub(super) fn range(values: impl Iterator<Item = f64> + Clone) -> Range<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    low - MARGIN_M..high + MARGIN_M
}

/// Both ranges widened so that a metre is as long across as up.
pub(super) fn square(
    x: Range<f64>,
    y: Range<f64>,
    (width, height): (u32, u32),
) -> (Range<f64>, Range<f64>) {
    let metres_per_px =
        ((x.end - x.start) / f64::from(width)).max((y.end - y.start) / f64::from(height));
    let widened = |range: Range<f64>, px: u32| {
        let (middle, half) = (
            (range.start + range.end) / 2.0,
            metres_per_px * f64::from(px) / 2.0,
        );
        middle - half..middle + half
    };
    (widened(x, width), widened(y, height))
}
