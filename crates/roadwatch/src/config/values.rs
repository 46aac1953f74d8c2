//! From TOML values to numbers, and from slips of the pen to the keys that were meant.

use toml::de::DeValue;

/// A key is called a likely slip of another when this many edits or fewer lie between them.
const SLIP_EDITS: usize = 3;

pub(super) fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(_) => as_integer(value).map(|integer| integer as f64),
        _ => None,
    }
}

pub(super) fn as_integer(value: &DeValue<'_>) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// Finite numbers: no list in a configuration has a place for others.
pub(super) fn as_numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    let numbers = value.as_array()?.iter();
    let numbers = numbers.map(|number| as_number(number.get_ref()));
    numbers
        .map(|number| number.filter(|number| number.is_finite()))
        .collect()
}

pub(super) fn nearest<'k>(name: &str, known: impl Iterator<Item = &'k String>) -> Option<&'k str> {
    let by_distance = known.map(|key| (edits(name, key), key.as_str()));
    let (distance, key) = by_distance.min()?;
    (distance <= SLIP_EDITS.min(name.len() / 2)).then_some(key)
}

/// Levenshtein's distance.
pub(super) fn edits(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.bytes().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
