use super::*;

/// A moment in which each true object, by its place, is found as the identity given, if one is.
fn moment(found: &[Option<u64>]) -> Moment {
    let ids: Vec<u64> = found.iter().flatten().copied().collect();
    let row = |one: &Option<u64>| ids.iter().map(|id| f64::from(Some(*id) == *one)).collect();
    Moment {
        truths: (0..found.len() as u64).collect(),
        similarity: found.iter().map(row).collect(),
        found: ids,
    }
}

#[test]
fn what_is_always_found_as_the_same_is_perfect() {
    let score = IdentityScore::of(&[moment(&[Some(7), Some(9)]), moment(&[Some(7), Some(9)])]);
    assert_eq!(score.object_frames, 4);
    for share in [score.idf1, score.hota, score.deta, score.assa, score.mota] {
        assert!((share.expect("a share") - 1.0).abs() < 1e-12, "{score:?}");
    }
    assert_eq!((score.switches, score.fragmentations), (0, 0));
}

#[test]
fn an_exchange_of_identities_is_two_switches() {
    let score = IdentityScore::of(&[
        moment(&[Some(7), Some(9)]),
        moment(&[Some(7), Some(9)]),
        moment(&[Some(9), Some(7)]),
        moment(&[Some(9), Some(7)]),
    ]);
    assert_eq!(score.switches, 2);
    assert_eq!(score.mota, Some(0.75));
    assert_eq!(score.idf1, Some(0.5));
}

#[test]
fn a_gap_is_a_fragmentation_and_not_a_switch() {
    let score = IdentityScore::of(&[
        moment(&[Some(7), Some(9)]),
        moment(&[None, Some(9)]),
        moment(&[Some(7), Some(9)]),
    ]);
    assert_eq!((score.switches, score.fragmentations), (0, 1));
    assert_eq!(score.mota, Some(1.0 - 1.0 / 6.0));
}

#[test]
fn nothing_is_scored_as_nothing() {
    assert_eq!(IdentityScore::of(&[]), IdentityScore::default());
    let empty = IdentityScore::of(&[Moment::default()]);
    assert_eq!((empty.idf1, empty.hota, empty.mota), (None, None, None));
    let missed = IdentityScore::of(&[moment(&[None])]);
    assert_eq!((missed.idf1, missed.mota), (Some(0.0), Some(0.0)));
}

#[test]
fn the_best_sum_is_found_whatever_the_shape() {
    let score = [[0.9, 0.8, 0.0], [0.8, 0.1, 0.0]];
    assert_eq!(
        assign(2, 3, |row, column| score[row][column]),
        [(0, 1), (1, 0)]
    );
    assert_eq!(assign(3, 2, |row, column| score[column][row]).len(), 2);
    assert!(assign(0, 2, |_, _| 1.0).is_empty());
}
