//! A table in a file: the same rows as Parquet and as CSV, with the meaning of every column in the Parquet file itself.

use parquet::{
    basic::{LogicalType, Repetition, TimeUnit, Type as Physical},
    data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type},
    errors::ParquetError,
    file::{
        metadata::KeyValue,
        properties::WriterProperties,
        writer::{SerializedColumnWriter, SerializedFileWriter},
    },
    schema::types::Type,
};
use std::{
    fs::File,
    io::{self, BufWriter, Write as _},
    path::Path,
    sync::Arc,
};

/// Rows that are held back and written at once: small enough for memory, large enough to compress.
const ROWS_AT_ONCE: usize = 65_536;
/// Before the name of a column in the file's own metadata.
const ABOUT: &str = "roadwatch.column.";

/// What a column is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Its name, with its unit at the end where it has one.
    pub name: &'static str,
    /// What it holds, in a few words.
    pub about: &'static str,
    /// Of what kind its values are.
    pub kind: Kind,
}

/// Of what kind a column's values are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Nanoseconds since 1970, UTC.
    Time,
    /// A whole number.
    Integer,
    /// A number, or nothing.
    Real,
    /// Text.
    Text,
    /// True or false.
    Flag,
}

/// One value of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Of [`Kind::Time`].
    Time(i64),
    /// Of [`Kind::Integer`].
    Integer(i64),
    /// Of [`Kind::Real`].
    Real(Option<f64>),
    /// Of [`Kind::Text`].
    Text(String),
    /// Of [`Kind::Flag`].
    Flag(bool),
}

/// Why a table is not, or not wholly, written.
#[derive(Debug, thiserror::Error)]
pub enum DataFrameError {
    /// Of the Parquet file.
    #[error("the Parquet file cannot be written")]
    Parquet(#[from] ParquetError),
    /// Of the CSV file.
    #[error("the CSV file cannot be written")]
    Csv(#[from] io::Error),
}

/// Two files that take rows.
pub struct DataFrameFile {
    fields: &'static [Field],
    parquet: SerializedFileWriter<File>,
    csv: BufWriter<File>,
    waiting: Vec<Vec<Value>>,
    rows: usize,
}

impl DataFrameFile {
    /// Begins both files.
    ///
    /// # Errors
    /// When one cannot be made.
    pub fn create(
        parquet: &Path,
        csv: &Path,
        fields: &'static [Field],
    ) -> Result<Self, DataFrameError> {
        let about = fields
            .iter()
            .map(|field| KeyValue::new(format!("{ABOUT}{}", field.name), field.about.to_owned()));
        let properties = WriterProperties::builder()
            .set_key_value_metadata(Some(about.collect()))
            .set_created_by(concat!("roadwatch ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let columns = fields.iter().map(|field| Ok(Arc::new(column(field)?)));
        let columns = columns.collect::<Result<Vec<_>, ParquetError>>()?;
        let schema = Type::group_type_builder("roadwatch").with_fields(columns);
        let file = File::create(parquet).map_err(ParquetError::from)?;
        let parquet =
            SerializedFileWriter::new(file, Arc::new(schema.build()?), Arc::new(properties))?;
        let mut csv = BufWriter::new(File::create(csv)?);
        let names: Vec<&str> = fields.iter().map(|field| field.name).collect();
        writeln!(csv, "{}", names.join(","))?;
        Ok(Self {
            fields,
            parquet,
            csv,
            waiting: Vec::new(),
            rows: 0,
        })
    }

    /// Takes a row: a value for each field, of its kind.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn push(&mut self, row: Vec<Value>) -> Result<(), DataFrameError> {
        debug_assert_eq!(row.len(), self.fields.len());
        let cells: Vec<String> = row.iter().map(cell).collect();
        writeln!(self.csv, "{}", cells.join(","))?;
        self.waiting.push(row);
        self.rows += 1;
        if self.waiting.len() == ROWS_AT_ONCE {
            self.write_waiting()?;
        }
        Ok(())
    }

    /// Ends both files; gives the number of rows.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn finish(mut self) -> Result<usize, DataFrameError> {
        self.write_waiting()?;
        self.csv.flush()?;
        self.parquet.close()?;
        Ok(self.rows)
    }

    fn write_waiting(&mut self) -> Result<(), DataFrameError> {
        if self.waiting.is_empty() {
            return Ok(());
        }
        let mut group = self.parquet.next_row_group()?;
        for (at, field) in self.fields.iter().enumerate() {
            let Some(mut column) = group.next_column()? else {
                unreachable!("as many columns as fields");
            };
            let values = self.waiting.iter().map(|row| &row[at]);
            write_column(&mut column, field.kind, values)?;
            column.close()?;
        }
        group.close()?;
        self.waiting.clear();
        Ok(())
    }
}

fn column(field: &Field) -> Result<Type, ParquetError> {
    let (physical, logical) = match field.kind {
        Kind::Time => {
            let utc = LogicalType::timestamp(true, TimeUnit::NANOS);
            (Physical::INT64, Some(utc))
        }
        Kind::Integer => (Physical::INT64, None),
        Kind::Real => (Physical::DOUBLE, None),
        Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        Kind::Flag => (Physical::BOOLEAN, None),
    };
    let repetition = match field.kind {
        Kind::Real => Repetition::OPTIONAL,
        _ => Repetition::REQUIRED,
    };
    Type::primitive_type_builder(field.name, physical)
        .with_logical_type(logical)
        .with_repetition(repetition)
        .build()
}

fn write_column<'v>(
    column: &mut SerializedColumnWriter<'_>,
    kind: Kind,
    values: impl Iterator<Item = &'v Value>,
) -> Result<(), ParquetError> {
    match kind {
        Kind::Time | Kind::Integer => {
            let whole: Vec<i64> = values.filter_map(Value::whole).collect();
            column
                .typed::<Int64Type>()
                .write_batch(&whole, None, None)?;
        }
        Kind::Real => {
            let all: Vec<Option<f64>> = values.map(Value::real).collect();
            let known: Vec<f64> = all.iter().flatten().copied().collect();
            let levels: Vec<i16> = all.iter().map(|one| i16::from(one.is_some())).collect();
            let column = column.typed::<DoubleType>();
            column.write_batch(&known, Some(&levels), None)?;
        }
        Kind::Text => {
            let texts: Vec<ByteArray> = values
                .filter_map(Value::text)
                .map(ByteArray::from)
                .collect();
            let column = column.typed::<ByteArrayType>();
            column.write_batch(&texts, None, None)?;
        }
        Kind::Flag => {
            let flags: Vec<bool> = values.map(|value| *value == Value::Flag(true)).collect();
            column.typed::<BoolType>().write_batch(&flags, None, None)?;
        }
    }
    Ok(())
}

impl Value {
    fn whole(&self) -> Option<i64> {
        match self {
            Self::Time(whole) | Self::Integer(whole) => Some(*whole),
            _ => None,
        }
    }

    fn real(&self) -> Option<f64> {
        match self {
            Self::Real(real) => *real,
            _ => None,
        }
    }

    fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// As CSV has it: nothing for what is not known; names hold neither commas nor quotes, but a text may.
fn cell(value: &Value) -> String {
    match value {
        Value::Time(whole) | Value::Integer(whole) => whole.to_string(),
        Value::Real(real) => real.map_or_else(String::new, |real| real.to_string()),
        Value::Flag(flag) => flag.to_string(),
        Value::Text(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::Text(text) => text.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::{
        file::reader::{FileReader as _, SerializedFileReader},
        record::RowAccessor as _,
    };

    const FIELDS: [Field; 5] = [
        Field {
            name: "stamp",
            about: "when",
            kind: Kind::Time,
        },
        Field {
            name: "track_id",
            about: "who",
            kind: Kind::Integer,
        },
        Field {
            name: "x_m",
            about: "where, metres",
            kind: Kind::Real,
        },
        Field {
            name: "class",
            about: "what",
            kind: Kind::Text,
        },
        Field {
            name: "held",
            about: "kept",
            kind: Kind::Flag,
        },
    ];

    fn row(number: i64) -> Vec<Value> {
        vec![
            Value::Time(1_557_539_956_450_180_000 + number),
            Value::Integer(number),
            Value::Real((number % 2 == 0).then_some(number as f64 / 3.0)),
            Value::Text(format!("a \"{number}\", b")),
            Value::Flag(number % 3 == 0),
        ]
    }

    #[test]
    fn both_files_hold_every_row_over_the_border_of_a_group_too() {
        let folder = tempfile::tempdir().expect("a folder");
        let (parquet, csv) = (folder.path().join("t.parquet"), folder.path().join("t.csv"));
        let rows = ROWS_AT_ONCE + 3;
        let mut file = DataFrameFile::create(&parquet, &csv, &FIELDS).expect("made");
        for number in 0..rows {
            file.push(row(number as i64)).expect("taken");
        }
        assert_eq!(file.finish().expect("written"), rows);

        let reader =
            SerializedFileReader::new(File::open(&parquet).expect("there")).expect("Parquet");
        assert_eq!(reader.num_row_groups(), 2);
        let about = reader.metadata().file_metadata().key_value_metadata();
        let x = about
            .into_iter()
            .flatten()
            .find(|one| one.key.ends_with(".x_m"));
        assert_eq!(
            x.and_then(|one| one.value.as_deref()),
            Some("where, metres")
        );
        let mut count = 0;
        for (number, found) in reader.get_row_iter(None).expect("rows").enumerate() {
            let found = found.expect("a row");
            assert_eq!(found.get_long(1).expect("whole"), number as i64);
            let x = found.get_double(2).ok();
            assert_eq!(x, (number % 2 == 0).then_some(number as f64 / 3.0));
            assert_eq!(found.get_bool(4).expect("flag"), number % 3 == 0);
            count += 1;
        }
        assert_eq!(count, rows);

        let text = std::fs::read_to_string(&csv).expect("there");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), rows + 1);
        assert_eq!(lines[0], "stamp,track_id,x_m,class,held");
        assert_eq!(lines[2], "1557539956450180001,1,,\"a \"\"1\"\", b\",false");
    }
}
