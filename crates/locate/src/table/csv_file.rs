//! The bare seven columns as CSV, in and out.

use super::{
    COLUMNS, CalibrationHash, ExpectedDistance, Grid, InvalidTable, LocationTable, SizeGroup,
    TableHeader, TableRow, check_finite, file::write_atomically,
};
use roadwatch_core::RigCamera;
use std::{
    io,
    path::{Path, PathBuf},
};

/// Cells of one column or row of a grid may differ by this much, metres.
const SAME_CELL_M: f32 = 1e-3;
/// The step of a table whose rows all stand on one spot, metres.
const STEP_OF_ONE_SPOT_M: f32 = 1.0;

/// A CSV that is no table.
#[derive(Debug, thiserror::Error)]
pub enum CsvError {
    /// The file system said no.
    #[error("{}: {cause}", path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// What it said.
        #[source]
        cause: io::Error,
    },
    /// Not CSV.
    #[error("not readable as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A column is missing.
    #[error("column `{0}` is missing; the table needs {COLUMNS:?}")]
    MissingColumn(&'static str),
    /// A field that is no number, or a `Loc` that is no cell index.
    #[error("row {row}, column {column}: `{text}` is not a number")]
    NotANumber {
        /// Counted from 1, without the header.
        row: usize,
        /// One of [`COLUMNS`].
        column: &'static str,
        /// What stands there.
        text: String,
    },
    /// Numbers that are no table.
    #[error(transparent)]
    Invalid(#[from] InvalidTable),
}

/// What a bare CSV does not say about itself.
#[derive(Clone, Copy, Debug)]
pub struct CsvOrigin<'a> {
    /// The camera whose boxes it holds.
    pub camera: &'a RigCamera,
    /// Height of the ground plane in base_link, metres.
    pub ground_z_m: f64,
    /// Whom it locates, and their size.
    pub group: &'a SizeGroup,
}

impl LocationTable {
    /// Writes the seven columns, each number with as many digits as bring it back exactly.
    ///
    /// # Errors
    /// When the file system refuses; then nothing is written.
    pub fn write_csv(&self, path: &Path) -> Result<(), CsvError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS)?;
        for row in self.rows() {
            let numbers = row.numbers().map(|number| number.to_string());
            writer.write_record(numbers.iter().chain([&row.loc.to_string()]))?;
        }
        let io_error = |cause| CsvError::Io {
            path: path.to_owned(),
            cause,
        };
        let bytes = writer
            .into_inner()
            .map_err(|error| io_error(error.into_error()))?;
        write_atomically(path, &bytes).map_err(io_error)
    }

    /// Imports the seven columns, found by name; other columns are ignored. The expected distance is
    /// plain eq. 2, and the grid's step is the median gap between the places that occur.
    ///
    /// # Errors
    /// When the CSV is not one, a column is missing, a field is not a finite number, or the places are on
    /// no grid that a table can have.
    pub fn read_csv(path: &Path, origin: CsvOrigin<'_>) -> Result<Self, CsvError> {
        let file = std::fs::File::open(path).map_err(|cause| CsvError::Io {
            path: path.to_owned(),
            cause,
        })?;
        let made = format!("imported from {}", path.display());
        let rows = read_rows(
            &mut csv::ReaderBuilder::new()
                .trim(csv::Trim::All)
                .from_reader(file),
        )?;
        check_finite(&rows)?;
        let header = TableHeader {
            camera: origin.camera.name.clone(),
            image_size: origin.camera.model.size,
            calibration: CalibrationHash::of(origin.camera, origin.ground_z_m),
            expected: ExpectedDistance::literal(origin.group.size.height_m),
            group: origin.group.clone(),
            made,
            grid: grid_of(&rows),
        };
        Ok(Self::new(header, rows)?)
    }
}

fn read_rows(reader: &mut csv::Reader<std::fs::File>) -> Result<Vec<TableRow>, CsvError> {
    let titles = reader.headers()?.clone();
    let mut places = [0; COLUMNS.len()];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = titles
            .iter()
            .position(|title| title == column)
            .ok_or(CsvError::MissingColumn(column))?;
    }
    let records = reader.records().enumerate();
    records
        .map(|(at, record)| read_row(&record?, &places, at + 1))
        .collect()
}

fn read_row(
    record: &csv::StringRecord,
    places: &[usize; COLUMNS.len()],
    row: usize,
) -> Result<TableRow, CsvError> {
    let field = |column: usize| record.get(places[column]).unwrap_or_default();
    let not_a_number = |column: usize| CsvError::NotANumber {
        row,
        column: COLUMNS[column],
        text: field(column).to_owned(),
    };
    let number = |column| {
        field(column)
            .parse::<f32>()
            .map_err(|_| not_a_number(column))
    };
    let loc = field(6).parse::<f64>().ok().and_then(cell_index);
    Ok(TableRow {
        area_px2: number(0)?,
        center_x_px: number(1)?,
        center_y_px: number(2)?,
        distance_m: number(3)?,
        loc_x_m: number(4)?,
        loc_y_m: number(5)?,
        loc: loc.ok_or_else(|| not_a_number(6))?,
    })
}

/// Spreadsheets write whole numbers as `12.0` too.
fn cell_index(number: f64) -> Option<u32> {
    let whole = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    whole.then_some(number as u32)
}

/// The grid of finite rows; its columns saturate where the places are too far apart to count them.
fn grid_of(rows: &[TableRow]) -> Grid {
    let sorted = |place: fn(&TableRow) -> f32| {
        let mut places: Vec<f32> = rows.iter().map(place).collect();
        places.sort_by(f32::total_cmp);
        places.dedup_by(|a, b| *a - *b < SAME_CELL_M);
        places
    };
    let (across, along) = (sorted(|row| row.loc_x_m), sorted(|row| row.loc_y_m));
    let mut gaps: Vec<f32> = [&across, &along]
        .into_iter()
        .flat_map(|places| places.windows(2).map(|pair| pair[1] - pair[0]))
        .collect();
    gaps.sort_by(f32::total_cmp);
    let step_m = gaps
        .get(gaps.len() / 2)
        .copied()
        .unwrap_or(STEP_OF_ONE_SPOT_M);
    let origin = |places: &[f32]| places.first().copied().unwrap_or(0.0);
    let width_m = f64::from(across.last().copied().unwrap_or(0.0)) - f64::from(origin(&across));
    Grid {
        origin_loc_x_m: origin(&across),
        origin_loc_y_m: origin(&along),
        step_m,
        columns: ((width_m / f64::from(step_m)).round() as u32).saturating_add(1),
    }
}
