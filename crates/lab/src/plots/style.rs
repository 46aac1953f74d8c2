//! How plots look: letters, colours, axes.

use crate::sample::Estimator;
use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
    style::{FontStyle, register_font},
};
use roadwatch_core::Method;
use std::{error::Error, ops::Range, path::Path};

pub(super) type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;
pub(super) type Chart<'a> =
    ChartContext<'a, BitMapBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The only letters; they come with the program, so that plots look alike everywhere.
const FONT: &str = "letters";
pub(super) const TITLE_PX: i32 = 30;
pub(super) const TEXT_PX: i32 = 22;
const LABELS_X_PX: i32 = 60;
const LABELS_Y_PX: i32 = 80;
const MARGIN_PX: i32 = 16;
const GRID: RGBColor = RGBColor(225, 225, 225);

/// Lines that say what would be good or bad.
pub(super) const REFERENCE: RGBColor = RGBColor(110, 110, 110);

/// What the axes of a chart are.
pub(super) struct Axes<'t> {
    pub(super) title: String,
    pub(super) x: (Range<f64>, &'t str),
    pub(super) y: (Range<f64>, &'t str),
}

/// An empty white picture.
pub(super) fn picture(
    file: &Path,
    size: (u32, u32),
) -> Result<Area<'_>, Box<dyn Error + Send + Sync>> {
    let letters = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    letters.map_err(|_| "the built-in letters cannot be read")?;
    let area = BitMapBackend::new(file, size).into_drawing_area();
    area.fill(&WHITE)?;
    Ok(area)
}

/// A title above; gives what is left of the picture.
pub(super) fn titled<'a>(
    area: &Area<'a>,
    title: &str,
) -> Result<Area<'a>, Box<dyn Error + Send + Sync>> {
    let below = area.margin(MARGIN_PX, 0, 0, MARGIN_PX);
    Ok(below.titled(title, (FONT, TITLE_PX).into_font())?)
}

pub(super) fn text(size_px: i32) -> TextStyle<'static> {
    (FONT, size_px).into_font().color(&BLACK)
}

/// A chart with axes, not yet with a mesh.
pub(super) fn chart<'a>(
    area: &Area<'a>,
    axes: &Axes<'_>,
) -> Result<Chart<'a>, Box<dyn Error + Send + Sync>> {
    let chart = ChartBuilder::on(area)
        .caption(&axes.title, text(TEXT_PX + 2))
        .margin(MARGIN_PX)
        .x_label_area_size(LABELS_X_PX)
        .y_label_area_size(LABELS_Y_PX)
        .build_cartesian_2d(axes.x.0.clone(), axes.y.0.clone())?;
    Ok(chart)
}

/// A chart with axes and a mesh.
pub(super) fn meshed<'a>(
    area: &Area<'a>,
    axes: &Axes<'_>,
) -> Result<Chart<'a>, Box<dyn Error + Send + Sync>> {
    let mut chart = chart(area, axes)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .label_style(text(TEXT_PX))
        .x_desc(axes.x.1)
        .y_desc(axes.y.1)
        .x_labels(8)
        .y_labels(8)
        .x_label_formatter(&short)
        .y_label_formatter(&short)
        .draw()?;
    Ok(chart)
}

/// Bars of groups: names stand below, one per whole number.
pub(super) fn banded<'a>(
    area: &Area<'a>,
    axes: &Axes<'_>,
    names: &[String],
) -> Result<Chart<'a>, Box<dyn Error + Send + Sync>> {
    let mut chart = chart(area, axes)?;
    let name = |x: &f64| {
        let whole = x.round();
        let is_whole = (x - whole).abs() < 1e-6 && whole >= 0.0;
        let name = is_whole.then(|| names.get(whole as usize)).flatten();
        name.cloned().unwrap_or_default()
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .label_style(text(TEXT_PX))
        .x_desc(axes.x.1)
        .y_desc(axes.y.1)
        .x_labels(names.len() + 2)
        .x_label_formatter(&name)
        .y_label_formatter(&short)
        .draw()?;
    Ok(chart)
}

/// A number without the digits that the arithmetic added.
fn short(number: &f64) -> String {
    // Adding zero makes 0 of -0.
    format!("{}", (number * 1e3).round() / 1e3 + 0.0)
}

/// The legend of series that were labelled.
pub(super) fn legend(chart: &mut Chart<'_>, at: SeriesLabelPosition) -> super::Drawn {
    chart
        .configure_series_labels()
        .position(at)
        .label_font(text(TEXT_PX))
        .background_style(WHITE.mix(0.85))
        .border_style(GRID)
        .draw()?;
    Ok(())
}

/// The colours that Okabe and Ito chose for colour-blind readers.
pub(super) fn colour(estimator: Estimator) -> RGBColor {
    match estimator {
        Estimator::Published => RGBColor(0, 0, 0),
        Estimator::Single => RGBColor(130, 130, 130),
        Estimator::By(Method::TriangleMeasuredF) => RGBColor(230, 159, 0),
        Estimator::By(Method::TriangleFy) => RGBColor(213, 94, 0),
        Estimator::By(Method::Table) => RGBColor(0, 158, 115),
        Estimator::By(Method::Ground) => RGBColor(204, 121, 167),
        Estimator::By(Method::Fused) => RGBColor(0, 114, 178),
    }
}
