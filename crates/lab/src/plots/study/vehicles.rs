//! Mean relative errors of every method beside the best constant height.

use crate::{
    plots::{
        Drawn,
        style::{self, Area, Axes, REFERENCE},
    },
    sample::Estimator,
    study::{VehicleGroup, VehicleStudy},
};
use plotters::prelude::*;
use roadwatch_core::Method;
use std::path::Path;

const PANEL_PX: (u32, u32) = (1300, 480);
/// Half of a bar, in places.
const HALF_BAR: f64 = 0.35;
/// Room above the highest bar.
const HEADROOM: f64 = 1.15;

pub(super) fn vehicles(study: &VehicleStudy, file: &Path) -> Drawn {
    let rows = study.groups.len();
    let size = (
        PANEL_PX.0,
        PANEL_PX.1 * rows as u32 + 2 * style::TITLE_PX as u32,
    );
    let picture = style::picture(file, size)?;
    let below = style::titled(&picture, "mean relative error of the distance")?;
    for (area, group) in below.split_evenly((rows, 1)).iter().zip(&study.groups) {
        panel(area, group)?;
    }
    Ok(picture.present()?)
}

fn panel(area: &Area<'_>, group: &VehicleGroup) -> Drawn {
    let best = group.best.mean_relative_error.unwrap_or_default();
    let constant = (
        format!("{:.2} m for all", group.best_height_m),
        REFERENCE,
        best,
    );
    let methods = Method::ALL.into_iter().filter_map(|method| {
        let error = group
            .methods
            .get(method.as_str())?
            .distance
            .mean_relative_error?;
        let colour = style::colour(Estimator::By(method));
        Some((method.as_str().to_owned(), colour, error))
    });
    let bars: Vec<_> = std::iter::once(constant).chain(methods).collect();
    let names: Vec<_> = bars.iter().map(|(name, ..)| name.clone()).collect();
    let highest = bars
        .iter()
        .fold(0.01_f64, |most, (_, _, error)| most.max(*error));
    let axes = Axes {
        title: format!("{}, {} boxes, random headings", group.name, group.n),
        x: (-0.6..bars.len() as f64 - 0.4, ""),
        y: (0.0..highest * 100.0 * HEADROOM, "%"),
    };
    let mut chart = style::banded(area, &axes, &names)?;
    chart.draw_series(bars.iter().enumerate().map(|(at, (_, colour, error))| {
        let middle = at as f64;
        let corners = [(middle - HALF_BAR, 0.0), (middle + HALF_BAR, error * 100.0)];
        Rectangle::new(corners, colour.filled())
    }))?;
    chart.draw_series(bars.iter().enumerate().map(|(at, (_, _, error))| {
        let percent = error * 100.0;
        let place = (at as f64 - 0.15, percent + highest * 8.0);
        Text::new(
            format!("{percent:.1} %"),
            place,
            style::text(style::TEXT_PX),
        )
    }))?;
    Ok(())
}
