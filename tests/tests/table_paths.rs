//! A table of labelled frames against one of the calibration, on the paper's X and Y paths.

use roadwatch_camera::RigDataset;
use roadwatch_core::{Method, RigCamera};
use roadwatch_lab::{LabelledTableSpec, Truth, TruthFilter, table_from_labels};
use roadwatch_locate::LocationTable;
use roadwatch_tests::{
    Imperfections, Scenario, World, play,
    scenario::CAR_SIZE,
    scenes::{everywhere, x_path, y_path},
    world::GRID,
    write_dataset,
};

/// Directions the car points in on its path, over half a turn: front and back look alike.
const HEADINGS: u32 = 9;

/// A path of a car that points in a direction, degrees.
type CarPath = fn(f64) -> Scenario;

/// A table from the labels of a car that stood everywhere before the camera, and the camera of its dataset.
fn from_labels() -> (RigCamera, LocationTable) {
    let folder = tempfile::tempdir().expect("a folder");
    let world = World::new(everywhere(GRID.step_m, 8, 11), Imperfections::default());
    write_dataset(&world, folder.path());
    let dataset = RigDataset::open(folder.path()).expect("a dataset");
    let camera = dataset.cameras()[0].clone();
    let spec = LabelledTableSpec {
        camera: &camera,
        ground_z_m: 0.0,
        filter: &TruthFilter::default(),
        size: CAR_SIZE,
        grid: &GRID,
    };
    let truth = Truth::read(folder.path()).expect("labels");
    let (table, counts) = table_from_labels(&spec, &truth, "a test").expect("a table");
    println!("{} rows: {counts}", table.rows().len());
    println!("expected distance {:?}", table.header().expected);
    (camera, table)
}

/// Where a table puts the car of a path, frame by frame, and where it was: (found, true), metres.
fn places(scenario: &Scenario, camera: &RigCamera, table: &LocationTable) -> Vec<[[f64; 2]; 2]> {
    let world = World::new(scenario.clone(), Imperfections::default());
    let locators = vec![world.locator(camera, Method::Table, Some(table.clone()))];
    let played = play(&world, locators, 1);
    assert_eq!(played.cameras.len() as u64, scenario.frames);
    let frames = played.cameras.iter().zip(world.all_views());
    frames
        .map(|(frame, (_, view))| {
            let (found, _) = frame.single(0).expect("found on its path");
            assert_eq!(found.method, Method::Table);
            let center = view.objects[0].truth.center;
            [
                [found.position.x(), found.position.y()],
                [center.x(), center.y()],
            ]
        })
        .collect()
}

fn p90(distances: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = distances.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() * 9 / 10]
}

fn apart([a, b]: [[f64; 2]; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn on_the_x_and_the_y_path_both_tables_are_within_one_grid_step() {
    let (camera, labelled) = from_labels();
    let world = World::new(y_path(0.0), Imperfections::default());
    let calibrated = world.table(&camera);
    println!("{} rows from calibration", calibrated.rows().len());
    println!("expected distance {:?}", calibrated.header().expected);
    let paths: [(&str, CarPath); 2] = [("X path", x_path), ("Y path", y_path)];
    for (name, path) in paths {
        let on_all = |table: &LocationTable| -> Vec<_> {
            let headings = (0..HEADINGS).map(|at| 180.0 * f64::from(at) / f64::from(HEADINGS));
            headings
                .flat_map(|heading| places(&path(heading), &camera, table))
                .collect()
        };
        let (from_labels, from_calibration) = (on_all(&labelled), on_all(&calibrated));
        let labels_m = p90(from_labels.iter().copied().map(apart));
        let calibration_m = p90(from_calibration.iter().copied().map(apart));
        let pairs = from_labels.iter().zip(&from_calibration);
        let between_m = p90(pairs.map(|(a, b)| apart([a[0], b[0]])));
        println!(
            "{name}, {} places: p90 from labels {labels_m:.2} m, from calibration {calibration_m:.2} m, \
             between them {between_m:.2} m",
            from_labels.len()
        );
        assert!(labels_m <= GRID.step_m, "{name}: {labels_m}");
        assert!(calibration_m <= GRID.step_m, "{name}: {calibration_m}");
    }
}
