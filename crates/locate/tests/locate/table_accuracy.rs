//! Tables made from a camera's calibration locate exact silhouettes that are not in them.

use crate::common::{Random, SeenCar, camera, car_hull, cars, seen_cars, silhouettes};
use roadwatch_core::{Distortion, ObjectClass, RigCamera};
use roadwatch_locate::{
    ClassSizes, GridSpec, GroundPose, HullSpec, QueryDistance, TableIndex, TableLocator,
    TableOptions, Weight, build_table, table::Split,
};
use std::sync::Arc;

fn locator(camera: &RigCamera, options: TableOptions) -> TableLocator {
    let group = (cars(), &car_hull());
    let table = build_table(camera, 0.0, &GridSpec::default(), group, |_| ()).expect("a table");
    TableLocator::new(camera, 0.0, Arc::new(table), options).expect("its own camera")
}

fn p90(mut errors: Vec<f64>) -> f64 {
    errors.sort_by(f64::total_cmp);
    errors[errors.len() * 9 / 10]
}

/// The 90th percentile of location errors when the daemon asks, metres; with the true depth in place of
/// `d_` when `true_depth`.
fn location_p90_m(camera: &RigCamera, options: TableOptions, ask: Ask) -> f64 {
    let locator = locator(camera, options);
    let sizes = ClassSizes::default();
    let class = sizes.get(&cars().classes[0]).expect("cars have a size");
    let index = TableIndex::new(Arc::new(locator.table().clone()), Split::axis(camera));
    let error = |car: &SeenCar| {
        let mut query = locator.query(class, &car.box_px).expect("a ray");
        if ask == Ask::TrueDepth {
            query.distance_m = car.depth_m as f32;
        }
        let row = index.row(index.nearest(&query).expect("a match"));
        let across_m = f64::from(row.loc_x_m) - car.pose.loc_x_m;
        across_m.hypot(f64::from(row.loc_y_m) - car.pose.loc_y_m)
    };
    p90(seen_cars(camera, &mut Random(7), 5_000)
        .iter()
        .map(error)
        .collect())
}

#[derive(Clone, Copy, PartialEq)]
enum Ask {
    AsTheDaemon,
    TrueDepth,
}

#[test]
fn off_the_grid_the_location_p90_is_at_most_one_step_at_6_to_50_m() {
    let step_m = GridSpec::default().step_m;
    for (focal_px, pitch_deg) in [(985.0, 0.5), (465.0, 0.5), (465.0, 0.0), (985.0, 3.0)] {
        let camera = camera(focal_px, pitch_deg, 0.0);
        let p90_m = location_p90_m(&camera, TableOptions::default(), Ask::AsTheDaemon);
        let exact_m = location_p90_m(&camera, TableOptions::default(), Ask::TrueDepth);
        println!(
            "f {focal_px} pitch {pitch_deg}: p90 {p90_m:.2} m, with true depth {exact_m:.2} m"
        );
        assert!(p90_m <= step_m, "f {focal_px} pitch {pitch_deg}: {p90_m}");
        assert!(
            exact_m <= 0.75 * step_m,
            "f {focal_px} pitch {pitch_deg}: {exact_m}"
        );
    }
}

#[test]
fn weighing_by_box_width_is_as_good_and_plain_eq_2_is_worse() {
    let camera = camera(985.0, 0.5, 0.0);
    let box_width = TableOptions {
        weight: Weight::BoxWidth,
        ..TableOptions::default()
    };
    let literal = TableOptions {
        distance: QueryDistance::Literal,
        ..TableOptions::default()
    };
    let box_width_m = location_p90_m(&camera, box_width, Ask::AsTheDaemon);
    let literal_m = location_p90_m(&camera, literal, Ask::AsTheDaemon);
    println!("box width {box_width_m:.2} m, plain eq. 2 {literal_m:.2} m");
    assert!(box_width_m <= GridSpec::default().step_m);
    assert!((1.5..3.0).contains(&literal_m), "{literal_m}");
}

#[test]
fn a_camera_rolled_by_a_degree_with_a_bent_lens_is_within_one_and_a_quarter_steps() {
    let mut camera = camera(465.0, 4.0, 1.0);
    camera.model.distortion =
        Distortion::BrownConrady([-0.2, 0.03, 1e-3, -1e-3, 0.0, 0.0, 0.0, 0.0]);
    let p90_m = location_p90_m(&camera, TableOptions::default(), Ask::AsTheDaemon);
    println!("rolled and distorted: p90 {p90_m:.2} m");
    assert!(p90_m <= 1.25 * GridSpec::default().step_m, "{p90_m}");
}

#[test]
fn a_cars_silhouette_is_about_nine_tenths_as_high_as_its_cuboid() {
    for focal_px in [985.0, 465.0] {
        let camera = camera(focal_px, 0.5, 0.0);
        let over_ground = silhouettes(&camera);
        let cuboid = HullSpec::for_class(&ObjectClass::new("of no known outline"))
            .points(crate::common::CAR);
        let ratio = |car: &SeenCar| {
            let whole = over_ground.silhouette_px(&cuboid, car.pose)?;
            Some(f64::from(car.box_px.height_px() / whole.height_px()))
        };
        let cars = seen_cars(&camera, &mut Random(3), 5_000);
        let mean = cars.iter().filter_map(ratio).sum::<f64>() / cars.len() as f64;
        println!("f {focal_px}: silhouette to cuboid {mean:.3}");
        assert!((0.87..=0.91).contains(&mean), "{mean}");
    }
}

#[test]
fn a_camera_that_looks_straight_down_has_no_table() {
    let camera = camera(465.0, 80.0, 0.0);
    let group = (cars(), &car_hull());
    let refused = build_table(&camera, 0.0, &GridSpec::default(), group, |_| ());
    let message = refused
        .expect_err("within 20 degrees of vertical")
        .to_string();
    assert!(message.contains("10.0 degrees from vertical"), "{message}");
}

#[test]
fn a_camera_that_sees_no_ground_and_an_impossible_grid_are_refused() {
    let build = |pitch_deg, spec: GridSpec| {
        let group = (cars(), &car_hull());
        build_table(&camera(985.0, pitch_deg, 0.0), 0.0, &spec, group, |_| ())
            .expect_err("no table")
            .to_string()
    };
    let usual = GridSpec::default();
    assert!(build(-60.0, usual).contains("empty"));
    assert!(
        build(
            0.0,
            GridSpec {
                step_m: 0.0,
                ..usual
            }
        )
        .contains("step")
    );
    assert!(
        build(
            0.0,
            GridSpec {
                step_m: 1e-6,
                ..usual
            }
        )
        .contains("rows")
    );
    assert!(
        build(
            0.0,
            GridSpec {
                farthest_m: f64::NAN,
                ..usual
            }
        )
        .contains("finite")
    );
    assert!(
        build(
            0.0,
            GridSpec {
                headings: 0,
                ..usual
            }
        )
        .contains("headings")
    );
}

#[test]
fn a_row_says_where_its_silhouette_stands() {
    let camera = camera(985.0, 2.0, 1.0);
    let group = (cars(), &car_hull());
    let mut shares = Vec::new();
    let spec = GridSpec {
        farthest_m: 30.0,
        ..GridSpec::default()
    };
    let table =
        build_table(&camera, 0.0, &spec, group, |share| shares.push(share)).expect("a table");
    assert!(shares.is_sorted() && shares.last() == Some(&1.0));
    let grid = table.header().grid;
    let points = car_hull().points(crate::common::CAR);
    for row in table.rows().iter().step_by(97) {
        let (along, column) = (row.loc / grid.columns, row.loc % grid.columns);
        assert!((grid.origin_loc_x_m + column as f32 * grid.step_m - row.loc_x_m).abs() < 1e-4);
        assert!((grid.origin_loc_y_m + along as f32 * grid.step_m - row.loc_y_m).abs() < 1e-4);
        let pose = |heading_rad| GroundPose {
            loc_x_m: row.loc_x_m.into(),
            loc_y_m: row.loc_y_m.into(),
            heading_rad,
        };
        let headings = (0..8).map(|n| std::f64::consts::PI * f64::from(n) / 8.0);
        let cast = |heading| {
            let whole = silhouettes(&camera).silhouette_px(&points, pose(heading))?;
            silhouettes(&camera).clip(whole)
        };
        let same = headings.filter_map(cast).any(|(box_px, _)| {
            let center = box_px.center();
            (center.x as f32 - row.center_x_px).abs() < 1e-2
                && (center.y as f32 - row.center_y_px).abs() < 1e-2
        });
        assert!(same, "{row:?}");
    }
}
