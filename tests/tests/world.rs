//! The world is what it says: cameras see what is before them, and labels say what they see.

use roadwatch_camera::RigDataset;
use roadwatch_core::BoxPx;
use roadwatch_lab::{Truth, TruthObject};
use roadwatch_tests::{
    Actor, Imperfections, MountError, Path, World,
    scenes::{before_one_camera, spread_cars, street},
    write_dataset,
};

/// The box of one car that stands 20 m before the camera, so far to the left, metres.
fn seen_px(left_m: f64, mount: MountError) -> BoxPx {
    let car = Actor::car(Path::standing(20.85, left_m, 0.0));
    let imperfections = Imperfections {
        mount,
        ..Imperfections::default()
    };
    let world = World::new(before_one_camera(vec![car], 1), imperfections);
    let (_, view) = world.all_views().next().expect("a view");
    view.objects[0].silhouette_px
}

#[test]
fn a_car_ahead_is_at_the_principal_column_and_one_to_the_left_is_left_of_it() {
    let exact = MountError::default();
    assert!((seen_px(0.0, exact).center().x - 482.0).abs() < 0.01);
    // 985 px of focal length times 4 m of 20 m.
    assert!((seen_px(4.0, exact).center().x - (482.0 - 197.0)).abs() < 15.0);
}

#[test]
fn cameras_that_sit_otherwise_see_otherwise() {
    let exact = MountError::default();
    let degree_px = 985.0 * 1.0_f64.to_radians().tan();
    let down = MountError {
        pitch_deg: 1.0,
        ..exact
    };
    let right = MountError {
        yaw_deg: 1.0,
        ..exact
    };
    let clockwise = MountError {
        roll_deg: 2.0,
        ..exact
    };
    let moved = |left_m, mount| seen_px(left_m, mount).center() - seen_px(left_m, exact).center();
    assert!((moved(0.0, down).y + degree_px).abs() < 0.5);
    assert!((moved(0.0, right).x + degree_px).abs() < 0.5);
    assert!(moved(4.0, clockwise).y > 5.0 && moved(-4.0, clockwise).y < -5.0);
    let higher = MountError { up_m: 0.5, ..exact };
    assert!(moved(0.0, higher).y > 20.0);
}

#[test]
fn silhouettes_lie_inside_their_cuboids() {
    let world = World::new(street(20), Imperfections::default());
    let objects = world.all_views().flat_map(|(_, view)| &view.objects);
    let mut count = 0;
    for seen in objects {
        let (inner, outer) = (seen.silhouette_px, seen.truth.box_px.expect("a label"));
        assert!(inner.x_min >= outer.x_min && inner.x_max <= outer.x_max);
        assert!(inner.y_min >= outer.y_min && inner.y_max <= outer.y_max);
        assert!((0.0..=1.0).contains(&seen.truth.occluded));
        assert!((0.0..=1.0).contains(&seen.truth.truncated));
        count += 1;
    }
    assert!(count > 400, "{count}");
}

#[test]
fn the_nearer_of_two_hides_the_other() {
    let cars = vec![
        Actor::car(Path::standing(30.0, 0.0, 0.0)),
        Actor::car(Path::standing(15.0, 0.0, 0.0)),
    ];
    let world = World::new(before_one_camera(cars, 1), Imperfections::default());
    let (_, view) = world.all_views().next().expect("a view");
    let hidden: Vec<_> = view
        .objects
        .iter()
        .map(|seen| (seen.actor, seen.truth.occluded))
        .collect();
    assert_eq!(hidden[0], (1, 0.0));
    assert_eq!(hidden[1].0, 0);
    assert!(hidden[1].1 > 0.5, "{hidden:?}");
}

#[test]
fn what_is_written_as_a_dataset_is_read_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let world = World::new(spread_cars(3), Imperfections::default());
    write_dataset(&world, folder.path());
    let dataset = RigDataset::open(folder.path()).expect("a dataset");
    let truth = Truth::read(folder.path()).expect("labels");
    assert_eq!(dataset.frames().len(), 3);
    let rig = &world.scenario().rig;
    for (camera, view) in world.all_views() {
        let frame = &dataset.frames()[view.frame as usize];
        assert_eq!(frame.stamps[camera.index()], Some(view.captured_at));
        let read = truth.objects(view.frame, rig.camera(camera).name.as_str());
        assert_eq!(read.len(), view.objects.len());
        for (read, seen) in read.iter().zip(&view.objects) {
            let written = &seen.truth;
            // The last digit of a double may change on its way through JSON.
            assert!((read.center.coords - written.center.coords).norm() < 1e-9);
            let yaws = read.yaw_rad.zip(written.yaw_rad);
            assert!(yaws.is_some_and(|(read, written)| (read - written).abs() < 1e-9));
            let (center, yaw_rad) = (written.center, written.yaw_rad);
            assert_eq!(
                TruthObject {
                    center,
                    yaw_rad,
                    ..read.clone()
                },
                *written
            );
        }
    }
    for (read, believed) in dataset.cameras().iter().zip(rig.cameras()) {
        assert_eq!(read.model, believed.model);
        let [read, believed] = [read, believed].map(|camera| camera.base_from_optical.isometry);
        assert!((read.translation.vector - believed.translation.vector).norm() < 1e-12);
        assert!(read.rotation.angle_to(&believed.rotation) < 1e-7);
    }
}
