//! The table's own file: little-endian, versioned, checksummed.
//!
//! ```text
//! 8 bytes   magic "RWTABLE\n"
//! u32       version, 1
//! u32       length of the header in bytes
//! u64       number of rows
//! header    camera, image width u32, height u32, calibration 32 bytes,
//!           number of classes u32, classes, length width height f64,
//!           the four numbers of the expected distance f64, made,
//!           grid: origin LocX f32, origin LocY f32, step f32, columns u32
//! rows      Area, Center_x, Center_y, Distance, LocX, LocY as f32, Loc as u32
//! 32 bytes  SHA-256 of everything before
//! ```
//! Texts are a u32 length and UTF-8.

use super::{
    CalibrationHash, ExpectedDistance, Grid, InvalidTable, LocationTable, SizeGroup, TableHeader,
    TableRow,
};
use roadwatch_core::{CameraName, ImageSize, ObjectClass, SizeLwh};
use sha2::{Digest, Sha256};
use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
};

const MAGIC: &[u8; 8] = b"RWTABLE\n";
const VERSION: u32 = 1;
const PRELUDE_BYTES: usize = 24;
const ROW_BYTES: usize = 28;
const CHECKSUM_BYTES: usize = 32;

/// What is wrong with a table's file.
#[derive(Debug, thiserror::Error)]
pub enum TableFormatError {
    /// The file system said no.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// It does not begin as a table does.
    #[error("not a table: `roadwatch table build` makes one, and a CSV must be imported first")]
    NotATable,
    /// A version this program does not know.
    #[error("a table of version {found}; this program reads versions up to {VERSION}")]
    Newer {
        /// The file's version.
        found: u32,
    },
    /// Bytes are missing at the end.
    #[error("truncated: {found} bytes of {expected}")]
    Truncated {
        /// Bytes the file should have.
        expected: u64,
        /// Bytes it has.
        found: u64,
    },
    /// The content is not what was written.
    #[error("damaged: {0}")]
    Damaged(&'static str),
    /// The content is intact and yet no table.
    #[error(transparent)]
    Invalid(#[from] InvalidTable),
}

/// A table's file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct TableFileError {
    /// Which file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub reason: TableFormatError,
}

impl LocationTable {
    /// Reads a table's file.
    ///
    /// # Errors
    /// Names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Self, TableFileError> {
        let read = fs::read(path).map_err(TableFormatError::from);
        read.and_then(|bytes| Self::from_bytes(&bytes))
            .map_err(|reason| TableFileError {
                path: path.to_owned(),
                reason,
            })
    }

    /// Writes the table's file: all of it or, on error, nothing.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn write(&self, path: &Path) -> Result<(), TableFileError> {
        write_atomically(path, &self.to_bytes()).map_err(|error| TableFileError {
            path: path.to_owned(),
            reason: error.into(),
        })
    }

    /// The bytes of the table's file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = header_bytes(&self.header);
        let mut bytes = Vec::with_capacity(
            PRELUDE_BYTES + header.len() + self.rows.len() * ROW_BYTES + CHECKSUM_BYTES,
        );
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend((self.rows.len() as u64).to_le_bytes());
        bytes.extend(header);
        for row in &self.rows {
            bytes.extend(row.numbers().into_iter().flat_map(f32::to_le_bytes));
            bytes.extend(row.loc.to_le_bytes());
        }
        let checksum = Sha256::digest(&bytes);
        bytes.extend(checksum);
        bytes
    }

    /// The table that a file's bytes hold.
    ///
    /// # Errors
    /// Says what is wrong with them.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TableFormatError> {
        let (header_bytes, row_bytes) = checked_parts(bytes)?;
        let header = read_header(&mut Cursor(header_bytes))
            .ok_or(TableFormatError::Damaged("the header does not parse"))?;
        let mut cursor = Cursor(row_bytes);
        let rows = std::iter::from_fn(|| read_row(&mut cursor)).collect();
        Ok(Self::new(header, rows)?)
    }
}

/// Header and rows of bytes that are whole and unchanged.
fn checked_parts(bytes: &[u8]) -> Result<(&[u8], &[u8]), TableFormatError> {
    if !bytes.starts_with(MAGIC) {
        return Err(TableFormatError::NotATable);
    }
    let prelude = read_prelude(bytes).ok_or(TableFormatError::Truncated {
        expected: (PRELUDE_BYTES + CHECKSUM_BYTES) as u64,
        found: bytes.len() as u64,
    })?;
    if prelude.version != VERSION {
        return Err(TableFormatError::Newer {
            found: prelude.version,
        });
    }
    let rows_at = PRELUDE_BYTES as u64 + u64::from(prelude.header_bytes);
    let content = prelude
        .rows
        .saturating_mul(ROW_BYTES as u64)
        .saturating_add(rows_at);
    let expected = content.saturating_add(CHECKSUM_BYTES as u64);
    if (bytes.len() as u64) < expected {
        return Err(TableFormatError::Truncated {
            expected,
            found: bytes.len() as u64,
        });
    }
    if bytes.len() as u64 > expected {
        return Err(TableFormatError::Damaged("bytes follow its end"));
    }
    let (content, checksum) = bytes.split_at(bytes.len() - CHECKSUM_BYTES);
    if Sha256::digest(content)[..] != *checksum {
        return Err(TableFormatError::Damaged("the checksum does not match"));
    }
    Ok(content[PRELUDE_BYTES..].split_at(prelude.header_bytes as usize))
}

struct Prelude {
    version: u32,
    header_bytes: u32,
    rows: u64,
}

fn read_prelude(bytes: &[u8]) -> Option<Prelude> {
    let mut cursor = Cursor(bytes.get(MAGIC.len()..)?);
    Some(Prelude {
        version: cursor.u32()?,
        header_bytes: cursor.u32()?,
        rows: cursor.take().map(u64::from_le_bytes)?,
    })
}

fn header_bytes(header: &TableHeader) -> Vec<u8> {
    let mut bytes = Vec::new();
    put_text(&mut bytes, header.camera.as_str());
    bytes.extend(header.image_size.width_px.to_le_bytes());
    bytes.extend(header.image_size.height_px.to_le_bytes());
    bytes.extend(header.calibration.0);
    bytes.extend((header.group.classes.len() as u32).to_le_bytes());
    for class in &header.group.classes {
        put_text(&mut bytes, class.as_str());
    }
    let SizeLwh {
        length_m,
        width_m,
        height_m,
    } = header.group.size;
    let size = [length_m, width_m, height_m];
    for number in size.iter().chain(&header.expected.numbers()) {
        bytes.extend(number.to_le_bytes());
    }
    put_text(&mut bytes, &header.made);
    let grid = &header.grid;
    for number in [grid.origin_loc_x_m, grid.origin_loc_y_m, grid.step_m] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(grid.columns.to_le_bytes());
    bytes
}

fn put_text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
}

/// `None` where the bytes end too early, go on too long, or a text is not one.
fn read_header(from: &mut Cursor<'_>) -> Option<TableHeader> {
    let header = TableHeader {
        camera: CameraName::new(from.text()?).ok()?,
        image_size: ImageSize {
            width_px: from.u32()?,
            height_px: from.u32()?,
        },
        calibration: CalibrationHash(from.take()?),
        group: read_group(from)?,
        expected: ExpectedDistance {
            height_m: from.f64()?,
            breadth_height_m: from.f64()?,
            outline_m: from.f64()?,
            breadth_m: from.f64()?,
        },
        made: from.text()?.to_owned(),
        grid: Grid {
            origin_loc_x_m: from.f32()?,
            origin_loc_y_m: from.f32()?,
            step_m: from.f32()?,
            columns: from.u32()?,
        },
    };
    from.0.is_empty().then_some(header)
}

fn read_group(from: &mut Cursor<'_>) -> Option<SizeGroup> {
    let classes = (0..from.u32()?)
        .map(|_| from.text().map(ObjectClass::new))
        .collect::<Option<_>>()?;
    Some(SizeGroup {
        classes,
        size: SizeLwh {
            length_m: from.f64()?,
            width_m: from.f64()?,
            height_m: from.f64()?,
        },
    })
}

fn read_row(from: &mut Cursor<'_>) -> Option<TableRow> {
    Some(TableRow {
        area_px2: from.f32()?,
        center_x_px: from.f32()?,
        center_y_px: from.f32()?,
        distance_m: from.f32()?,
        loc_x_m: from.f32()?,
        loc_y_m: from.f32()?,
        loc: from.u32()?,
    })
}

/// Bytes not read yet.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()? as usize;
        let (text, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        std::str::from_utf8(text).ok()
    }
}

/// Writes beside the target and renames, so that a reader sees the old file or the new one.
pub(super) fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(format!(".{}.part", std::process::id()));
    let written = write_synced(Path::new(&beside), bytes).and_then(|()| fs::rename(&beside, path));
    if written.is_err() {
        // The first error is the one that says what happened; a part that stays is harmless.
        fs::remove_file(&beside).ok();
    }
    written
}

fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = fs::File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}
