//! The look-up table of docs/method.md, section 3: what boxes look like at known places.

mod build;
mod calibration;
mod csv_file;
mod distance_fit;
mod expected;
mod file;

mod index;
mod labelled;
mod query;
mod tree;

pub use build::{GridSpec, InvalidGrid, TableBuildError, build_table};
pub use calibration::CalibrationHash;
pub use csv_file::{CsvError, CsvOrigin};
pub use expected::ExpectedDistance;
pub use file::{TableFileError, TableFormatError};

pub use index::{Neighbour, Split, TableIndex};
pub use labelled::{LabelledBox, LabelledOrigin};
pub use query::{DEFAULT_PX_PER_METRE, DEFAULT_WEIGHT_WIDTH_PX, TableQuery, Weight};

use crate::sizes::ClassSizes;
use roadwatch_core::{BoxPx, CameraName, ImageSize, ObjectClass, RigCamera, SizeLwh};

/// Sizes that differ by less are the same, metres: nobody knows the size of a class better.
const SAME_SIZE_M: f64 = 0.01;

/// The columns of the paper's table, in its order.
pub const COLUMNS: [&str; 7] = [
    "Area", "Center_x", "Center_y", "Distance", "LocX", "LocY", "Loc",
];

/// One row: a box and where the object stood.
///
/// The box's middle is a pixel position, whose zero is the centre of the first pixel ([`BoxPx::center`]).
/// A box measured by its edges, as detectors give them, has its middle half a pixel to the left of and
/// above the mean of its edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableRow {
    /// `Area`: of the box, square pixels. Stored, not scored.
    pub area_px2: f32,
    /// `Center_x`: column of the box's middle, a pixel position.
    pub center_x_px: f32,
    /// `Center_y`: row of the box's middle, a pixel position.
    pub center_y_px: f32,
    /// `Distance`: component along the optical axis to the object's centre (`depth_m`), metres.
    pub distance_m: f32,
    /// `LocX`: to the right of the optical axis on the ground, metres.
    pub loc_x_m: f32,
    /// `LocY`: along the horizontal projection of the optical axis, metres.
    pub loc_y_m: f32,
    /// `Loc`: index of the grid cell, see [`Grid`].
    pub loc: u32,
}

impl TableRow {
    fn numbers(&self) -> [f32; 6] {
        [
            self.area_px2,
            self.center_x_px,
            self.center_y_px,
            self.distance_m,
            self.loc_x_m,
            self.loc_y_m,
        ]
    }
}

/// The objects one table speaks of.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeGroup {
    /// The classes it locates.
    pub classes: Vec<ObjectClass>,
    /// The size its silhouettes were cast with.
    pub size: SizeLwh,
}

/// The ground grid behind the rows' `Loc`: `loc = row * columns + column`, columns along LocX from
/// `origin_loc_x_m`, rows along LocY from `origin_loc_y_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// LocX of column 0, metres.
    pub origin_loc_x_m: f32,
    /// LocY of row 0, metres.
    pub origin_loc_y_m: f32,
    /// Between neighbouring cells, metres.
    pub step_m: f32,
    /// Cells along LocX.
    pub columns: u32,
}

impl Grid {
    /// As many as a [`GridSpec`] may have rows.
    const MAX_COLUMNS: u32 = 10_000_000;
    /// A cell so large says nothing about an object on a road, metres.
    const MAX_STEP_M: f32 = 1_000.0;

    fn check(&self) -> Result<(), InvalidTable> {
        if !(self.step_m > 0.0 && self.step_m <= Self::MAX_STEP_M) {
            return Err(InvalidTable::Grid(
                "its step must be more than 0 and at most 1000 m",
            ));
        }
        if !(1..=Self::MAX_COLUMNS).contains(&self.columns) {
            return Err(InvalidTable::Grid(
                "1 to 10000000 columns a step apart are possible",
            ));
        }
        if !(self.origin_loc_x_m.is_finite() && self.origin_loc_y_m.is_finite()) {
            return Err(InvalidTable::Grid("its origin must be finite"));
        }
        Ok(())
    }
}

/// What a table is of.
#[derive(Clone, Debug, PartialEq)]
pub struct TableHeader {
    /// The camera's name, for people; [`TableHeader::calibration`] is what is checked.
    pub camera: CameraName,
    /// The image the boxes are measured in.
    pub image_size: ImageSize,
    /// Fingerprint of the camera the table belongs to.
    pub calibration: CalibrationHash,
    /// Whom it locates.
    pub group: SizeGroup,
    /// How to ask it.
    pub expected: ExpectedDistance,
    /// How it was made, for people.
    pub made: String,
    /// The cells.
    pub grid: Grid,
}

/// Rows that are no table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidTable {
    /// No row at all.
    #[error("the table is empty: it has a header but no row")]
    Empty,
    /// More rows than a row index can count.
    #[error("the table has {0} rows; at most 4294967294 are supported")]
    TooManyRows(usize),
    /// A number that is NaN or infinite.
    #[error("row {row}, column {column}: not a finite number")]
    NotFinite {
        /// Counted from 1, without the header.
        row: usize,
        /// One of [`COLUMNS`].
        column: &'static str,
    },
    /// A header that no table can have.
    #[error("the header's {0} is impossible")]
    Header(&'static str),
    /// Places on no grid that a table can have.
    #[error("the grid of places is impossible: {0}")]
    Grid(&'static str),
}

/// The table was made for another camera, or its calibration changed since.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the table was made for camera `{made_for}` (calibration {made_for_hash}), not for `{used_for}` \
     (calibration {used_for_hash}): intrinsics, distortion, mount, image size and ground height must be the same"
)]
pub struct OtherCamera {
    /// Whose table it is.
    pub made_for: CameraName,
    /// Its calibration.
    pub made_for_hash: CalibrationHash,
    /// Who wants to use it.
    pub used_for: CameraName,
    /// Its calibration.
    pub used_for_hash: CalibrationHash,
}

/// The table was made for objects of another size than is configured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the table was made for objects of {}, but class `{class}` is configured as {}: rebuild the table for \
     that size, or leave `table` out and it is built at start",
    lwh(made_for),
    lwh(configured)
)]
pub struct OtherSize {
    /// Whose size differs.
    pub class: ObjectClass,
    /// The table's.
    pub made_for: SizeLwh,
    /// The configuration's.
    pub configured: SizeLwh,
}

/// As people write sizes.
fn lwh(size: &SizeLwh) -> String {
    let [length_m, width_m, height_m] = dimensions_m(*size);
    format!("{length_m:.2} x {width_m:.2} x {height_m:.2} m")
}

fn dimensions_m(size: SizeLwh) -> [f64; 3] {
    [size.length_m, size.width_m, size.height_m]
}

/// A look-up table: at least one row, every number finite.
#[derive(Clone, Debug, PartialEq)]
pub struct LocationTable {
    header: TableHeader,
    rows: Vec<TableRow>,
}

impl LocationTable {
    /// A table from its parts.
    ///
    /// # Errors
    /// When there is no row, too many, or a number is not finite.
    pub fn new(header: TableHeader, rows: Vec<TableRow>) -> Result<Self, InvalidTable> {
        check_header(&header)?;
        if rows.is_empty() {
            return Err(InvalidTable::Empty);
        }
        if rows.len() >= u32::MAX as usize {
            return Err(InvalidTable::TooManyRows(rows.len()));
        }
        check_finite(&rows)?;
        Ok(Self { header, rows })
    }

    /// What the table is of.
    #[must_use]
    pub fn header(&self) -> &TableHeader {
        &self.header
    }

    /// The rows, in the order that breaks ties.
    #[must_use]
    pub fn rows(&self) -> &[TableRow] {
        &self.rows
    }

    /// True when the table speaks of this class.
    #[must_use]
    pub fn covers(&self, class: &ObjectClass) -> bool {
        self.header.group.classes.contains(class)
    }

    /// Checks that the table belongs to a camera as it is mounted now.
    ///
    /// # Errors
    /// When the calibration hashes differ.
    pub fn check_camera(&self, camera: &RigCamera, ground_z_m: f64) -> Result<(), OtherCamera> {
        let used_for_hash = CalibrationHash::of(camera, ground_z_m);
        if used_for_hash == self.header.calibration {
            return Ok(());
        }
        Err(OtherCamera {
            made_for: self.header.camera.clone(),
            made_for_hash: self.header.calibration,
            used_for: camera.name.clone(),
            used_for_hash,
        })
    }

    /// Checks that the table's classes are configured as large as its objects, to a centimetre in each
    /// dimension. Classes without a configured size are never located, so they do not count.
    ///
    /// # Errors
    /// Names the first class that differs.
    pub fn check_sizes(&self, sizes: &ClassSizes) -> Result<(), OtherSize> {
        let made_for = self.header.group.size;
        for class in &self.header.group.classes {
            let configured = sizes.get(class).map_or(made_for, |known| known.size);
            let mut pairs = dimensions_m(made_for)
                .into_iter()
                .zip(dimensions_m(configured));
            if pairs.any(|(made_m, configured_m)| (made_m - configured_m).abs() > SAME_SIZE_M) {
                return Err(OtherSize {
                    class: class.clone(),
                    made_for,
                    configured,
                });
            }
        }
        Ok(())
    }
}

fn check_finite(rows: &[TableRow]) -> Result<(), InvalidTable> {
    for (at, row) in rows.iter().enumerate() {
        if let Some(column) = row.numbers().iter().position(|number| !number.is_finite()) {
            return Err(InvalidTable::NotFinite {
                row: at + 1,
                column: COLUMNS[column],
            });
        }
    }
    Ok(())
}

fn check_header(header: &TableHeader) -> Result<(), InvalidTable> {
    let size = header.group.size;
    let positive = [
        ("length", size.length_m),
        ("width", size.width_m),
        ("height", size.height_m),
        ("effective height", header.expected.height_m),
        ("image width", f64::from(header.image_size.width_px)),
        ("image height", f64::from(header.image_size.height_px)),
    ];
    let wrong = positive
        .into_iter()
        .find(|(_, value)| !(value.is_finite() && *value > 0.0));
    if !header
        .expected
        .numbers()
        .iter()
        .all(|number| number.is_finite())
    {
        return Err(InvalidTable::Header("expected distance"));
    }
    header.grid.check()?;
    wrong.map_or(Ok(()), |(name, _)| Err(InvalidTable::Header(name)))
}

fn row_of(box_px: &BoxPx, distance_m: f64, loc: (f64, f64), cell: u32) -> TableRow {
    let center = box_px.center();
    TableRow {
        area_px2: box_px.area_px2(),
        center_x_px: center.x as f32,
        center_y_px: center.y as f32,
        distance_m: distance_m as f32,
        loc_x_m: loc.0 as f32,
        loc_y_m: loc.1 as f32,
        loc: cell,
    }
}
