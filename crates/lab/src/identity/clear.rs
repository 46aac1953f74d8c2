//! CLEAR MOT: matches moment by moment, those of the moment before first.

use super::{MIN_SIMILARITY, Numbered, SLACK, assign};

/// More than any similarity, so that a pair that was one before stays one.
const KEPT: f64 = 1000.0;

pub(super) struct Clear {
    pub(super) mota: Option<f64>,
    pub(super) switches: usize,
    pub(super) fragmentations: usize,
}

/// What is known of each true object.
struct Memory {
    /// Whom it was found as last.
    last: Vec<Option<usize>>,
    /// Whom it was found as in the moment before.
    now: Vec<Option<usize>>,
    /// How often it began to be found.
    begins: Vec<usize>,
}

pub(super) fn score(moments: &[Numbered<'_>], truths: usize) -> Clear {
    let mut memory = Memory {
        last: vec![None; truths],
        now: vec![None; truths],
        begins: vec![0; truths],
    };
    let (mut matched, mut missed, mut false_alarms, mut switches) = (0_usize, 0, 0, 0);
    for moment in moments {
        let pairs = memory.pairs(moment);
        matched += pairs.len();
        missed += moment.truths.len() - pairs.len();
        false_alarms += moment.found.len() - pairs.len();
        // As the reference has it: where nothing is there or nothing was found, all stays as it was.
        if !moment.truths.is_empty() && !moment.found.is_empty() {
            switches += memory.take(&pairs);
        }
    }
    let all = matched + missed;
    let wrong = (missed + false_alarms + switches) as f64;
    Clear {
        mota: (all > 0).then(|| 1.0 - wrong / all as f64),
        switches,
        fragmentations: memory
            .begins
            .iter()
            .map(|begins| begins.saturating_sub(1))
            .sum(),
    }
}

impl Memory {
    /// Who is taken for whom, by their numbers.
    fn pairs(&self, moment: &Numbered<'_>) -> Vec<(usize, usize)> {
        let (truths, found) = (&moment.truths, &moment.found);
        let score = |row: usize, column: usize| {
            let similarity = moment.similarity[row][column];
            if similarity < MIN_SIMILARITY - SLACK {
                return 0.0;
            }
            let kept = self.now[truths[row]] == Some(found[column]);
            similarity + if kept { KEPT } else { 0.0 }
        };
        let pairs = assign(truths.len(), found.len(), score).into_iter();
        pairs
            .map(|(row, column)| (truths[row], found[column]))
            .collect()
    }

    /// Takes a moment's pairs, and gives the number of switches.
    fn take(&mut self, pairs: &[(usize, usize)]) -> usize {
        let mut switches = 0;
        let before = std::mem::replace(&mut self.now, vec![None; self.last.len()]);
        for &(truth, found) in pairs {
            switches += usize::from(self.last[truth].is_some_and(|last| last != found));
            self.begins[truth] += usize::from(before[truth].is_none());
            self.last[truth] = Some(found);
            self.now[truth] = Some(found);
        }
        switches
    }
}
