//! The rotational data frame from labelled images, and how well a forest turns it into headings.

mod car_row;
mod pictures;
mod rows;
mod score;

pub use car_row::{CALIBRATIONS, CarRow, car_rows};
pub use pictures::PictureSetError;
pub use rows::{RowFilter, RowSourceError, RowsFrom};
pub(crate) use score::Answer;
pub use score::{RotationReport, RotationReportError, RotationScore};
