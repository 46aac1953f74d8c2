//! Who belongs to whom, solved exactly.

use pathfinding::{kuhn_munkres::kuhn_munkres, matrix::Matrix};

/// Gains are compared in whole numbers of this size.
const UNIT: f64 = 1e-6;

/// A row and a column that may belong together, and what that gains over leaving both alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) row: usize,
    pub(crate) column: usize,
    /// Greater than zero.
    pub(crate) gain: f64,
}

/// The column of each row, at most one row to a column, so that the sum of gains is greatest (Hungarian method). Rows
/// that gain nothing stay alone.
///
/// Rows and columns that no chain of pairs connects do not bear on each other, so each connected part is solved by
/// itself: a crowd costs as much as its densest part.
pub(crate) fn assign(rows: usize, columns: usize, pairs: &[Pair]) -> Vec<Option<usize>> {
    let mut taken = vec![None; rows];
    for part in parts(rows, columns, pairs) {
        solve(&part, &mut taken);
    }
    taken
}

/// The pairs of each connected part.
fn parts(rows: usize, columns: usize, pairs: &[Pair]) -> Vec<Vec<Pair>> {
    // Rows first, then columns; each points towards the least of its part.
    let mut leads: Vec<usize> = (0..rows + columns).collect();
    for pair in pairs {
        let (a, b) = (
            lead(&mut leads, pair.row),
            lead(&mut leads, rows + pair.column),
        );
        leads[a.max(b)] = a.min(b);
    }
    let mut parts: Vec<Vec<Pair>> = vec![Vec::new(); rows];
    for pair in pairs.iter().filter(|pair| pair.gain > 0.0) {
        parts[lead(&mut leads, pair.row)].push(*pair);
    }
    parts.retain(|part| !part.is_empty());
    parts
}

fn lead(leads: &mut [usize], of: usize) -> usize {
    let mut at = of;
    while leads[at] != at {
        leads[at] = leads[leads[at]];
        at = leads[at];
    }
    at
}

fn solve(part: &[Pair], taken: &mut [Option<usize>]) {
    if let [only] = part {
        taken[only.row] = Some(only.column);
        return;
    }
    let (rows, columns) = (
        sorted(part, |pair| pair.row),
        sorted(part, |pair| pair.column),
    );
    // A column for each row at least: who takes one that gains nothing stays alone.
    let mut weights = Matrix::new(rows.len(), columns.len().max(rows.len()), 0_i64);
    let place = |list: &[usize], one| list.partition_point(|&other| other < one);
    for pair in part {
        let at = (place(&rows, pair.row), place(&columns, pair.column));
        weights[at] = (pair.gain / UNIT).round() as i64;
    }
    let (_, chosen) = kuhn_munkres(&weights);
    for (row, column) in chosen.into_iter().enumerate() {
        if weights[(row, column)] > 0 {
            taken[rows[row]] = Some(columns[column]);
        }
    }
}

fn sorted(part: &[Pair], of: impl Fn(&Pair) -> usize) -> Vec<usize> {
    let mut all: Vec<usize> = part.iter().map(of).collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pair(row: usize, column: usize, gain: f64) -> Pair {
        Pair { row, column, gain }
    }

    #[test]
    fn the_greatest_sum_counts_and_not_the_greatest_gain() {
        let pairs = [pair(0, 0, 3.0), pair(0, 1, 2.5), pair(1, 0, 2.0)];
        assert_eq!(assign(3, 2, &pairs), [Some(1), Some(0), None]);
    }

    /// The best sum by trying every choice of every row.
    fn best_by_trial(rows: usize, used: &mut Vec<usize>, row: usize, pairs: &[Pair]) -> f64 {
        if row == rows {
            return 0.0;
        }
        let mut best = best_by_trial(rows, used, row + 1, pairs);
        for pair in pairs.iter().filter(|pair| pair.row == row) {
            if !used.contains(&pair.column) {
                used.push(pair.column);
                best = best.max(pair.gain + best_by_trial(rows, used, row + 1, pairs));
                used.pop();
            }
        }
        best
    }

    proptest! {
        #[test]
        fn nothing_gains_more(gains in prop::collection::vec(prop::option::of(0.1..9.0_f64), 20)) {
            let pairs: Vec<Pair> = gains.iter().enumerate()
                .filter_map(|(at, gain)| Some(pair(at / 4, at % 4, (*gain)?)))
                .collect();
            let taken = assign(5, 4, &pairs);
            let mut columns: Vec<usize> = taken.iter().flatten().copied().collect();
            let sum: f64 = taken.iter().enumerate()
                .filter_map(|(row, column)| {
                    let column = (*column)?;
                    pairs.iter().find(|pair| (pair.row, pair.column) == (row, column))
                })
                .map(|pair| pair.gain)
                .sum();
            let count = columns.len();
            columns.sort_unstable();
            columns.dedup();
            prop_assert_eq!(count, columns.len());
            prop_assert!((sum - best_by_trial(5, &mut Vec::new(), 0, &pairs)).abs() < 1e-4);
        }
    }
}
