//! Tables of numbers that people write: a header, then a row per line; mistakes are named with their line.

use csv::{ReaderBuilder, StringRecord, Trim};
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// A file of numbers that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum RowError {
    /// The file is not there or not readable.
    #[error("cannot read `{}`", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// Something in a line.
    #[error("{}:{line}: {what}", file.display())]
    Line {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong and what is expected.
        what: String,
    },
}

/// Which columns a file has.
pub(crate) struct Columns {
    pub(crate) required: &'static [&'static str],
    pub(crate) optional: &'static [&'static str],
}

/// One line: its number, and a number per column, the required ones first; `None` for an optional column
/// that the file has not.
pub(crate) struct Row {
    pub(crate) line: u64,
    pub(crate) numbers: Vec<Option<f64>>,
}

/// Reads all rows. Lines that begin with `#` are remarks.
pub(crate) fn read(file: &Path, columns: &Columns) -> Result<Vec<Row>, RowError> {
    let reader = ReaderBuilder::new()
        .flexible(true)
        .comment(Some(b'#'))
        .trim(Trim::All)
        .from_path(file);
    let mut reader = reader.map_err(|error| unreadable(file, error.into()))?;
    let text = fs::read_to_string(file).map_err(|error| unreadable(file, error))?;
    let numbered = numbered(&text).into_iter().skip(1);
    let header = reader
        .headers()
        .map_err(|error| unreadable(file, error.into()))?;
    let places = places(file, header, columns)?;
    let width = header.len();
    let rows = reader.into_records().zip(numbered).map(|(record, line)| {
        let record = record.map_err(|error| unreadable(file, error.into()))?;
        row((file, line), &record, (&places, width))
    });
    rows.collect()
}

/// Numbers of the lines that are rows: the reader counts those it leaves out to the row behind them.
fn numbered(text: &str) -> Vec<u64> {
    let lines = (1..).zip(text.lines());
    let rows = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    rows.map(|(number, _)| number).collect()
}

/// A column's name and its place in the file; `None` for an optional column that is not there.
type Places = Vec<(&'static str, Option<usize>)>;

fn places(file: &Path, header: &StringRecord, columns: &Columns) -> Result<Places, RowError> {
    let all = columns.required.iter().chain(columns.optional);
    let wrong = |what| RowError::Line {
        file: file.to_owned(),
        line: 1,
        what,
    };
    let expected = || {
        let optional: Vec<_> = columns.optional.iter().map(|c| format!("[,{c}]")).collect();
        format!("{}{}", columns.required.join(","), optional.concat())
    };
    if let Some(unknown) = header.iter().find(|name| !all.clone().any(|c| c == name)) {
        let what = format!(
            "`{unknown}` is no column of this file; expected {}",
            expected()
        );
        return Err(wrong(what));
    }
    let place = |name: &str| header.iter().position(|found| found == name);
    if let Some(missing) = columns.required.iter().find(|name| place(name).is_none()) {
        let what = format!("column `{missing}` is missing; expected {}", expected());
        return Err(wrong(what));
    }
    Ok(all.map(|&name| (name, place(name))).collect())
}

fn row(
    (file, line): (&Path, u64),
    record: &StringRecord,
    (places, width): (&Places, usize),
) -> Result<Row, RowError> {
    let wrong = |what| RowError::Line {
        file: file.to_owned(),
        line,
        what,
    };
    if record.len() != width {
        let what = format!("{} values where the header names {width}", record.len());
        return Err(wrong(what));
    }
    let number = |&(name, place): &(&str, Option<usize>)| {
        let Some(text) = place.and_then(|place| record.get(place)) else {
            return Ok(None);
        };
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number
            .map(Some)
            .ok_or_else(|| wrong(format!("`{text}` in column {name} is not a number")))
    };
    let numbers = places.iter().map(number).collect::<Result<_, _>>()?;
    Ok(Row { line, numbers })
}

fn unreadable(file: &Path, cause: io::Error) -> RowError {
    RowError::Unreadable {
        file: file.to_owned(),
        cause,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: Columns = Columns {
        required: &["u", "v", "x", "y"],
        optional: &["z"],
    };

    fn complaint(text: &str) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("points.csv");
        std::fs::write(&file, text).expect("written");
        let refused = read(&file, &COLUMNS).err().expect(text).to_string();
        refused.replace(&format!("{}/", folder.path().display()), "")
    }

    #[test]
    fn each_mistake_is_said_with_its_line() {
        for (text, expected) in [
            (
                "u,v,x\n1,2,3\n",
                "points.csv:1: column `y` is missing; expected u,v,x,y[,z]",
            ),
            (
                "u,v,x,y,w\n",
                "points.csv:1: `w` is no column of this file; expected u,v,x,y[,z]",
            ),
            (
                "u,v,x,y\n1,2,3,4\n\n# a remark\n1,2,3\n",
                "points.csv:5: 3 values where the header names 4",
            ),
            (
                "u,v,x,y\n1,two,3,4\n",
                "points.csv:2: `two` in column v is not a number",
            ),
            (
                "u,v,x,y\n1,nan,3,4\n",
                "points.csv:2: `nan` in column v is not a number",
            ),
        ] {
            assert_eq!(complaint(text), expected);
        }
    }
}
