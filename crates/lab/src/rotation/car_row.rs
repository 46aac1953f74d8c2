//! Cars in one row that point the same way, before and after each calibration (the paper, Fig. 13.1 to 13.3).

use crate::score::quantile;
use roadwatch_rotate::{Forest, LabelledRow, ObservationAngle, PositionCurve, RowTable, Yaw};
use serde::Serialize;
use std::collections::BTreeMap;

/// One place of a row, medians over everything that stood there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceInRow {
    /// Metres to the right of the optical axis.
    pub loc_x_m: f64,
    /// Looks at objects there.
    pub n: usize,
    /// How far the heading is off without any calibration, by the paper's curve, by the exact ray, degrees
    /// counter-clockwise.
    pub off_deg: [f64; CALIBRATIONS.len()],
}

/// A row of cars.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CarRow {
    /// Metres ahead.
    pub loc_y_m: f64,
    /// From left to right.
    pub places: Vec<PlaceInRow>,
    /// Greatest less least of the places, by calibration, degrees.
    pub spread_deg: [f64; CALIBRATIONS.len()],
}

/// How an observation angle becomes a heading, in the order of the figures.
pub const CALIBRATIONS: [&str; 3] = [
    "none (Fig. 13.1)",
    "the paper's curve (Fig. 13.3)",
    "the exact ray",
];

/// The rows that cars stand in, nearest first: places are told apart by whole metres.
#[must_use]
pub fn car_rows(table: &RowTable, forest: &Forest, curve: &PositionCurve) -> Vec<CarRow> {
    let mut features = Vec::new();
    let mut rows: BTreeMap<i64, BTreeMap<i64, Vec<[f64; CALIBRATIONS.len()]>>> = BTreeMap::new();
    for labelled in &table.rows {
        let found = forest.turn(&labelled.row, &mut features).angle;
        let [ahead, left] = [labelled.place.x(), labelled.place.y()].map(|m| m.round() as i64);
        let row = rows.entry(ahead).or_default();
        row.entry(-left)
            .or_default()
            .push(off_deg(labelled, found, curve));
    }
    let row = |(ahead, places): (i64, BTreeMap<i64, Vec<_>>)| {
        let places: Vec<PlaceInRow> = places.into_iter().map(place).collect();
        let spread = |at: usize| {
            let off = places.iter().map(|place| place.off_deg[at]);
            off.clone().fold(f64::NEG_INFINITY, f64::max) - off.fold(f64::INFINITY, f64::min)
        };
        CarRow {
            loc_y_m: ahead as f64,
            spread_deg: std::array::from_fn(spread),
            places,
        }
    };
    rows.into_iter().map(row).collect()
}

fn place((loc_x, looks): (i64, Vec<[f64; CALIBRATIONS.len()]>)) -> PlaceInRow {
    let median = |at: usize| quantile(looks.iter().map(|off| off[at]), 0.5).unwrap_or_default();
    PlaceInRow {
        loc_x_m: loc_x as f64,
        n: looks.len(),
        off_deg: std::array::from_fn(median),
    }
}

fn off_deg(
    labelled: &LabelledRow,
    found: ObservationAngle,
    curve: &PositionCurve,
) -> [f64; CALIBRATIONS.len()] {
    let heading = labelled.angle.seen_along(labelled.ray());
    let said = [
        Yaw::new(found.radians()),
        found.seen_along(curve.ray(-labelled.place.y())),
        found.seen_along(labelled.ray()),
    ];
    said.map(|yaw| {
        Yaw::new(yaw.radians() - heading.radians())
            .radians()
            .to_degrees()
    })
}

/// A table per row.
#[must_use]
pub(crate) fn to_markdown(rows: &[CarRow]) -> String {
    let mut text = String::new();
    for row in rows {
        text += &format!(
            "\n{} m ahead, degrees off in the median:\n\n| calibration |{} spread |\n|---|{}---|\n",
            row.loc_y_m,
            row.places
                .iter()
                .map(|at| format!(" {:+} m (n {}) |", at.loc_x_m, at.n))
                .collect::<String>(),
            "---|".repeat(row.places.len()),
        );
        for (at, calibration) in CALIBRATIONS.iter().enumerate() {
            let places = row.places.iter();
            let off = places.map(|place| format!(" {:+.1} |", place.off_deg[at]));
            let (off, spread) = (off.collect::<String>(), row.spread_deg[at]);
            text += &format!("| {calibration} |{off} {spread:.1} |\n");
        }
    }
    text
}
