//! Rotation bias against LocX (the paper, Fig. 13.2).

use super::{
    Drawn, PlotError,
    style::{self, Axes, REFERENCE},
};
use crate::sample::Estimator;
use plotters::prelude::*;
use roadwatch_core::Method;
use roadwatch_rotate::{PositionCurve, position_curve::Bias};
use std::path::Path;

const SIZE_PX: (u32, u32) = (1100, 800);
const DOT_PX: i32 = 3;
const DOT_OPACITY: f64 = 0.4;
/// Points of a drawn curve.
const STEPS: u32 = 120;
/// Beyond the outermost car, metres; above the highest bias, degrees.
const MARGIN: f64 = 2.0;

/// Every row's bias, the curve through them, and the exact one for objects that far ahead.
///
/// # Errors
/// When the file cannot be written.
pub fn draw_position_curve(
    curve: &PositionCurve,
    biases: &[Bias],
    file: &Path,
) -> Result<(), PlotError> {
    drawn(curve, biases, file).map_err(|cause| PlotError {
        file: file.to_owned(),
        cause,
    })
}

fn drawn(curve: &PositionCurve, biases: &[Bias], file: &Path) -> Drawn {
    let picture = style::picture(file, SIZE_PX)?;
    let title = format!(
        "rotation bias against LocX, {} cars about {} m ahead",
        biases.len(),
        curve.loc_y_m
    );
    let below = style::titled(&picture, &title)?;
    let [least, greatest] = curve.loc_x_m;
    let off = biases.iter().map(|bias| bias.bias_rad.to_degrees().abs());
    let highest = off.fold(0.0, f64::max) + MARGIN;
    let axes = Axes {
        title: String::new(),
        x: (least - MARGIN..greatest + MARGIN, "LocX, m"),
        y: (-highest..highest, "observation angle less heading, degrees"),
    };
    let mut chart = style::meshed(&below, &axes)?;
    let dots = biases
        .iter()
        .map(|bias| (bias.loc_x_m, bias.bias_rad.to_degrees()));
    let dot = REFERENCE.mix(DOT_OPACITY).filled();
    chart.draw_series(dots.map(|at| Circle::new(at, DOT_PX, dot)))?;
    let places = (0..=STEPS).map(|step| {
        let share = f64::from(step) / f64::from(STEPS);
        least + (greatest - least) * share
    });
    let exact = places
        .clone()
        .map(|x| (x, (x / curve.loc_y_m).atan().to_degrees()));
    let fitted = places.map(|x| (x, -curve.ray(x).radians().to_degrees()));
    let colours = [
        style::colour(Estimator::By(Method::TriangleFy)),
        style::colour(Estimator::By(Method::Fused)),
    ];
    chart
        .draw_series(LineSeries::new(exact, colours[0].stroke_width(2)))?
        .label("exact: atan(LocX / LocY)")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colours[0]));
    chart
        .draw_series(LineSeries::new(fitted, colours[1].stroke_width(3)))?
        .label("the curve")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colours[1]));
    style::legend(&mut chart, SeriesLabelPosition::UpperLeft)?;
    Ok(picture.present()?)
}
