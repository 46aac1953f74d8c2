//! `study.md`.

use super::{
    FocalStudy, HEIGHT_ERRORS_M, PathFigures, PathStudy, Point, Study, VehicleGroup, WeightStudy,
    WeightValue, path_figures,
};
use crate::report::markdown::{metres, percent, row, signed_percent};
use std::fmt::Write as _;

impl Study {
    /// The study as Markdown, without its plots.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let mut text = self.opening();
        for (name, figures) in self.path_groups() {
            text.push_str(&path_table(name, &figures));
        }
        if !self.paths.is_empty() {
            text.push_str(&drive_table(&self.paths));
        }
        if let Some(focal) = &self.focal {
            text.push_str(&focal_tables(focal));
        }
        if let Some(weights) = &self.weights {
            text.push_str(&weight_table(weights));
        }
        for group in self.vehicles.iter().flat_map(|found| &found.groups) {
            text.push_str(&vehicle_table(group));
        }
        text
    }

    fn opening(&self) -> String {
        let mut text = format!(
            "# The paper's studies, on simulation\n\nBoxes: {}.\n\n| scene | folder | vehicles in images | seen |\n|---|---|---|---|\n",
            self.boxes.as_str()
        );
        for scene in &self.scenes {
            text.push_str(&row([
                scene.shape.to_string(),
                scene.folder.display().to_string(),
                scene.positions.to_string(),
                scene.seen.len().to_string(),
            ]));
        }
        if let Some(measured) = self.measured {
            // Writing to a String cannot fail.
            writeln!(
                text,
                "\nF by eq. 1: {:.1} px, of a box {:.0} px high at {:.2} m, {:.3} m high in reality.",
                measured.focal.focal_px, measured.height_px, measured.depth_m, measured.size_m
            )
            .ok();
        }
        text
    }
}

fn path_table(path: &str, figures: &[(&'static str, PathFigures)]) -> String {
    let mut text = format!(
        "\n## Paths (Fig. 3): {path}\n\n| method | n | mean rel. error | bias | > 1.5 m | > 1.5 m below 25 m | covered | location p50 m | p90 m |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for (name, figures) in figures {
        text.push_str(&row([
            (*name).to_owned(),
            figures.distance.n.to_string(),
            percent(figures.distance.mean_relative_error),
            signed_percent(figures.distance.bias_relative),
            figures.major_errors.to_string(),
            format!("{} of {}", figures.major_errors_near, figures.near),
            percent(figures.coverage_90),
            metres(figures.location.p50_m),
            metres(figures.location.p90_m),
        ]));
    }
    text
}

/// Every drive by itself, one line each.
fn drive_table(drives: &[PathStudy]) -> String {
    let names: Vec<_> = path_figures(drives.iter())
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    let mut text = format!(
        "\n## Paths, drive by drive: covered, and major errors below 25 m\n\n| drive | {} |\n|---|{}\n",
        names.join(" | "),
        "---|".repeat(names.len())
    );
    for drive in drives {
        let found = path_figures(std::iter::once(drive));
        let cells = names.iter().map(|wanted| {
            let found = found.iter().find(|(name, _)| name == wanted);
            found.map_or_else(String::new, |(_, found)| {
                let covered = percent(found.coverage_90);
                format!("{covered}, {} of {}", found.major_errors_near, found.near)
            })
        });
        let name = format!("{}, {}", drive.shape, drive.vehicle);
        text.push_str(&row(std::iter::once(name).chain(cells)));
    }
    text
}

fn focal_tables(focal: &FocalStudy) -> String {
    let mut text = String::from(
        "\n## F over the grid (Fig. 4), real height in eq. 2\n\n| W, m | F, px | accuracy | covered |\n|---|---|---|---|\n",
    );
    for published in &focal.published {
        text.push_str(&row([
            format!("{}", published.size_m),
            format!("{:.2}", published.focal.focal_px),
            percent(published.point.accuracy),
            percent(published.point.coverage_90),
        ]));
    }
    // Writing to a String cannot fail.
    write!(
        text,
        "\n## Errors of height over the grid (Fig. 5), F {:.1} px where it is right\n\n\
         In brackets: against no error, in shares of it.\n\n\
         | error, m | accuracy, height wrong in eq. 2 | covered | accuracy, F wrong by eq. 1 | covered |\n|---|---|---|---|---|\n",
        focal.right.focal_px
    )
    .ok();
    for error_m in [&[0.0], &HEIGHT_ERRORS_M[..]].concat() {
        let cells = [&focal.in_distance, &focal.in_focal].map(|curve| {
            let base = FocalStudy::at(curve, 0.0);
            let point = FocalStudy::at(curve, error_m);
            let of = |figure: fn(&Point) -> Option<f64>| {
                change(point.and_then(figure), base.and_then(figure))
            };
            [of(|point| point.accuracy), of(|point| point.coverage_90)]
        });
        let cells = std::iter::once(format!("{error_m:+.1}")).chain(cells.into_iter().flatten());
        text.push_str(&row(cells));
    }
    text
}

/// A share, and by what share of the base it is more or less.
fn change(share: Option<f64>, base: Option<f64>) -> String {
    let change = share.zip(base).map(|(share, base)| share / base - 1.0);
    format!("{} ({})", percent(share), signed_percent(change))
}

fn weight_table(weights: &WeightStudy) -> String {
    let mut text = String::from(
        "\n## Weight of the table (Fig. 8)\n\nLocation error of cars, m: distance fitted and split at the axis, and as the paper prints them.\n\n\
         | weight | mean | p50 | p90 | as printed: mean | p50 | p90 |\n|---|---|---|---|---|---|---|\n",
    );
    for (fitted, literal) in weights.fitted.iter().zip(&weights.literal) {
        let name = match fitted.weight {
            WeightValue::PxPerMetre(value) => format!("{value}"),
            WeightValue::BoxWidth(name) => name.to_owned(),
        };
        let scores = [fitted.location, literal.location].into_iter();
        let scores = scores.flat_map(|score| [score.mae_m, score.p50_m, score.p90_m].map(metres));
        text.push_str(&row(std::iter::once(name).chain(scores)));
    }
    text
}

fn vehicle_table(group: &VehicleGroup) -> String {
    let mut text = format!(
        "\n## Random headings: {}, {} boxes\n\nBest constant height of eq. 2: {:.2} m, mean relative error {}. \
         The fused method's, against it: {}.\n\n| method | n | mean rel. error | bias | covered | location p50 m | p90 m |\n|---|---|---|---|---|---|---|\n",
        group.name,
        group.n,
        group.best_height_m,
        percent(group.best.mean_relative_error),
        signed_percent(group.fused_gain.map(|gain| -gain)),
    );
    for (name, figures) in &group.methods {
        text.push_str(&row([
            (*name).to_owned(),
            figures.distance.n.to_string(),
            percent(figures.distance.mean_relative_error),
            signed_percent(figures.distance.bias_relative),
            percent(figures.coverage_90),
            metres(figures.location.p50_m),
            metres(figures.location.p90_m),
        ]));
    }
    text
}
