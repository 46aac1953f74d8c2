//! Location error against the weight of eq. 7 (the paper, Fig. 8).

use crate::{
    plots::{
        Drawn,
        style::{self, Axes},
    },
    score::LocationScore,
    study::{WeightPoint, WeightStudy, WeightValue},
};
use plotters::prelude::*;
use std::path::Path;

const SIZE_PX: (u32, u32) = (1300, 640);
/// The default way and the paper's, by colour.
const FITTED: RGBColor = RGBColor(0, 158, 115);
const LITERAL: RGBColor = RGBColor(213, 94, 0);
const DOT_PX: i32 = 6;
/// Room above the highest point.
const HEADROOM: f64 = 1.1;

pub(super) fn weights(weights: &WeightStudy, file: &Path) -> Drawn {
    let names: Vec<String> = weights.fitted.iter().map(name).collect();
    let all = weights.fitted.iter().chain(&weights.literal);
    let highest = all.filter_map(|point| point.location.p90_m);
    let highest = highest.fold(1.0, f64::max);
    let picture = style::picture(file, SIZE_PX)?;
    let title = "location error of cars by the look-up table; rings: 90 % are better, dots: half";
    let below = style::titled(&picture, title)?;
    let right = names.len() as f64 - 0.5;
    let axes = Axes {
        title: String::new(),
        x: (
            -0.5..right,
            "weight, px per metre at an image width of 960 px",
        ),
        y: (0.0..highest * HEADROOM, "location error, m"),
    };
    let mut chart = style::banded(&below, &axes, &names)?;
    let ways = [
        ("defaults", FITTED, &weights.fitted),
        ("as printed", LITERAL, &weights.literal),
    ];
    for (name, colour, points) in ways {
        let half = places(points, |score| score.p50_m);
        let most = places(points, |score| score.p90_m);
        chart.draw_series(LineSeries::new(
            numbers(points, &half),
            colour.stroke_width(3),
        ))?;
        chart.draw_series(LineSeries::new(
            numbers(points, &most),
            colour.stroke_width(1),
        ))?;
        chart
            .draw_series(
                half.into_iter()
                    .map(|at| Circle::new(at, DOT_PX, colour.filled())),
            )?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 10, y), DOT_PX, colour.filled()));
        let rings = most.into_iter();
        chart.draw_series(rings.map(|at| Circle::new(at, DOT_PX, colour.stroke_width(2))))?;
    }
    style::legend(&mut chart, SeriesLabelPosition::MiddleLeft)?;
    Ok(picture.present()?)
}

fn name(point: &WeightPoint) -> String {
    match point.weight {
        WeightValue::PxPerMetre(value) => format!("{value}"),
        WeightValue::BoxWidth(name) => name.replace('_', " "),
    }
}

fn places(points: &[WeightPoint], figure: fn(&LocationScore) -> Option<f64>) -> Vec<(f64, f64)> {
    let each = points.iter().enumerate();
    each.filter_map(|(at, point)| Some((at as f64, figure(&point.location)?)))
        .collect()
}

/// Only numbers lie on a line: the box's width is beside it.
fn numbers(points: &[WeightPoint], places: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let pairs = points.iter().zip(places);
    pairs
        .filter(|(point, _)| matches!(point.weight, WeightValue::PxPerMetre(_)))
        .map(|(_, place)| *place)
        .collect()
}
