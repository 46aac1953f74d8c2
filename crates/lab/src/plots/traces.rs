//! What the data frames hold, to look at: ways from above, headings over time.

use super::{
    Drawn, PlotError,
    from_above::{range, square, to_plot},
    style::{self, Area, Axes, Chart},
};
use plotters::prelude::*;
use std::{collections::BTreeMap, path::Path};

const SIZE_PX: (u32, u32) = (1400, 1000);
const DOT_PX: i32 = 3;
/// Names beside a picture; more of them would hide it.
const MOST_NAMED: usize = 12;
/// Room to the right of the last point, for the names.
const LEGEND_SHARE: f64 = 1.12;
/// Each hue is so far from the one before: the golden section of the circle spreads any number of them.
pub(crate) const HUE_STEP: f64 = 0.618_033_988_749_895;

/// Points of every track, in order of time.
pub type Traces = BTreeMap<i64, Vec<[f64; 2]>>;

/// Ways of tracks and of the vehicle, metres, in a frame of the given name.
///
/// # Errors
/// When the picture cannot be written.
pub fn draw_trajectories(
    traces: &Traces,
    (vehicle, frame): (&[[f64; 2]], &str),
    file: &Path,
) -> Result<(), PlotError> {
    trajectories(traces, (vehicle, frame), file).map_err(|cause| failed(file, cause))
}

/// Headings of tracks: seconds since the first stamp, and degrees.
///
/// # Errors
/// When the picture cannot be written.
pub fn draw_headings(traces: &Traces, file: &Path) -> Result<(), PlotError> {
    headings(traces, file).map_err(|cause| failed(file, cause))
}

fn failed(file: &Path, cause: Box<dyn std::error::Error + Send + Sync>) -> PlotError {
    PlotError {
        file: file.to_owned(),
        cause,
    }
}

fn trajectories(traces: &Traces, (vehicle, frame): (&[[f64; 2]], &str), file: &Path) -> Drawn {
    let picture = style::picture(file, SIZE_PX)?;
    let title = format!("{} tracks from above; black: the vehicle", traces.len());
    let area = style::titled(&picture, &title)?;
    let all = || {
        traces
            .values()
            .flatten()
            .chain(vehicle)
            .map(|place| to_plot(*place))
    };
    let (x, y) = match all().next() {
        None => (-1.0..1.0, -1.0..1.0),
        Some(_) => square(
            range(all().map(|(x, _)| x)),
            range(all().map(|(_, y)| y)),
            area.dim_in_pixel(),
        ),
    };
    let (left, ahead) = (
        format!("to the right in {frame}, m"),
        format!("ahead in {frame}, m"),
    );
    let axes = Axes {
        title: String::new(),
        x: (x, &left),
        y: (y, &ahead),
    };
    let mut chart = style::meshed(&area, &axes)?;
    let flipped = |trace: &[[f64; 2]]| trace.iter().map(|place| to_plot(*place)).collect();
    draw_all(&mut chart, traces, flipped)?;
    // On top: others drive where it drove.
    chart.draw_series([PathElement::new(flipped(vehicle), BLACK.stroke_width(2))])?;
    Ok(picture.present()?)
}

fn headings(traces: &Traces, file: &Path) -> Drawn {
    let picture: Area<'_> = style::picture(file, SIZE_PX)?;
    let title = format!("headings of {} tracks in base_link", traces.len());
    let area = style::titled(&picture, &title)?;
    let last = traces.values().flatten().map(|[time, _]| *time);
    let axes = Axes {
        title: String::new(),
        x: (0.0..LEGEND_SHARE * last.fold(1.0, f64::max), "time, s"),
        y: (
            -180.0..180.0,
            "heading, degrees, counter-clockwise from ahead",
        ),
    };
    let mut chart = style::meshed(&area, &axes)?;
    draw_all(&mut chart, traces, |trace| {
        trace.iter().map(|&[time, angle]| (time, angle)).collect()
    })?;
    Ok(picture.present()?)
}

/// Every trace as dots, the longest ones named.
fn draw_all(
    chart: &mut Chart<'_>,
    traces: &Traces,
    points: impl Fn(&[[f64; 2]]) -> Vec<(f64, f64)>,
) -> Drawn {
    let mut longest: Vec<_> = traces.iter().collect();
    longest.sort_by_key(|(id, trace)| (std::cmp::Reverse(trace.len()), **id));
    for (rank, (&id, trace)) in longest.into_iter().enumerate() {
        let colour = HSLColor((id as f64 * HUE_STEP).rem_euclid(1.0), 0.75, 0.42);
        let dots = points(trace)
            .into_iter()
            .map(|at| Circle::new(at, DOT_PX, colour.filled()));
        let series = chart.draw_series(dots)?;
        if rank < MOST_NAMED {
            let sample = move |(x, y)| Circle::new((x + 10, y), 2 * DOT_PX, colour.filled());
            series.label(format!("track {id}")).legend(sample);
        }
    }
    if traces.is_empty() {
        return Ok(());
    }
    style::legend(chart, SeriesLabelPosition::UpperRight)
}
