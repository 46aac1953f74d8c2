//! Who is who: how well identities hold through time, by the three measures in use.
//!
//! CLEAR MOT (Bernardin & Stiefelhagen 2008), identity F1 (Ristani et al. 2016) and HOTA (Luiten et al. 2021), as the
//! reference implementation of the last, `trackeval`, computes them; a test compares both on the same input.

mod clear;
mod global;
mod hota;
mod published;
mod sighting;

use serde::Serialize;
use std::collections::BTreeMap;

pub(crate) use published::Judge;
pub use published::PublishedScene;
pub use sighting::{IdentityReport, MIN_TIMES_FOUND, SeenTrack, SeenTruth, Sighting};

/// Below this similarity a found object is not taken for a true one, by CLEAR MOT and identity F1.
const MIN_SIMILARITY: f64 = 0.5;
/// Similarities are compared with this slack, as the arithmetic needs it.
const SLACK: f64 = f64::EPSILON;

/// What is there, and what was found, at one moment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moment {
    /// True objects, each once.
    pub truths: Vec<u64>,
    /// Found ones, each once.
    pub found: Vec<u64>,
    /// How alike each true object, by its place in `truths`, and each found one are: 0 to 1, row by row.
    pub similarity: Vec<Vec<f64>>,
}

/// Figures of identities; every share `None` where there is nothing to count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct IdentityScore {
    /// True objects, one for each moment they were there.
    pub object_frames: usize,
    /// F1 of identities: two times the true positives among all true and found objects, under the best one-to-one
    /// assignment of true to found identities.
    pub idf1: Option<f64>,
    /// Higher order tracking accuracy, mean over thresholds 0.05 to 0.95.
    pub hota: Option<f64>,
    /// Its part of detection.
    pub deta: Option<f64>,
    /// Its part of association.
    pub assa: Option<f64>,
    /// Accuracy of CLEAR MOT: 1 less false alarms, misses and switches per true object. May be negative.
    pub mota: Option<f64>,
    /// Times a true object was found under another identity than before.
    pub switches: usize,
    /// Times a true object was found again after it had not been.
    pub fragmentations: usize,
}

impl IdentityScore {
    /// Scores moments in their order.
    #[must_use]
    pub fn of(moments: &[Moment]) -> Self {
        let (truths, found) = (
            Numbers::of(moments, |m| &m.truths),
            Numbers::of(moments, |m| &m.found),
        );
        let counts = Counts {
            truths: truths.counts(moments, |m| &m.truths),
            found: found.counts(moments, |m| &m.found),
        };
        let numbered: Vec<Numbered<'_>> = moments
            .iter()
            .map(|moment| Numbered {
                truths: truths.of_all(&moment.truths),
                found: found.of_all(&moment.found),
                similarity: &moment.similarity,
            })
            .collect();
        let clear = clear::score(&numbered, counts.truths.len());
        let hota = hota::score(&numbered, &counts);
        Self {
            object_frames: counts.truths.iter().sum(),
            idf1: global::idf1(&numbered, &counts),
            hota: hota.map(|h| h.hota),
            deta: hota.map(|h| h.deta),
            assa: hota.map(|h| h.assa),
            mota: clear.mota,
            switches: clear.switches,
            fragmentations: clear.fragmentations,
        }
    }
}

/// Numbers from 0 for identities.
struct Numbers(BTreeMap<u64, usize>);

impl Numbers {
    fn of(moments: &[Moment], ids: impl Fn(&Moment) -> &Vec<u64>) -> Self {
        let mut numbers = BTreeMap::new();
        for id in moments.iter().flat_map(ids) {
            let next = numbers.len();
            numbers.entry(*id).or_insert(next);
        }
        Self(numbers)
    }

    fn of_all(&self, ids: &[u64]) -> Vec<usize> {
        ids.iter()
            .filter_map(|id| self.0.get(id).copied())
            .collect()
    }

    /// In how many moments each is there.
    fn counts(&self, moments: &[Moment], ids: impl Fn(&Moment) -> &Vec<u64>) -> Vec<usize> {
        let mut counts = vec![0; self.0.len()];
        for id in moments.iter().flat_map(ids) {
            counts[self.0[id]] += 1;
        }
        counts
    }
}

/// In how many moments each identity is there.
struct Counts {
    truths: Vec<usize>,
    found: Vec<usize>,
}

/// A moment whose identities are numbered.
struct Numbered<'a> {
    truths: Vec<usize>,
    found: Vec<usize>,
    similarity: &'a [Vec<f64>],
}

/// Pairs of rows and columns, each at most once, with the greatest sum of scores; pairs that score nothing are left out.
/// Solved exactly (Kuhn and Munkres).
fn assign(rows: usize, columns: usize, score: impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    /// Scores are compared in whole numbers of this size.
    const UNIT: f64 = 1e-12;
    if rows == 0 || columns == 0 {
        return Vec::new();
    }
    // The solver wants no more rows than columns.
    let turned = rows > columns;
    let (height, width) = if turned {
        (columns, rows)
    } else {
        (rows, columns)
    };
    let value = |row: usize, column: usize| {
        if turned {
            score(column, row)
        } else {
            score(row, column)
        }
    };
    let weights = pathfinding::matrix::Matrix::from_fn(height, width, |(row, column)| {
        (value(row, column) / UNIT).round() as i128
    });
    let (_, columns_of_rows) = pathfinding::kuhn_munkres::kuhn_munkres(&weights);
    let pairs = columns_of_rows.into_iter().enumerate();
    pairs
        .filter(|&(row, column)| weights[(row, column)] > 0)
        .map(|(row, column)| if turned { (column, row) } else { (row, column) })
        .collect()
}

#[cfg(test)]
mod tests;
