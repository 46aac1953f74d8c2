//! What holds for every method.

use crate::common::{camera, car_ahead, car_hull, cars, detection, silhouettes};
use proptest::prelude::*;
use roadwatch_core::{BoxPx, Known, Location, Locator, Method, Prior, RigCamera};
use roadwatch_locate::{
    BoxNoise, CameraLocator, CarCategory, ClassSizes, GridSpec, GroundPose, LocatorError,
    LocatorOptions, SizeStatistic, build_table,
};
use std::{
    sync::{Arc, LazyLock},
    time::Duration,
};

static CAMERA: LazyLock<RigCamera> = LazyLock::new(|| camera(985.0, 1.0, 0.5));
static LOCATORS: LazyLock<Vec<CameraLocator>> = LazyLock::new(|| {
    Method::ALL
        .into_iter()
        .map(|method| locator(options(method)))
        .collect()
});

fn options(method: Method) -> LocatorOptions {
    let group = (cars(), &car_hull());
    LocatorOptions {
        table: build_table(&CAMERA, 0.0, &GridSpec::default(), group, |_| ())
            .ok()
            .map(Arc::new),
        ..LocatorOptions::new(method)
    }
}

fn locator(options: LocatorOptions) -> CameraLocator {
    CameraLocator::new(&CAMERA, 0.0, options).expect("a camera with everything")
}

fn check(location: &Location, method: Method) {
    assert_eq!((location.method, location.held), (method, false));
    let position = location.position;
    assert!(location.depth_m > 0.0 && location.depth_m == CAMERA.depth_m(position));
    assert!(location.range_m <= LocatorOptions::DEFAULT_MAX_RANGE_M);
    assert_eq!(location.range_m, CAMERA.range_m(position));
    assert!(position.coords.iter().all(|number| number.is_finite()));
    let covariance = location.covariance.matrix;
    assert!(covariance.iter().all(|number| number.is_finite()));
    let smallest = covariance.symmetric_eigenvalues().min();
    assert!(
        smallest >= -1e-9 * covariance.trace(),
        "{method}: {covariance}"
    );
    assert!(covariance.trace() > 0.0);
}

fn any_edge() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => -200.0..1200.0_f32,
        1 => prop::num::f32::ANY,
        1 => prop::sample::select(vec![0.0, -0.5, 540.0, 960.0, 1e-30, 1e9, 3e38, -3e38]),
    ]
}

proptest! {
    #[test]
    fn no_box_makes_a_panic_or_a_number_that_is_none(
        edges in prop::array::uniform4(any_edge()),
        class in prop::sample::select(vec!["car", "person", "traffic light", "bus", "kite"]),
    ) {
        let [x_min, y_min, x_max, y_max] = edges;
        let seen = detection(class, BoxPx { x_min, y_min, x_max, y_max });
        for (locator, method) in LOCATORS.iter().zip(Method::ALL) {
            if let Some(location) = locator.locate(&seen, &Known::default()) {
                let raised = class == "traffic light";
                let fallback = match method {
                    Method::Table => class != "car",
                    Method::Ground | Method::Fused => raised,
                    _ => false,
                };
                check(&location, if fallback { Method::TriangleFy } else { method });
            }
        }
    }
}

#[test]
fn a_car_ahead_is_where_it_stands() {
    for (locator, method) in LOCATORS.iter().zip(Method::ALL) {
        for loc_y_m in [9.0, 15.0, 30.0, 45.0] {
            let location = locator
                .locate(&car_ahead(&CAMERA, loc_y_m), &Known::default())
                .expect("located");
            check(&location, method);
            let error_m = (location.position.x() - 0.85 - loc_y_m).abs();
            assert!(error_m < 3.0, "{method} at {loc_y_m} m: off by {error_m}");
            assert!(
                (location.position.y() + 0.3).abs() < 1.0,
                "{method} at {loc_y_m} m"
            );
        }
    }
}

/// Standard deviation of the position, all axes together, metres.
fn spread_m(locator: &CameraLocator, loc_y_m: f64) -> f64 {
    let location = locator
        .locate(&car_ahead(&CAMERA, loc_y_m), &Known::default())
        .expect("located");
    location.covariance.matrix.trace().sqrt()
}

#[test]
fn uncertainty_grows_with_distance() {
    for (locator, method) in LOCATORS.iter().zip(Method::ALL) {
        let farthest_m = match method {
            // A table answers up to its edge at 80 m, and a little beyond.
            Method::Table => 90.0,
            // Expects cars a little higher than these, so sees them a little farther away.
            Method::Fused => 135.0,
            _ => 145.0,
        };
        let places = [9.0, 18.0, 36.0, 60.0, 75.0, 90.0, 118.0, 135.0, 145.0];
        let asked = places.into_iter().filter(|place| *place <= farthest_m);
        let spreads: Vec<_> = asked.map(|loc_y_m| spread_m(locator, loc_y_m)).collect();
        println!("{method}: {spreads:.2?}");
        assert!(
            spreads.is_sorted_by(|near, far| near * 1.1 < *far),
            "{method}: {spreads:?}"
        );
    }
}

#[test]
fn on_the_ground_uncertainty_grows_with_every_metre_up_to_the_greatest_range() {
    let places = (8..=145).map(f64::from);
    let spreads: Vec<_> = places
        .map(|loc_y_m| spread_m(&LOCATORS[3], loc_y_m))
        .collect();
    assert!(
        spreads.is_sorted_by(|near, far| near < far),
        "{spreads:.2?}"
    );
}

#[test]
fn uncertainty_grows_with_box_noise() {
    for method in Method::ALL {
        let spreads = [0.02, 0.05, 0.1, 0.2].map(|share| {
            let noisy = LocatorOptions {
                box_noise: BoxNoise {
                    edge_px: 1.0,
                    edge_share_of_height: share,
                },
                ..options(method)
            };
            spread_m(&locator(noisy), 25.0)
        });
        println!("{method}: {spreads:.2?}");
        assert!(
            spreads.is_sorted_by(|less, more| less < more),
            "{method}: {spreads:?}"
        );
    }
}

#[test]
fn most_uncertainty_lies_along_the_ray() {
    for (locator, method) in LOCATORS.iter().zip(Method::ALL) {
        let location = locator
            .locate(&car_ahead(&CAMERA, 30.0), &Known::default())
            .expect("located");
        let covariance = location.covariance.matrix;
        assert!(
            covariance[(0, 0)] > 2.0 * covariance[(1, 1)],
            "{method}: {covariance}"
        );
    }
}

fn prior(age: Duration) -> Prior {
    let location = LOCATORS[1]
        .locate(&car_ahead(&CAMERA, 20.0), &Known::default())
        .expect("located");
    Prior {
        location,
        heading: None,
        age,
    }
}

#[test]
fn without_an_answer_a_young_location_is_held_and_an_old_one_is_not() {
    let broken = BoxPx {
        x_min: f32::NAN,
        ..car_ahead(&CAMERA, 20.0).box_px
    };
    let seen = detection("car", broken);
    for locator in LOCATORS.iter() {
        assert_eq!(locator.locate(&seen, &Known::default()), None);
        let ages = [10, 100, 400].map(Duration::from_millis);
        let held = ages.map(|age| {
            locator
                .locate(
                    &seen,
                    &Known {
                        object: Some(prior(age)),
                        ..Known::default()
                    },
                )
                .expect("held")
        });
        let spreads = held.each_ref().map(|one| one.covariance.matrix.trace());
        assert!(spreads.is_sorted_by(|young, old| young < old));
        for one in held {
            assert!(one.held);
            assert_eq!(one.position, prior(Duration::ZERO).location.position);
            assert_eq!(one.method, Method::TriangleFy);
        }
        assert_eq!(
            locator.locate(
                &seen,
                &Known {
                    object: Some(prior(Duration::from_secs(2))),
                    ..Known::default()
                }
            ),
            None
        );
    }
}

#[test]
fn a_fresh_answer_is_never_held() {
    for (locator, method) in LOCATORS.iter().zip(Method::ALL) {
        let seen = car_ahead(&CAMERA, 12.0);
        let location = locator
            .locate(
                &seen,
                &Known {
                    object: Some(prior(Duration::ZERO)),
                    ..Known::default()
                },
            )
            .expect("located");
        check(&location, method);
    }
}

#[test]
fn beyond_the_greatest_range_there_is_no_answer() {
    for method in Method::ALL {
        let short = LocatorOptions {
            max_range_m: 20.0,
            ..options(method)
        };
        assert_eq!(
            locator(short.clone()).locate(&car_ahead(&CAMERA, 40.0), &Known::default()),
            None
        );
        assert!(
            locator(short)
                .locate(&car_ahead(&CAMERA, 10.0), &Known::default())
                .is_some()
        );
    }
}

#[test]
fn the_ground_has_nothing_above_the_horizon() {
    let sky = BoxPx::new(400.0, 20.0, 440.0, 60.0).expect("a box");
    let ground = &LOCATORS[3];
    assert_eq!(
        ground.locate(&detection("car", sky), &Known::default()),
        None
    );
    let light = ground
        .locate(&detection("traffic light", sky), &Known::default())
        .expect("by triangle");
    assert_eq!(light.method, Method::TriangleFy);
}

#[test]
fn eq_2_by_fy_and_by_an_equal_measured_focal_agree() {
    let seen = car_ahead(&CAMERA, 25.0);
    let [measured, fy] = [0, 1].map(|at: usize| {
        LOCATORS[at]
            .locate(&seen, &Known::default())
            .expect("located")
    });
    assert_eq!(measured.position, fy.position);
    let expected_m = 1.5 * 985.0 / f64::from(seen.box_px.height_px());
    assert!((fy.depth_m - expected_m).abs() < 1e-9);
}

#[test]
fn a_method_without_what_it_needs_is_refused() {
    let mut bare = CAMERA.clone();
    bare.measured_focal = None;
    let refused = |camera: &RigCamera, options| {
        CameraLocator::new(camera, 0.0, options).expect_err("refused")
    };
    let no_focal = refused(&bare, LocatorOptions::new(Method::TriangleMeasuredF));
    assert!(matches!(no_focal, LocatorError::NoMeasuredFocal(_)));
    let no_table = refused(&bare, LocatorOptions::new(Method::Table));
    assert!(matches!(no_table, LocatorError::NoTable(_)));
    let pickups = LocatorOptions {
        sizes: ClassSizes::new(CarCategory::Pickup, SizeStatistic::Maximum),
        ..options(Method::Table)
    };
    assert_eq!(
        refused(&bare, pickups).to_string(),
        "the table was made for objects of 5.10 x 1.90 x 1.50 m, but class `car` is configured as \
         6.00 x 2.00 x 1.80 m: rebuild the table for that size, or leave `table` out and it is built at start"
    );
    let other = refused(&camera(465.0, 1.0, 0.5), options(Method::Table));
    assert!(matches!(other, LocatorError::Table(_)));
    let endless = LocatorOptions {
        max_range_m: f64::NAN,
        ..LocatorOptions::new(Method::Ground)
    };
    assert!(matches!(refused(&bare, endless), LocatorError::MaxRange(_)));
}

#[test]
fn a_box_that_looks_like_no_row_has_no_table_location() {
    let above = GroundPose {
        loc_x_m: 0.0,
        loc_y_m: 20.0,
        heading_rad: 0.0,
    };
    let car = silhouettes(&CAMERA).silhouette_px(&car_hull().points(crate::common::CAR), above);
    let car = car.expect("in view");
    let speck = BoxPx {
        y_min: car.y_max - 2.0,
        ..car
    };
    let table = &LOCATORS[2];
    assert!(
        table
            .locate(&detection("car", car), &Known::default())
            .is_some()
    );
    assert_eq!(
        table.locate(&detection("car", speck), &Known::default()),
        None
    );
}
