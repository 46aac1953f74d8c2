//! The fused estimate: exact where the box is, honest where it is not.

use crate::common::{Random, camera, car_hull, detection, silhouettes};
use nalgebra::Vector2;
use roadwatch_core::{
    BoxPx, Heading, KeptHeading, Known, Location, Locator as _, Method, Prior, RigCamera, SizeLwh,
    space::{BaseLink, Point},
};
use roadwatch_locate::{BoxNoise, CameraLocator, GroundPose, LocatorOptions};
use std::{f64::consts::PI, time::Duration};

/// What `ClassSizes::expected` says of cars.
const EXPECTED: SizeLwh = SizeLwh {
    length_m: 4.6,
    width_m: 1.85,
    height_m: 1.6,
};
const SPREAD: SizeLwh = SizeLwh {
    length_m: 0.43,
    width_m: 0.10,
    height_m: 0.12,
};
/// Of the ground's height under an object, metres, and with each metre of distance.
const GROUND_STD: (f64, f64) = (0.05, 0.014);

fn fused(camera: &RigCamera) -> CameraLocator {
    CameraLocator::new(camera, 0.0, LocatorOptions::new(Method::Fused)).expect("any camera")
}

/// A car somewhere, with its box.
struct Car {
    place: Point<BaseLink>,
    yaw_rad: f64,
    box_px: BoxPx,
}

/// A car of that size at `range_m` ahead, its ground `ground_m` higher than the camera's; `None` when it is
/// not whole in the image.
fn car(camera: &RigCamera, (range_m, azimuth_rad): (f64, f64), yaw_rad: f64) -> Option<Car> {
    sized_car(camera, (range_m, azimuth_rad), yaw_rad, (EXPECTED, 0.0))
}

fn sized_car(
    camera: &RigCamera,
    (range_m, azimuth_rad): (f64, f64),
    yaw_rad: f64,
    (size, ground_m): (SizeLwh, f64),
) -> Option<Car> {
    let raised = |mut point: nalgebra::Vector3<f64>| {
        point.z += ground_m;
        point
    };
    let points: Vec<_> = car_hull().points(size).into_iter().map(raised).collect();
    let pose = GroundPose {
        loc_x_m: range_m * azimuth_rad.sin(),
        loc_y_m: range_m * azimuth_rad.cos(),
        heading_rad: yaw_rad,
    };
    let over_ground = silhouettes(camera);
    let whole = over_ground.silhouette_px(&points, pose)?;
    let (box_px, share) = over_ground.clip(whole)?;
    let foot = camera.base_from_optical.origin();
    (share >= 1.0).then(|| Car {
        place: Point::new(foot.x() + pose.loc_y_m, foot.y() - pose.loc_x_m, 0.8),
        yaw_rad,
        box_px,
    })
}

fn off_m(location: &Location, car: &Car) -> f64 {
    (location.position.coords - car.place.coords).xy().norm()
}

/// The angle between two headings of something that looks alike from both ends, radians.
fn apart_rad(a: f64, b: f64) -> f64 {
    let turns = (a - b) / PI;
    (turns - turns.round()).abs() * PI
}

fn nearest_heading_rad(location: &Location, yaw_rad: f64) -> f64 {
    let all = location.headings.iter();
    let apart = all.map(|candidate| apart_rad(candidate.heading.yaw_rad, yaw_rad));
    apart.fold(f64::MAX, f64::min)
}

#[test]
fn a_car_of_the_expected_size_is_found_where_it_stands_in_any_heading() {
    let camera = camera(700.0, 1.0, 0.5);
    let locator = fused(&camera);
    let mut random = Random(1);
    let (mut off, mut turned) = (Vec::new(), Vec::new());
    while off.len() < 500 {
        let range_m = random.between(8.0, 45.0);
        let yaw_rad = random.between(0.0, PI);
        let Some(car) = car(&camera, (range_m, random.between(-0.5, 0.5)), yaw_rad) else {
            continue;
        };
        let location = locator
            .locate(&detection("car", car.box_px), &Known::default())
            .expect("a place");
        off.push(off_m(&location, &car) / range_m);
        turned.push(nearest_heading_rad(&location, yaw_rad).to_degrees());
        let weights: f64 = location.headings.iter().map(|of| of.weight).sum();
        assert!((weights - 1.0).abs() < 1e-9 && location.headings.len() <= 4);
    }
    off.sort_by(f64::total_cmp);
    turned.sort_by(f64::total_cmp);
    println!("p50 {:.3}, p90 {:.3} of the distance", off[250], off[450]);
    println!(
        "heading p50 {:.1}, p90 {:.1} degrees",
        turned[250], turned[450]
    );
    assert!(off[250] < 0.02 && off[450] < 0.05);
    assert!(turned[250] < 6.0);
}

#[test]
fn the_covariance_is_what_the_errors_are() {
    let camera = camera(700.0, 1.0, 0.0);
    let locator = fused(&camera);
    let mut random = Random(2);
    let (mut radial, mut tangential, mut count) = (0.0, 0.0, 0.0);
    while count < 2000.0 {
        let at = (random.between(8.0, 50.0), random.between(-0.5, 0.5));
        let size = SizeLwh {
            length_m: EXPECTED.length_m + SPREAD.length_m * random.normal(),
            width_m: EXPECTED.width_m + SPREAD.width_m * random.normal(),
            height_m: EXPECTED.height_m + SPREAD.height_m * random.normal(),
        };
        let ground_m = random.normal() * GROUND_STD.0.hypot(GROUND_STD.1 * at.0);
        let yaw_rad = random.between(0.0, PI);
        let Some(car) = sized_car(&camera, at, yaw_rad, (size, ground_m)) else {
            continue;
        };
        let std_px = BoxNoise::default().edge_std_px(&car.box_px) as f32;
        let mut stray = || random.normal() as f32 * std_px;
        let BoxPx {
            x_min,
            y_min,
            x_max,
            y_max,
        } = car.box_px;
        let edges = [
            x_min + stray(),
            y_min + stray(),
            x_max + stray(),
            y_max + stray(),
        ];
        let seen = hidden(edges, &mut random);
        let Some(location) =
            seen.and_then(|seen| locator.locate(&detection("car", seen), &Known::default()))
        else {
            continue;
        };
        let error = (location.position.coords - car.place.coords).xy();
        let ray = (car.place.coords - camera.base_from_optical.origin().coords)
            .xy()
            .normalize();
        let covariance = location
            .covariance
            .matrix
            .fixed_view::<2, 2>(0, 0)
            .into_owned();
        let nees =
            |along: Vector2<f64>| error.dot(&along).powi(2) / along.dot(&(covariance * along));
        radial += nees(ray);
        tangential += nees(Vector2::new(-ray.y, ray.x));
        count += 1.0;
    }
    println!(
        "NEES radial {:.2}, tangential {:.2}",
        radial / count,
        tangential / count
    );
    assert!((0.7..1.3).contains(&(radial / count)));
    assert!((0.7..1.5).contains(&(tangential / count)));
}

/// The box with one side cut as often as the estimator expects.
fn hidden([x_min, y_min, x_max, y_max]: [f32; 4], random: &mut Random) -> Option<BoxPx> {
    let cut = (x_max - x_min) * random.between(0.0, 0.33) as f32;
    match random.unit() {
        less if less < 0.1 => BoxPx::new(x_min + cut, y_min, x_max, y_max),
        less if less < 0.2 => BoxPx::new(x_min, y_min, x_max - cut, y_max),
        _ => BoxPx::new(x_min, y_min, x_max, y_max),
    }
}

#[test]
fn a_hidden_foot_is_recognised_by_disagreement() {
    let camera = camera(700.0, 1.0, 0.0);
    let at =
        |method| CameraLocator::new(&camera, 0.0, LocatorOptions::new(method)).expect("any camera");
    let car = car(&camera, (15.0, 0.0), 1.2).expect("in view");
    let missing = car.box_px.height_px() * 0.3;
    let box_px = BoxPx {
        y_max: car.box_px.y_max - missing,
        ..car.box_px
    };
    let off = |method| {
        let location = at(method)
            .locate(&detection("car", box_px), &Known::default())
            .expect("a place");
        off_m(&location, &car)
    };
    let (fused_m, ground_m, triangle_m) = (
        off(Method::Fused),
        off(Method::Ground),
        off(Method::TriangleFy),
    );
    println!("fused {fused_m:.1} m, ground {ground_m:.1} m, triangle {triangle_m:.1} m");
    assert!(fused_m < 0.6 * ground_m.min(triangle_m));
}

#[test]
fn what_the_border_cuts_off_is_not_taken_for_the_object() {
    let camera = camera(700.0, 1.0, 0.0);
    let locator = fused(&camera);
    let foot = camera.base_from_optical.origin();
    let over_ground = silhouettes(&camera);
    let pose = GroundPose {
        loc_x_m: 6.4,
        loc_y_m: 9.0,
        heading_rad: 0.0,
    };
    let whole = over_ground
        .silhouette_px(&car_hull().points(EXPECTED), pose)
        .expect("ahead");
    let (box_px, share) = over_ground.clip(whole).expect("partly in view");
    assert!((0.3..0.8).contains(&share), "{share}");
    let location = locator
        .locate(&detection("car", box_px), &Known::default())
        .expect("a place");
    let error = Vector2::new(
        foot.x() + 9.0 - location.position.x(),
        foot.y() - 6.4 - location.position.y(),
    );
    let std_m = location
        .covariance
        .matrix
        .fixed_view::<2, 2>(0, 0)
        .trace()
        .sqrt();
    println!("off by {:.2} m, deviation {std_m:.2} m", error.norm());
    assert!(error.norm() < 2.0 * std_m && std_m > 0.5);
}

#[test]
fn a_box_over_the_whole_image_says_nothing() {
    let locator = fused(&camera(700.0, 1.0, 0.0));
    let everything = BoxPx::new(0.0, 0.0, 960.0, 540.0).expect("a box");
    assert_eq!(
        locator.locate(&detection("car", everything), &Known::default()),
        None
    );
}

#[test]
fn a_known_heading_settles_which_of_the_possible_ones_it_is() {
    let camera = camera(700.0, 1.0, 0.0);
    let locator = fused(&camera);
    let car = car(&camera, (20.0, 0.1), 0.7).expect("in view");
    let seen = detection("car", car.box_px);
    let alone = locator.locate(&seen, &Known::default()).expect("a place");
    let prior = Prior {
        location: alone.clone(),
        heading: Some(KeptHeading {
            heading: Heading {
                yaw_rad: car.yaw_rad,
                std_dev_rad: 0.15,
                flip_probability: 0.0,
            },
            age: Duration::from_millis(100),
        }),
        age: Duration::from_millis(100),
    };
    let known = locator
        .locate(
            &seen,
            &Known {
                object: Some(prior),
                ..Known::default()
            },
        )
        .expect("a place");
    let weight = |location: &Location| {
        let near = location.headings.iter();
        let near = near.filter(|of| apart_rad(of.heading.yaw_rad, car.yaw_rad) < 0.3);
        near.map(|of| of.weight).sum::<f64>()
    };
    println!(
        "{:.2} alone, {:.2} with the prior",
        weight(&alone),
        weight(&known)
    );
    assert!(weight(&known) > 0.8 && weight(&known) > weight(&alone));
}

#[test]
fn a_greatest_range_shorter_than_the_object_places_nothing() {
    let camera = camera(700.0, 1.0, 0.0);
    let options = LocatorOptions {
        max_range_m: 1.0,
        ..LocatorOptions::new(Method::Fused)
    };
    let locator = CameraLocator::new(&camera, 0.0, options).expect("any camera");
    let car = car(&camera, (15.0, 0.0), 1.2).expect("in view");
    assert_eq!(
        locator.locate(&detection("car", car.box_px), &Known::default()),
        None
    );
    assert_eq!(
        locator.locate(&detection("bus", car.box_px), &Known::default()),
        None
    );
}
