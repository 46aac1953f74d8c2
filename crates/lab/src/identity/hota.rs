//! HOTA: how well objects are found, and how well what is found belongs together, at every threshold of similarity.

use super::{Counts, Numbered, SLACK, assign};

const THRESHOLDS: usize = 19;

#[derive(Clone, Copy)]
pub(super) struct Hota {
    pub(super) hota: f64,
    pub(super) deta: f64,
    pub(super) assa: f64,
}

/// 0.05 to 0.95.
fn threshold(at: usize) -> f64 {
    0.05 * (at + 1) as f64
}

type Table = Vec<Vec<f64>>;

/// `None` where there is nothing at all.
pub(super) fn score(moments: &[Numbered<'_>], counts: &Counts) -> Option<Hota> {
    let all_truths: usize = counts.truths.iter().sum();
    let all_found: usize = counts.found.iter().sum();
    if all_truths + all_found == 0 {
        return None;
    }
    let alignment = alignment(moments, counts);
    let mut matches = vec![zeros(counts); THRESHOLDS];
    let mut matched = [0_usize; THRESHOLDS];
    for moment in moments {
        let (truths, found) = (&moment.truths, &moment.found);
        let score = |row: usize, column: usize| {
            alignment[truths[row]][found[column]] * moment.similarity[row][column]
        };
        for (row, column) in assign(truths.len(), found.len(), score) {
            let similarity = moment.similarity[row][column];
            for at in (0..THRESHOLDS).filter(|&at| similarity >= threshold(at) - SLACK) {
                matched[at] += 1;
                matches[at][truths[row]][found[column]] += 1.0;
            }
        }
    }
    let mut mean = Hota {
        hota: 0.0,
        deta: 0.0,
        assa: 0.0,
    };
    for (count, matches) in matched.into_iter().zip(&matches) {
        let deta = count as f64 / (all_truths + all_found - count).max(1) as f64;
        let assa = association(matches, counts) / count.max(1) as f64;
        mean.deta += deta / THRESHOLDS as f64;
        mean.assa += assa / THRESHOLDS as f64;
        mean.hota += (deta * assa).sqrt() / THRESHOLDS as f64;
    }
    Some(mean)
}

fn zeros(counts: &Counts) -> Table {
    vec![vec![0.0; counts.found.len()]; counts.truths.len()]
}

/// How much of their time a true and a found identity spend together: what decides who is matched in a moment.
fn alignment(moments: &[Numbered<'_>], counts: &Counts) -> Table {
    let mut together = zeros(counts);
    for moment in moments {
        let rows: Vec<f64> = moment
            .similarity
            .iter()
            .map(|row| row.iter().sum())
            .collect();
        for (row, &truth) in moment.truths.iter().enumerate() {
            for (column, &found) in moment.found.iter().enumerate() {
                let similarity = moment.similarity[row][column];
                let of_column: f64 = moment.similarity.iter().map(|row| row[column]).sum();
                let union = rows[row] + of_column - similarity;
                if union > SLACK {
                    together[truth][found] += similarity / union;
                }
            }
        }
    }
    for (truth, row) in together.iter_mut().enumerate() {
        for (found, value) in row.iter_mut().enumerate() {
            let either = (counts.truths[truth] + counts.found[found]) as f64 - *value;
            *value /= either;
        }
    }
    together
}

/// Over all matches, the share of the time of both identities that they are matched to each other.
fn association(matches: &Table, counts: &Counts) -> f64 {
    let mut sum = 0.0;
    for (truth, row) in matches.iter().enumerate() {
        for (found, &matched) in row.iter().enumerate() {
            let either = (counts.truths[truth] + counts.found[found]) as f64 - matched;
            sum += matched * matched / either.max(1.0);
        }
    }
    sum
}
