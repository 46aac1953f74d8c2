//! Plots of the studies on simulation.

mod curves;
mod heat;
mod paths;
mod vehicles;
mod weights;

use super::{Drawn, Plot, PlotError};
use crate::study::Study;
use std::path::Path;

/// How a plot of a study is drawn into a file; false when there is nothing to draw.
type Draw = fn(&Study, &Path) -> Result<bool, Box<dyn std::error::Error + Send + Sync>>;

/// Every plot of a study.
const PLOTS: [(Plot, Draw); 5] = [
    (
        Plot {
            file: "paths.png",
            title: "error of the distance along the X path and the Y path",
        },
        |study, file| drawn(!study.paths.is_empty(), || paths::paths(&study.paths, file)),
    ),
    (
        Plot {
            file: "heat.png",
            title: "accuracy over the grid for the paper's four F values",
        },
        |study, file| of(study.focal.as_ref(), |focal| heat::heat(focal, file)),
    ),
    (
        Plot {
            file: "focal.png",
            title: "accuracy and coverage against F and against errors of height",
        },
        |study, file| of(study.focal.as_ref(), |focal| curves::curves(focal, file)),
    ),
    (
        Plot {
            file: "weight.png",
            title: "location error against the weight of the look-up table",
        },
        |study, file| {
            of(study.weights.as_ref(), |weights| {
                weights::weights(weights, file)
            })
        },
    ),
    (
        Plot {
            file: "vehicles.png",
            title: "every method against the best constant height, at random headings",
        },
        |study, file| {
            of(study.vehicles.as_ref(), |found| {
                vehicles::vehicles(found, file)
            })
        },
    ),
];

/// Draws every plot for which something was studied into a folder.
///
/// # Errors
/// When a file cannot be written.
pub fn draw_study(study: &Study, folder: &Path) -> Result<Vec<Plot>, PlotError> {
    let mut shown = Vec::new();
    for (plot, draw) in PLOTS {
        let file = folder.join(plot.file);
        match draw(study, &file) {
            Ok(true) => shown.push(plot),
            Ok(false) => {}
            Err(cause) => return Err(PlotError { file, cause }),
        }
    }
    Ok(shown)
}

fn of<T>(
    part: Option<&T>,
    draw: impl FnOnce(&T) -> Drawn,
) -> Result<bool, Box<dyn std::error::Error + Send + Sync>> {
    part.map_or(Ok(false), |part| draw(part).map(|()| true))
}

fn drawn(
    wanted: bool,
    draw: impl FnOnce() -> Drawn,
) -> Result<bool, Box<dyn std::error::Error + Send + Sync>> {
    of(wanted.then_some(&()), |()| draw())
}
