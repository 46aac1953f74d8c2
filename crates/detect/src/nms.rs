//! Non-maximum suppression, class by class, or among classes that exclude each other.

use roadwatch_core::BoxPx;

/// A box that passed its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// In the image, pixels.
    pub box_px: BoxPx,
    /// `0.0..=1.0`.
    pub score: f32,
    /// The network's class number.
    pub class: u16,
    /// What suppression takes for its class: the same number for classes that exclude each other.
    pub kind: u16,
}

/// Keeps, best score first, each candidate that overlaps no better one of its kind by more than
/// `iou_threshold`, at most `limit` of them. Works in place; the order of the input does not matter.
pub fn suppress(candidates: &mut Vec<Candidate>, iou_threshold: f32, limit: usize) {
    candidates.sort_unstable_by(best_first);
    let mut kept = 0;
    for at in 0..candidates.len() {
        let candidate = candidates[at];
        let overlaps = |better: &Candidate| {
            better.kind == candidate.kind && better.box_px.iou(&candidate.box_px) > iou_threshold
        };
        if !candidates[..kept].iter().any(overlaps) {
            candidates[kept] = candidate;
            kept += 1;
            if kept == limit {
                break;
            }
        }
    }
    candidates.truncate(kept);
}

/// A total order, so that equal scores come out the same whatever order they came in.
fn best_first(a: &Candidate, b: &Candidate) -> std::cmp::Ordering {
    let corners = |c: &Candidate| {
        [
            c.box_px.x_min,
            c.box_px.y_min,
            c.box_px.x_max,
            c.box_px.y_max,
        ]
    };
    b.score
        .total_cmp(&a.score)
        .then_with(|| a.class.cmp(&b.class))
        .then_with(|| {
            let (a, b) = (corners(a), corners(b));
            a.iter()
                .zip(&b)
                .map(|(a, b)| a.total_cmp(b))
                .find(|order| order.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn candidates() -> impl Strategy<Value = Vec<Candidate>> {
        let one = (
            0.0..80.0_f32,
            0.0..80.0_f32,
            1.0..40.0_f32,
            1.0..40.0_f32,
            0..10_u8,
            0..3_u16,
        )
            .prop_map(|(x, y, w, h, score, class)| Candidate {
                box_px: BoxPx::new(x, y, x + w, y + h).expect("has an area"),
                score: f32::from(score) / 10.0,
                class,
                kind: class % 2,
            });
        prop::collection::vec(one, 0..60)
    }

    fn suppressed(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
        suppress(&mut candidates, 0.45, usize::MAX);
        candidates
    }

    proptest! {
        #[test]
        fn suppressing_twice_changes_nothing(candidates in candidates()) {
            let once = suppressed(candidates);
            prop_assert_eq!(suppressed(once.clone()), once);
        }

        #[test]
        fn the_order_of_the_input_does_not_matter(
            (candidates, shuffled) in candidates().prop_flat_map(|c| (Just(c.clone()), Just(c).prop_shuffle())),
        ) {
            prop_assert_eq!(suppressed(candidates), suppressed(shuffled));
        }

        #[test]
        fn no_two_kept_boxes_of_a_kind_overlap_beyond_the_threshold(candidates in candidates()) {
            let kept = suppressed(candidates);
            for (at, a) in kept.iter().enumerate() {
                for b in &kept[at + 1..] {
                    prop_assert!(a.kind != b.kind || a.box_px.iou(&b.box_px) <= 0.45);
                }
            }
        }

        #[test]
        fn a_limit_keeps_the_best(candidates in candidates(), limit in 1_usize..10) {
            let all = suppressed(candidates.clone());
            let mut few = candidates;
            suppress(&mut few, 0.45, limit);
            prop_assert_eq!(&few[..], &all[..all.len().min(limit)]);
        }
    }
}
