//! The index finds the row that a scan finds, always.

use crate::common::{Random, row, table};
use proptest::prelude::*;
use roadwatch_locate::{TableIndex, TableQuery, TableRow, table::Split};

const COLUMN_PX: f32 = 485.0;
const WIDTH_PX: f32 = 960.0;

fn splits() -> [Split; 2] {
    [
        Split::Literal {
            image_width_px: WIDTH_PX,
        },
        Split::Axis {
            column_px: COLUMN_PX,
            guard_m: 2.0,
        },
    ]
}

/// Quarters, so that many rows and queries are equally far apart.
fn coarse(range: std::ops::Range<i32>) -> impl Strategy<Value = f32> {
    range.prop_map(|quarters| quarters as f32 / 4.0)
}

fn coarse_row() -> impl Strategy<Value = TableRow> {
    (coarse(0..80), coarse(0..40), coarse(4..60), coarse(-40..40))
        .prop_map(|(x, y, d, loc_x)| row(475.0 + x, y, d, loc_x))
}

fn fine_row() -> impl Strategy<Value = TableRow> {
    (
        0.0..960.0_f32,
        0.0..540.0_f32,
        1.0..100.0_f32,
        -50.0..50.0_f32,
    )
        .prop_map(|(x, y, d, loc_x)| row(x, y, d, loc_x))
}

fn rows() -> impl Strategy<Value = Vec<TableRow>> {
    let some = 1..700_usize;
    prop_oneof![
        prop::collection::vec(coarse_row(), some.clone()),
        prop::collection::vec(fine_row(), some.clone()),
        (coarse_row(), some).prop_map(|(one, count)| vec![one; count]),
    ]
}

/// With a weight of zero, of a number, and as wide as a box.
fn query() -> impl Strategy<Value = TableQuery> {
    let weight = prop_oneof![Just(0.0_f32), Just(20.0_f32), 1.0..900.0_f32];
    let place = prop_oneof![
        (coarse(1880..2020), coarse(0..40), coarse(0..80)),
        (-2000.0..3000.0_f32, -900.0..1500.0_f32, -50.0..400.0_f32),
    ];
    (place, weight).prop_map(|((x, y, d), px_per_metre)| TableQuery {
        center_x_px: x,
        center_y_px: y,
        distance_m: d,
        px_per_metre,
    })
}

/// The `K` best rows by sorting all of them.
fn sorted<const K: usize>(index: &TableIndex, split: Split, query: &TableQuery) -> Vec<(f32, u32)> {
    let right = match split {
        Split::Literal { image_width_px } => query.center_x_px > image_width_px / 2.0,
        Split::Axis { column_px, .. } => query.center_x_px > column_px,
    };
    let keeps = |loc_x: f32| match (split, right) {
        (Split::Literal { .. }, right) => (loc_x >= 0.0) == right,
        (Split::Axis { guard_m, .. }, true) => loc_x >= -guard_m,
        (Split::Axis { guard_m, .. }, false) => loc_x <= guard_m,
    };
    let numbered = (0_u32..).zip(index.table().rows());
    let kept = numbered.filter(|(_, row)| keeps(row.loc_x_m));
    let mut all: Vec<_> = kept.map(|(at, row)| (query.score(row), at)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    all.truncate(K);
    all
}

proptest! {
    #[test]
    fn the_index_finds_what_the_scan_finds(rows in rows(), queries in prop::collection::vec(query(), 20)) {
        let table = table(rows);
        for split in splits() {
            let index = TableIndex::new(table.clone(), split);
            for query in &queries {
                let scanned = index.scan(query);
                prop_assert_eq!(index.nearest(query), scanned);
                let all = sorted::<9>(&index, split, query);
                prop_assert_eq!(scanned.map(|found| (found.score, found.row)), all.first().copied());
                let near = index.nearest_rows::<9>(query);
                let near: Vec<_> = near.iter().flatten().map(|one| (one.score, one.row)).collect();
                prop_assert_eq!(near, all);
            }
        }
    }

    #[test]
    fn a_mirrored_query_finds_the_mirrored_row(rows in prop::collection::vec(coarse_row(), 1..500), query in query()) {
        let mirrored = rows.iter().map(|row| TableRow {
            center_x_px: 2.0 * COLUMN_PX - row.center_x_px,
            loc_x_m: -row.loc_x_m,
            ..*row
        });
        let seen_in_mirror = TableQuery { center_x_px: 2.0 * COLUMN_PX - query.center_x_px, ..query };
        let exact = seen_in_mirror.center_x_px + query.center_x_px == 2.0 * COLUMN_PX;
        prop_assume!(exact && query.center_x_px != COLUMN_PX);
        let split = splits()[1];
        let here = TableIndex::new(table(rows.clone()), split);
        let there = TableIndex::new(table(mirrored.collect()), split);
        let best = here.nearest_rows::<2>(&query);
        let unique = best[0].map(|one| one.score) != best[1].map(|one| one.score);
        prop_assume!(unique);
        prop_assert_eq!(here.nearest(&query).map(|one| one.row), there.nearest(&seen_in_mirror).map(|one| one.row));
    }
}

#[test]
fn a_hundred_thousand_queries_over_a_hundred_thousand_rows_agree_with_the_scan() {
    let mut random = Random(42);
    let mut rows = Vec::new();
    while rows.len() < 100_000 {
        let d = random.between(2.0, 80.0);
        let azimuth = random.between(-0.8, 0.8);
        let x = 485.0 + 465.0 * azimuth.tan();
        let y = 241.0 + 465.0 * 1.4 / d + random.between(-3.0, 3.0);
        rows.push(row(
            x as f32,
            y as f32,
            d as f32,
            (d * azimuth.tan()) as f32,
        ));
    }
    let index = TableIndex::new(table(rows), splits()[1]);
    for number in 0..100_000_u32 {
        let spread = if number % 10 == 0 { 30.0 } else { 1.0 };
        let near = index.table().rows()[(random.unit() * 1e5) as usize];
        let query = TableQuery {
            center_x_px: near.center_x_px + (random.normal() * 3.0 * spread) as f32,
            center_y_px: near.center_y_px + (random.normal() * 3.0 * spread) as f32,
            distance_m: near.distance_m * (1.0 + 0.1 * random.normal()) as f32,
            px_per_metre: if number % 2 == 0 {
                20.0
            } else {
                random.between(10.0, 400.0) as f32
            },
        };
        assert_eq!(index.nearest(&query), index.scan(&query), "{query:?}");
    }
}

#[test]
fn an_empty_half_and_queries_that_are_not_numbers_match_nothing() {
    let only_right = TableIndex::new(table(vec![row(600.0, 300.0, 20.0, 5.0)]), splits()[1]);
    let ask = |center_x_px, distance_m, px_per_metre| TableQuery {
        center_x_px,
        center_y_px: 300.0,
        distance_m,
        px_per_metre,
    };
    assert!(only_right.nearest(&ask(600.0, 20.0, 20.0)).is_some());
    for query in [
        ask(100.0, 20.0, 20.0),
        ask(f32::NAN, 20.0, 20.0),
        ask(600.0, f32::INFINITY, 20.0),
        ask(600.0, 20.0, -1.0),
        ask(600.0, 20.0, f32::NAN),
    ] {
        assert_eq!(only_right.nearest(&query), None);
        assert_eq!(only_right.scan(&query), None);
    }
}

#[test]
fn rows_with_absurd_numbers_match_nothing_and_break_nothing() {
    let index = TableIndex::new(
        table(vec![row(f32::MAX, f32::MAX, f32::MAX, 5.0); 9]),
        splits()[1],
    );
    let query = TableQuery {
        center_x_px: 600.0,
        center_y_px: 300.0,
        distance_m: 20.0,
        px_per_metre: 0.0,
    };
    assert_eq!(index.nearest(&query), index.scan(&query));
}
