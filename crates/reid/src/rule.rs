//! Who gets which place in a camera's row.

use crate::assignment::{Pair, assign};
use roadwatch_core::{BoxPx, ObjectClass};
use std::time::Duration;

/// Boxes of one object overlap at least so much from one frame to the next (intersection over union); at 10 Hz, cars at
/// city speeds do by far.
const LEAST_OVERLAP: f32 = 0.2;
/// An object that nobody saw for so long is gone: its box has moved on.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(1);

/// How objects of one camera are told apart. Both are baselines: neither knows of motion, nor of other cameras.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// The paper's (section E, Fig. 8): the n-th from the left is the n-th. It says nothing about who somebody is: when a
    /// car enters at the left, everybody moves on by one. Objects side by side keep the order in which they come. Only
    /// the last frame counts.
    #[default]
    LeftToRight,
    /// Who overlaps most with whom, of one class, as the sum over all is greatest (Hungarian method). Who overlaps with
    /// nobody is new; who was not seen for a second is forgotten.
    Overlap,
}

impl Rule {
    /// How long somebody's place is kept; nothing for those who were not in the last frame, when that is zero.
    pub(crate) fn lasts(self) -> Duration {
        match self {
            Self::LeftToRight => Duration::ZERO,
            Self::Overlap => FORGOTTEN_AFTER,
        }
    }

    /// More places than a camera ever has. In tens, so that people can read an identity.
    pub(crate) fn most_places(self) -> u64 {
        match self {
            Self::LeftToRight => 10_000,
            // New ones for hundreds of days.
            Self::Overlap => 10_000_000_000,
        }
    }

    /// The place of each object, where the others stood as `known` says, and `next` is the first place that is free.
    pub(crate) fn places(
        self,
        objects: &[(&BoxPx, &ObjectClass)],
        known: &[(usize, &BoxPx, &ObjectClass)],
        next: usize,
    ) -> Vec<usize> {
        match self {
            Self::LeftToRight => from_left(objects.iter().map(|(box_px, _)| *box_px)),
            Self::Overlap => by_overlap(objects, known, next),
        }
    }
}

/// Each box's place from the left, by its middle; equal middles keep their order.
fn from_left<'a>(boxes: impl Iterator<Item = &'a BoxPx>) -> Vec<usize> {
    let middles: Vec<f64> = boxes.map(|box_px| box_px.center().x).collect();
    let mut from_left: Vec<usize> = (0..middles.len()).collect();
    from_left.sort_by(|&a, &b| middles[a].total_cmp(&middles[b]));
    let mut places = vec![0; from_left.len()];
    for (place, item) in from_left.into_iter().enumerate() {
        places[item] = place;
    }
    places
}

fn by_overlap(
    objects: &[(&BoxPx, &ObjectClass)],
    known: &[(usize, &BoxPx, &ObjectClass)],
    mut next: usize,
) -> Vec<usize> {
    let mut pairs = Vec::new();
    for (row, (box_px, class)) in objects.iter().enumerate() {
        for (column, (_, before, class_before)) in known.iter().enumerate() {
            let iou = box_px.iou(before);
            if class == class_before && iou >= LEAST_OVERLAP {
                let gain = f64::from(iou);
                pairs.push(Pair { row, column, gain });
            }
        }
    }
    let taken = assign(objects.len(), known.len(), &pairs).into_iter();
    let places = taken.map(|column| column.map(|column| known[column].0));
    let mut placed = |place: Option<usize>| {
        place.unwrap_or_else(|| {
            next += 1;
            next - 1
        })
    };
    places.map(&mut placed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_px(x: f32) -> BoxPx {
        BoxPx::new(x, 0.0, x + 10.0, 10.0).expect("a box")
    }

    fn places(now: &[(f32, &str)], before: &[(usize, f32, &str)]) -> Vec<usize> {
        let class = |name: &&str| ObjectClass::new(name);
        let now: Vec<_> = now
            .iter()
            .map(|(x, name)| (box_px(*x), class(name)))
            .collect();
        let before: Vec<_> = before
            .iter()
            .map(|(at, x, name)| (*at, box_px(*x), class(name)))
            .collect();
        let objects: Vec<_> = now.iter().map(|(b, c)| (b, c)).collect();
        let known: Vec<_> = before.iter().map(|(at, b, c)| (*at, b, c)).collect();
        Rule::Overlap.places(&objects, &known, 9)
    }

    #[test]
    fn whoever_enters_at_the_left_moves_nobody() {
        let before = [(3, 100.0, "car"), (4, 200.0, "car")];
        let now = [(20.0, "car"), (102.0, "car"), (203.0, "car")];
        assert_eq!(places(&now, &before), [9, 3, 4]);
    }

    #[test]
    fn the_greatest_sum_counts_and_not_who_comes_first() {
        // The first overlaps more with the second's place than the second does, but the second has no other.
        let before = [(3, 94.0, "car"), (4, 101.0, "car")];
        assert_eq!(places(&[(99.0, "car"), (104.0, "car")], &before), [3, 4]);
    }

    #[test]
    fn another_class_and_a_box_elsewhere_are_new() {
        let before = [(3, 100.0, "car")];
        assert_eq!(places(&[(100.0, "bus"), (109.5, "car")], &before), [9, 10]);
        assert!(places(&[], &before).is_empty());
        assert_eq!(places(&[(0.0, "car")], &[]), [9]);
    }
}
