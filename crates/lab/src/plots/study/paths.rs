//! Errors along the X path and the Y path (the paper, Fig. 3).

use crate::{
    plots::{
        Drawn,
        style::{self, Area, Axes},
    },
    sample::{Estimator, Sample},
    score::MAJOR_ERROR_M,
    study::{PathStudy, Shape},
};
use plotters::prelude::*;
use roadwatch_core::Method;
use std::path::Path;

const PANEL_PX: (u32, u32) = (1400, 400);
/// Larger errors are drawn at the edge, metres.
const MOST_M: f64 = 6.0;
const LINE_PX: u32 = 3;
/// The lines of major errors are red in the paper.
const MAJOR: RGBColor = RGBColor(200, 30, 30);

pub(super) fn paths(paths: &[PathStudy], file: &Path) -> Drawn {
    let height = PANEL_PX.1 * paths.len() as u32 + 2 * style::TITLE_PX as u32;
    let picture = style::picture(file, (PANEL_PX.0, height))?;
    let title = "error of the distance; red: major errors, 1.5 m";
    let below = style::titled(&picture, title)?;
    for (area, path) in below.split_evenly((paths.len(), 1)).iter().zip(paths) {
        panel(area, path)?;
    }
    Ok(picture.present()?)
}

fn panel(area: &Area<'_>, path: &PathStudy) -> Drawn {
    let (name, label) = match path.shape {
        Shape::XPath => ("X path", "place across the optical axis, right positive, m"),
        _ => ("Y path", "true distance, m"),
    };
    let places = path.samples.iter().map(|sample| place(path, sample));
    let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
        (low.min(at), high.max(at))
    });
    let axes = Axes {
        title: format!("{name}, {}", path.vehicle),
        // Room for the legend on the right.
        x: (low..low + (high - low) * 1.3, label),
        y: (-MOST_M..MOST_M, "error, m"),
    };
    let mut chart = style::meshed(area, &axes)?;
    for error_m in [-MAJOR_ERROR_M, MAJOR_ERROR_M] {
        let ends = [(low, error_m), (high, error_m)];
        chart.draw_series(LineSeries::new(ends, MAJOR.stroke_width(2)))?;
    }
    for (name, colour, samples) in series(path) {
        let points = samples.into_iter().filter_map(|sample| {
            let error_m = sample.estimate.as_ref()?.range_m - sample.target.range_m;
            Some((place(path, sample), error_m.clamp(-MOST_M, MOST_M)))
        });
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(LINE_PX)))?
            .label(name)
            .legend(move |(x, y)| {
                PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(LINE_PX))
            });
    }
    style::legend(&mut chart, SeriesLabelPosition::UpperRight)
}

/// One line of a panel.
type Series<'a> = (String, RGBColor, Vec<&'a Sample>);

fn series(path: &PathStudy) -> Vec<Series<'_>> {
    let known = (
        "eq. 2, real height".to_owned(),
        BLACK,
        path.known.iter().collect(),
    );
    let methods = Method::ALL.into_iter().map(Estimator::By).map(|who| {
        let samples = path.samples.iter();
        let samples = samples.filter(|sample| sample.estimator == who).collect();
        (who.to_string(), style::colour(who), samples)
    });
    let all: Vec<Series<'_>> = std::iter::once(known).chain(methods).collect();
    all.into_iter()
        .filter(|(_, _, samples)| !samples.is_empty())
        .map(|(name, colour, mut samples)| {
            samples.sort_by(|a, b| place(path, a).total_cmp(&place(path, b)));
            (name, colour, samples)
        })
        .collect()
}

fn place(path: &PathStudy, sample: &Sample) -> f64 {
    let target = &sample.target;
    match path.shape {
        // A simulated camera of a path looks along base_link's x.
        Shape::XPath => target.foot[1] - target.object.center.y(),
        _ => target.range_m,
    }
}
