//! The rotational data frame: one row per object, what was found of its key components (docs/method.md, section 5).

use crate::angle::{ObservationAngle, RayAngle};
use roadwatch_core::{
    camera_model::Pixel,
    space::{CameraGround, Point},
};
use std::{io, path::Path};

/// One component in a crop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Position in the crop; pixel centres are whole numbers.
    pub position_px: Pixel,
    /// How sure the network is, 0 to 1.
    pub score: f32,
    /// Whether the score is high enough to count.
    pub found: bool,
}

/// What was found in one crop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Height of the box over its width.
    pub aspect: f64,
    /// Per component of the model: its column as a share of the crop's width, from the left border, and its score;
    /// the column is `None` where it was not found.
    pub components: Vec<(Option<f64>, f32)>,
    /// Probability of each direction of the observation angle, evenly over a full turn from 0.
    pub facing: Vec<f32>,
}

impl Row {
    /// The row of a crop `width_px` wide.
    #[must_use]
    pub fn new(aspect: f64, width_px: u32, components: &[Component], facing: &[f32]) -> Self {
        let column = |one: &Component| {
            let share = (one.position_px.x + 0.5) / f64::from(width_px);
            (one.found.then_some(share), one.score)
        };
        Self {
            aspect,
            components: components.iter().map(column).collect(),
            facing: facing.to_vec(),
        }
    }

    /// The mean direction that the model sees, cosine and sine: as long as it is sure.
    #[must_use]
    pub fn facing_mean(&self) -> (f64, f64) {
        let bins = self.facing.len().max(1) as f64;
        let directions = self.facing.iter().zip(0..).map(|(&share, bin)| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(bin) / bins).sin_cos();
            (f64::from(share) * cos, f64::from(share) * sin)
        });
        directions.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
    }

    /// How likely an observation angle is, relative to all being alike; linear between the directions that the
    /// model knows. 1 without any.
    #[must_use]
    pub fn facing_likelihood(&self, angle: ObservationAngle) -> f64 {
        let bins = self.facing.len();
        if bins == 0 {
            return 1.0;
        }
        let at = angle.radians() / std::f64::consts::TAU * bins as f64;
        let below = at.floor();
        let share = |bin: f64| f64::from(self.facing[bin.rem_euclid(bins as f64) as usize]);
        let aside = at - below;
        (share(below) * (1.0 - aside) + share(below + 1.0) * aside) * bins as f64
    }
}

/// A row with what is true of its object.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelledRow {
    /// What was found.
    pub row: Row,
    /// The object's angle to the ray it is seen along.
    pub angle: ObservationAngle,
    /// The middle of its footprint: LocX is `-y`, LocY is `x` (docs/method.md, section 3).
    pub place: Point<CameraGround>,
    /// Height of the box in the image, pixels.
    pub box_height_px: f64,
}

/// Rows of one model, with its components' names.
#[derive(Clone, Debug, PartialEq)]
pub struct RowTable {
    /// In the order of [`Row::components`].
    pub components: Vec<String>,
    /// Directions in [`Row::facing`].
    pub facing_bins: usize,
    /// The rows.
    pub rows: Vec<LabelledRow>,
}

/// Rows that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RowError {
    /// The file.
    #[error("cannot read or write the rows: {0}")]
    File(#[from] csv::Error),
    /// The disk.
    #[error("cannot write the rows: {0}")]
    Disk(#[from] io::Error),
    /// Not a file of rows.
    #[error(
        "column {column} is `{found}`, expected `{expected}`: not a file of `roadwatch rotation rows`"
    )]
    Header {
        /// From 1.
        column: usize,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// A cell that is no number.
    #[error("line {line}: `{cell}` in column `{column}` is not a number")]
    Cell {
        /// From 1, the header included.
        line: u64,
        /// Its name.
        column: String,
        /// What is there.
        cell: String,
    },
}

/// Columns before those of the components.
const LEADING: [&str; 5] = [
    "observation_deg",
    "loc_x_m",
    "loc_y_m",
    "box_height_px",
    "aspect",
];

impl LabelledRow {
    /// Horizontal distance from the camera, metres.
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.place.x().hypot(self.place.y())
    }

    /// The ray it is seen along, against the camera's own direction.
    #[must_use]
    pub fn ray(&self) -> RayAngle {
        RayAngle::towards(self.place.x(), self.place.y())
    }
}

impl RowTable {
    /// Writes the table as CSV: `observation_deg, loc_x_m, loc_y_m, box_height_px, aspect`, then `<name>_x` (share
    /// of the crop's width; empty where not found) and `<name>_score` per component, then `facing_0`, ….
    ///
    /// # Errors
    /// When the disk does not take it.
    pub fn write(&self, file: &Path) -> Result<(), RowError> {
        let mut writer = csv::Writer::from_path(file)?;
        writer.write_record(self.header())?;
        for labelled in &self.rows {
            let leading = [
                labelled.angle.radians().to_degrees(),
                -labelled.place.y(),
                labelled.place.x(),
                labelled.box_height_px,
                labelled.row.aspect,
            ];
            let mut cells: Vec<String> = leading.iter().map(ToString::to_string).collect();
            for (column, score) in &labelled.row.components {
                cells.push(column.map_or_else(String::new, |x| x.to_string()));
                cells.push(score.to_string());
            }
            cells.extend(labelled.row.facing.iter().map(ToString::to_string));
            writer.write_record(&cells)?;
        }
        Ok(writer.flush()?)
    }

    /// Reads what [`Self::write`] wrote.
    ///
    /// # Errors
    /// A file that is not such a table, with line and column.
    pub fn read(file: &Path) -> Result<Self, RowError> {
        let mut reader = csv::Reader::from_path(file)?;
        let header: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
        let names = header.iter().filter_map(|name| name.strip_suffix("_score"));
        let mut table = Self {
            components: names.map(str::to_owned).collect(),
            facing_bins: header
                .iter()
                .filter(|name| name.starts_with("facing_"))
                .count(),
            rows: Vec::new(),
        };
        let expected = table.header();
        for at in 0..expected.len().max(header.len()) {
            let cell = |names: &[String]| names.get(at).cloned().unwrap_or_default();
            if cell(&expected) != cell(&header) {
                return Err(RowError::Header {
                    column: at + 1,
                    found: cell(&header),
                    expected: cell(&expected),
                });
            }
        }
        for (record, line) in reader.records().zip(2..) {
            let row = Cells {
                record: &record?,
                header: &header,
                line,
            };
            table.rows.push(row.labelled(table.components.len())?);
        }
        Ok(table)
    }

    fn header(&self) -> Vec<String> {
        let leading = LEADING.map(str::to_owned).into_iter();
        let named = |name: &String| [format!("{name}_x"), format!("{name}_score")];
        let facing = (0..self.facing_bins).map(|bin| format!("facing_{bin}"));
        leading
            .chain(self.components.iter().flat_map(named))
            .chain(facing)
            .collect()
    }
}

/// One line of a file of rows.
struct Cells<'a> {
    record: &'a csv::StringRecord,
    header: &'a [String],
    line: u64,
}

impl Cells<'_> {
    fn labelled(&self, components: usize) -> Result<LabelledRow, RowError> {
        let of = |number: usize| {
            let at = LEADING.len() + 2 * number;
            let column = if self.record[at].is_empty() {
                None
            } else {
                Some(self.number(at)?)
            };
            Ok((column, self.number(at + 1)? as f32))
        };
        let facing = LEADING.len() + 2 * components..self.header.len();
        let facing = facing.map(|at| Ok(self.number(at)? as f32));
        Ok(LabelledRow {
            angle: ObservationAngle::new(self.number(0)?.to_radians()),
            place: Point::new(self.number(2)?, -self.number(1)?, 0.0),
            box_height_px: self.number(3)?,
            row: Row {
                aspect: self.number(4)?,
                components: (0..components).map(of).collect::<Result<_, RowError>>()?,
                facing: facing.collect::<Result<_, RowError>>()?,
            },
        })
    }

    fn number(&self, at: usize) -> Result<f64, RowError> {
        let cell = &self.record[at];
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| RowError::Cell {
            line: self.line,
            column: self.header[at].clone(),
            cell: cell.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> RowTable {
        let row = Row {
            aspect: 0.75,
            components: vec![(Some(0.25), 0.9), (None, 0.125)],
            facing: vec![0.0, 0.75, 0.25, 0.0],
        };
        RowTable {
            components: vec!["plate_front".to_owned(), "plate_rear".to_owned()],
            facing_bins: 4,
            rows: vec![LabelledRow {
                row,
                angle: ObservationAngle::new(1.5),
                place: Point::new(20.0, -3.0, 0.0),
                box_height_px: 60.0,
            }],
        }
    }

    #[test]
    fn rows_come_back_from_a_file_as_they_were() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("rows.csv");
        table().write(&file).expect("written");
        let read = RowTable::read(&file).expect("rows");
        assert_eq!(read.components, table().components);
        assert_eq!(read.rows[0].row, table().rows[0].row);
        assert_eq!(read.rows[0].place, table().rows[0].place);
        assert!(read.rows[0].angle.apart_rad(table().rows[0].angle) < 1e-9);
    }

    #[test]
    fn a_file_of_something_else_and_a_cell_without_a_number_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("rows.csv");
        std::fs::write(&file, "a,b\n1,2\n").expect("written");
        let refused = RowTable::read(&file).expect_err("another file").to_string();
        assert!(refused.contains("observation_deg"), "{refused}");
        table().write(&file).expect("written");
        let text = std::fs::read_to_string(&file)
            .expect("text")
            .replace("0.75,", "many,");
        std::fs::write(&file, text).expect("written");
        let refused = RowTable::read(&file).expect_err("no number").to_string();
        assert!(
            refused.contains("line 2") && refused.contains("aspect"),
            "{refused}"
        );
    }

    #[test]
    fn the_likelihood_of_an_angle_lies_between_its_neighbours() {
        let row = &table().rows[0].row;
        let at = |deg: f64| row.facing_likelihood(ObservationAngle::new(deg.to_radians()));
        assert!((at(90.0) - 3.0).abs() < 1e-9 && (at(180.0) - 1.0).abs() < 1e-9);
        assert!((at(135.0) - 2.0).abs() < 1e-9 && at(-45.0).abs() < 1e-9);
    }
}
