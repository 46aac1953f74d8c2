//! Identity F1: one found identity for each true one, over all moments.

use super::{Counts, MIN_SIMILARITY, Numbered, SLACK, assign};

pub(super) fn idf1(moments: &[Numbered<'_>], counts: &Counts) -> Option<f64> {
    let mut together = vec![vec![0_u32; counts.found.len()]; counts.truths.len()];
    for moment in moments {
        for (row, &truth) in moment.truths.iter().enumerate() {
            for (column, &found) in moment.found.iter().enumerate() {
                let similar = moment.similarity[row][column] >= MIN_SIMILARITY - SLACK;
                together[truth][found] += u32::from(similar);
            }
        }
    }
    let score = |row: usize, column: usize| f64::from(together[row][column]);
    let pairs = assign(counts.truths.len(), counts.found.len(), score);
    let right: f64 = pairs
        .into_iter()
        .map(|(row, column)| score(row, column))
        .sum();
    let all = counts.truths.iter().sum::<usize>() + counts.found.iter().sum::<usize>();
    (all > 0).then(|| 2.0 * right / all as f64)
}
