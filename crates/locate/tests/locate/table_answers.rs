//! When a table answers, and how sure it says it is.

use crate::common::{camera, car_ahead, car_hull, cars, row, table};
use roadwatch_core::{BoxPx, ImageSize, RigCamera, SizeLwh, camera_model::Pixel};
use roadwatch_locate::{
    BoxNoise, ClassSize, ClassSizes, Estimate, GridSpec, TableLocator, TableOptions, Weight,
    build_table,
};
use std::sync::Arc;

fn car() -> ClassSize {
    let sizes = ClassSizes::default();
    *sizes.get(&cars().classes[0]).expect("cars have a size")
}

fn locator(camera: &RigCamera, weight: Weight) -> TableLocator {
    let group = (cars(), &car_hull());
    let table = build_table(camera, 0.0, &GridSpec::default(), group, |_| ()).expect("a table");
    let options = TableOptions {
        weight,
        ..TableOptions::default()
    };
    TableLocator::new(camera, 0.0, Arc::new(table), options).expect("its own camera")
}

/// The same camera with an image twice as large.
fn doubled(camera: &RigCamera) -> RigCamera {
    let mut doubled = camera.clone();
    doubled.model = camera.model.scaled_to(ImageSize {
        width_px: 2 * camera.model.size.width_px,
        height_px: 2 * camera.model.size.height_px,
    });
    doubled
}

/// The box with its lower edge moved so that it is `share` as high.
fn cut(box_px: BoxPx, share: f32) -> BoxPx {
    BoxPx {
        y_max: box_px.y_min + box_px.height_px() * share,
        ..box_px
    }
}

fn located(locator: &TableLocator, box_px: &BoxPx) -> Option<Estimate> {
    locator.locate(&car(), box_px, &BoxNoise::default())
}

#[test]
fn the_score_limit_means_the_same_in_an_image_twice_as_large() {
    let small = camera(985.0, 1.0, 0.0);
    for weight in [Weight::default(), Weight::BoxWidth] {
        let (here, there) = (locator(&small, weight), locator(&doubled(&small), weight));
        let seen = car_ahead(&small, 35.0).box_px;
        let shares = (1..=40).map(|percent| 0.025 * percent as f32);
        let matched: Vec<_> = shares
            .map(|share| {
                let box_px = cut(seen, share);
                let twice = [box_px.x_min, box_px.y_min, box_px.x_max, box_px.y_max];
                let [x_min, y_min, x_max, y_max] = twice.map(|edge| 2.0 * edge);
                let twice = BoxPx::new(x_min, y_min, x_max, y_max).expect("a box");
                let matched = located(&here, &box_px).is_some();
                assert_eq!(matched, located(&there, &twice).is_some(), "{share}");
                matched
            })
            .collect();
        assert!(matched.is_sorted() && matched[0] != matched[39]);
    }
}

#[test]
fn weighed_by_box_width_a_near_car_may_be_off_by_metres_and_not_by_tens() {
    let camera = camera(985.0, 12.0, 0.0);
    let locator = locator(&camera, Weight::BoxWidth);
    let seen = car_ahead(&camera, 8.0).box_px;
    assert!(seen.width_px() > 300.0, "{seen:?}");
    assert!(located(&locator, &seen).is_some());
    assert!(located(&locator, &cut(seen, 0.5)).is_some());
    assert_eq!(located(&locator, &cut(seen, 0.01)), None);
}

#[test]
fn uncertainty_does_not_fall_towards_the_tables_edge_or_beyond_it() {
    let camera = camera(985.0, 1.0, 0.5);
    let locator = locator(&camera, Weight::default());
    let spread_m = |loc_y_m| {
        let found = located(&locator, &car_ahead(&camera, loc_y_m).box_px).expect("located");
        found.covariance.matrix.trace().sqrt()
    };
    // Places are a metre apart, so spreads step by a few per cent.
    let spreads: Vec<f64> = (10..=95).map(f64::from).map(spread_m).collect();
    println!("{spreads:.2?}");
    let mut most_m: f64 = 0.0;
    for (spread_m, loc_y_m) in spreads.iter().zip(10..) {
        assert!(
            *spread_m > 0.9 * most_m,
            "at {loc_y_m} m: {spread_m} after {most_m}"
        );
        most_m = most_m.max(*spread_m);
    }
}

#[test]
fn rows_that_disagree_with_the_published_one_count_by_how_far_they_are_from_it() {
    let published = row(485.0, 300.0, 20.0, 0.0);
    let others = vec![row(485.0, 300.5, 20.0, 2.0); 15];
    let table = table([vec![published], others].concat());
    let camera = camera(985.0, 0.0, 0.0);
    let locator =
        TableLocator::new(&camera, 0.0, table, TableOptions::default()).expect("its own camera");
    let exact = BoxNoise {
        edge_px: 0.0,
        edge_share_of_height: 0.0,
    };
    let known = ClassSize {
        std_dev: SizeLwh {
            length_m: 0.0,
            width_m: 0.0,
            height_m: 0.0,
        },
        ..car()
    };
    let half = Pixel::new(40.0, 985.0 * 1.5 / 20.0 / 2.0);
    let middle = Pixel::new(485.0, 300.0);
    let box_px = BoxPx::between(middle - half, middle + half).expect("a box");
    let found = locator.locate(&known, &box_px, &exact).expect("located");
    assert!(found.position.y().abs() < 1e-6);
    let aside_m2 = found.covariance.matrix[(1, 1)];
    let expected_m2 = 15.0 / 16.0 * 2.0 * 2.0 + 1.0 / 12.0;
    assert!((aside_m2 - expected_m2).abs() < 1e-3, "{aside_m2}");
}
