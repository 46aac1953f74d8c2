//! Matrices as numpy prints them, and what makes one a rotation.

use nalgebra::Matrix3;

/// How far a rotation's rows may be from unit length and right angles: what printing with three digits costs.
const ROTATION_TOLERANCE: f64 = 1e-3;
/// Columns of what stands before the first number of a file's matrix.
const INDENT: &str = "         ";

/// Rows of `columns` numbers in brackets, points below each other, zeros at the end left out.
pub(super) fn matrix(numbers: &[f64], columns: usize, decimals: usize) -> String {
    let split = numbers.iter().map(|number| {
        let text = format!("{number:.decimals$}");
        let text = text.trim_end_matches('0');
        let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
        (whole.to_owned(), fraction.to_owned())
    });
    let split: Vec<_> = split.collect();
    let before = split
        .iter()
        .map(|(whole, _)| whole.len())
        .max()
        .unwrap_or(0);
    let behind = split
        .iter()
        .map(|(_, fraction)| fraction.len())
        .max()
        .unwrap_or(0);
    let rows = split.chunks(columns).map(|row| {
        let row = row.iter();
        let row = row.map(|(whole, fraction)| format!("{whole:>before$}.{fraction:<behind$}"));
        row.collect::<Vec<_>>().join(", ")
    });
    let rows: Vec<_> = rows.collect();
    format!("[{}]", rows.join(&format!(",\n{INDENT}")))
}

/// Whether nine numbers, row by row, only turn.
pub(super) fn is_rotation(numbers: &[f64; 9]) -> bool {
    let turn = Matrix3::from_row_slice(numbers);
    let off = (turn * turn.transpose() - Matrix3::identity()).abs().max();
    off < ROTATION_TOLERANCE && turn.determinant() > 0.0
}
