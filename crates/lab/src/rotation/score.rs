//! How far a forest's angles are off: in all, and by what makes them hard.

use super::car_row::{self, CALIBRATIONS, CarRow, car_rows};
use crate::{
    plots::{self, PlotError},
    score::{mean, quantile, share},
};
use roadwatch_rotate::{Forest, LabelledRow, PositionCurve, RowTable};
use serde::Serialize;
use serde_json::json;
use std::{collections::BTreeMap, fs, io, path::Path};

/// An angle that is off by more than this is turned round, degrees (docs/method.md, section 5).
const FLIP_DEG: f64 = 135.0;
/// Width of a band of angles, degrees.
const ANGLE_BAND_DEG: f64 = 45.0;
/// Width of a band of distances, metres.
const RANGE_BAND_M: f64 = 10.0;
/// Lower ends of bands of box heights, pixels.
const HEIGHT_BANDS_PX: [f64; 5] = [0.0, 30.0, 40.0, 60.0, 100.0];

/// Errors of angles, flips apart.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RotationScore {
    /// Rows.
    pub n: usize,
    /// Mean error, degrees.
    pub mean_abs_deg: Option<f64>,
    /// Median error, degrees.
    pub median_abs_deg: Option<f64>,
    /// Mean error of those that are not turned round, degrees.
    pub unflipped_mean_abs_deg: Option<f64>,
    /// Share that is turned round: off by more than 135 degrees (docs/method.md, section 5).
    pub flip_share: Option<f64>,
    /// Share of those not turned round whose error is within the deviation that the forest gave: 68 % of a Gaussian's.
    pub share_1_sigma: Option<f64>,
}

/// A row's true and estimated angle, degrees in -180 to 180.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Answer {
    pub(crate) true_deg: f64,
    pub(crate) found_deg: f64,
    pub(crate) off_deg: f64,
    pub(crate) std_deg: f64,
}

/// Forests side by side on the same rows.
#[derive(Debug)]
pub struct RotationReport {
    forests: Vec<(String, Vec<Answer>)>,
    rows: Vec<Groups>,
    /// By forest, where cars in a row were looked at.
    car_rows: Vec<(String, Vec<CarRow>)>,
}

/// What a row belongs to.
#[derive(Debug)]
struct Groups([(&'static str, String); 4]);

impl RotationScore {
    fn of<'a>(answers: impl Iterator<Item = &'a Answer> + Clone) -> Self {
        let off: Vec<f64> = answers.clone().map(|answer| answer.off_deg).collect();
        let unflipped: Vec<f64> = off.iter().copied().filter(|&deg| deg <= FLIP_DEG).collect();
        let within = answers.filter(|answer| answer.off_deg <= answer.std_deg.min(FLIP_DEG));
        Self {
            n: off.len(),
            mean_abs_deg: mean(off.iter().copied()),
            median_abs_deg: quantile(off.iter().copied(), 0.5),
            unflipped_mean_abs_deg: mean(unflipped.iter().copied()),
            flip_share: share(off.len() - unflipped.len(), off.len()),
            share_1_sigma: share(within.count(), unflipped.len()),
        }
    }
}

impl RotationReport {
    /// Has every forest, under its name, answer every row.
    #[must_use]
    pub fn new(table: &RowTable, forests: &[(String, Forest)]) -> Self {
        let answers = |forest: &Forest| {
            let mut features = Vec::new();
            let answer = |labelled: &LabelledRow| {
                let turned = forest.turn(&labelled.row, &mut features);
                let found = turned.angle;
                Answer {
                    true_deg: labelled.angle.radians().to_degrees(),
                    found_deg: found.radians().to_degrees(),
                    off_deg: found.apart_rad(labelled.angle).to_degrees(),
                    std_deg: turned.std_dev_rad.to_degrees(),
                }
            };
            table.rows.iter().map(answer).collect()
        };
        Self {
            forests: forests
                .iter()
                .map(|(name, forest)| (name.clone(), answers(forest)))
                .collect(),
            rows: table.rows.iter().map(Groups::of).collect(),
            car_rows: Vec::new(),
        }
    }

    /// With cars in a row, before and after each calibration.
    #[must_use]
    pub fn with_car_rows(
        mut self,
        (table, curve): (&RowTable, &PositionCurve),
        forests: &[(String, Forest)],
    ) -> Self {
        let of = |(name, forest): &(String, Forest)| (name.clone(), car_rows(table, forest, curve));
        self.car_rows = forests.iter().map(of).collect();
        self
    }

    /// `forests.<name>.{all,by.<grouping>.<group>}`, and `car_rows.<name>` where cars in a row were looked at.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let of = |(name, answers): &(String, Vec<Answer>)| {
            let scores = json!({
                "all": RotationScore::of(answers.iter()),
                "by": self.by_group(answers),
            });
            (name.clone(), scores)
        };
        let car_rows = self.car_rows.iter();
        let car_rows = car_rows.map(|(name, rows)| (name.clone(), json!(rows)));
        json!({
            "forests": self.forests.iter().map(of).collect::<serde_json::Map<_, _>>(),
            "calibrations": CALIBRATIONS,
            "car_rows": car_rows.collect::<serde_json::Map<_, _>>(),
        })
    }

    /// The same as tables.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let mut text =
            "# Rotation\n\nAngles to the viewing ray, from rows of key components.\n".to_owned();
        for (name, answers) in &self.forests {
            let head = "| rows | n | mean | median | mean without flips | flips | inside 1 sigma |\n|---|---|---|---|---|---|---|\n";
            text += &format!("\n## {name}\n\n{head}");
            text += &line("all", &RotationScore::of(answers.iter()));
            for (grouping, groups) in self.by_group(answers) {
                for (group, score) in groups {
                    text += &line(&format!("{grouping} {group}"), &score);
                }
            }
        }
        for (name, rows) in &self.car_rows {
            text += &format!("\n## Cars in a row, {name}\n");
            text += &car_row::to_markdown(rows);
        }
        text
    }

    /// Writes `rotation.json`, `rotation.md`, `rotation.png` and, with cars in a row, `car_rows.png` into a folder,
    /// which is made.
    ///
    /// # Errors
    /// When the disk does not take them.
    pub fn write(&self, folder: &Path) -> Result<(), RotationReportError> {
        fs::create_dir_all(folder)?;
        fs::write(
            folder.join("rotation.json"),
            format!("{:#}\n", self.to_json()),
        )?;
        fs::write(folder.join("rotation.md"), self.to_markdown())?;
        plots::draw_rotation(&self.forests, &folder.join("rotation.png"))?;
        if let Some((_, rows)) = self.car_rows.first() {
            plots::draw_car_rows(rows, &folder.join("car_rows.png"))?;
        }
        Ok(())
    }

    fn by_group(
        &self,
        answers: &[Answer],
    ) -> BTreeMap<&'static str, BTreeMap<&str, RotationScore>> {
        let mut members: BTreeMap<_, BTreeMap<&str, Vec<&Answer>>> = BTreeMap::new();
        for (answer, Groups(groups)) in answers.iter().zip(&self.rows) {
            for (grouping, group) in groups {
                let groups = members.entry(*grouping).or_default();
                groups.entry(group.as_str()).or_default().push(answer);
            }
        }
        let scored = members.into_iter().map(|(grouping, groups)| {
            let score = |(group, answers): (_, Vec<&Answer>)| {
                (group, RotationScore::of(answers.iter().copied()))
            };
            (grouping, groups.into_iter().map(score).collect())
        });
        scored.collect()
    }
}

/// A report that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum RotationReportError {
    /// The disk.
    #[error("cannot write the report")]
    Disk(#[from] io::Error),
    /// The plot.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl Groups {
    fn of(labelled: &LabelledRow) -> Self {
        let band = |value: f64, width: f64, unit: &str| {
            let low = (value / width).floor() * width;
            format!("{low:03.0} to {:.0} {unit}", low + width)
        };
        let turned = labelled.angle.radians().to_degrees().rem_euclid(360.0);
        let low = |&&low: &&f64| low <= labelled.box_height_px;
        let height = HEIGHT_BANDS_PX.iter().rev().find(low).unwrap_or(&0.0);
        let found = labelled.row.components.iter();
        let found = found.filter(|(column, _)| column.is_some()).count();
        Self([
            ("angle", band(turned, ANGLE_BAND_DEG, "deg")),
            ("distance", band(labelled.range_m(), RANGE_BAND_M, "m")),
            ("box height", format!("{height:03.0} px and more")),
            ("components found", format!("{found:02}")),
        ])
    }
}

fn line(name: &str, score: &RotationScore) -> String {
    let degrees = |value: Option<f64>| value.map_or("".to_owned(), |deg| format!("{deg:.1}°"));
    let percent =
        |share: Option<f64>| share.map_or("".to_owned(), |share| format!("{:.1} %", share * 100.0));
    format!(
        "| {name} | {} | {} | {} | {} | {} | {} |\n",
        score.n,
        degrees(score.mean_abs_deg),
        degrees(score.median_abs_deg),
        degrees(score.unflipped_mean_abs_deg),
        percent(score.flip_share),
        percent(score.share_1_sigma),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flips_are_counted_apart_from_small_errors() {
        let answer = |off_deg| Answer {
            true_deg: 0.0,
            found_deg: off_deg,
            off_deg,
            std_deg: 3.0,
        };
        let score = RotationScore::of([answer(2.0), answer(4.0), answer(178.0)].iter());
        assert_eq!((score.n, score.median_abs_deg), (3, Some(4.0)));
        assert_eq!(score.unflipped_mean_abs_deg, Some(3.0));
        assert_eq!(score.share_1_sigma, Some(0.5));
        assert!((score.flip_share.expect("a share") - 1.0 / 3.0).abs() < 1e-9);
    }
}
