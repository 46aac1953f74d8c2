//! `roadwatch calibrate rotation` and what `rotation evaluate` shows of it, on rows whose truth is exact.

mod support;

use roadwatch_core::space::Point;
use roadwatch_rotate::{Forest, ForestOptions, LabelledRow, RayAngle, Row, RowTable, Yaw};
use serde_json::Value;
use std::{f64::consts::TAU, fs, path::Path};
use support::{demo, refusal, root, run_well, stdout, write};

/// An object that shows four components, each where it would be on a turning drum.
fn row(loc_x_m: f64, loc_y_m: f64, heading_rad: f64) -> LabelledRow {
    let ray = RayAngle::towards(loc_y_m, -loc_x_m);
    let angle = Yaw::new(heading_rad).seen_along(ray);
    let column = |phase: f64| {
        let turned = angle.radians() + phase;
        let seen = turned.cos() > 0.0;
        (
            seen.then_some(0.5 + 0.45 * turned.sin()),
            turned.cos().max(0.0) as f32,
        )
    };
    LabelledRow {
        row: Row {
            aspect: 0.6,
            components: (0..4)
                .map(|side| column(f64::from(side) * TAU / 4.0))
                .collect(),
            facing: Vec::new(),
        },
        angle,
        place: Point::new(loc_y_m, -loc_x_m, 0.0),
        box_height_px: 80.0,
    }
}

fn table(rows: impl Iterator<Item = LabelledRow>) -> RowTable {
    RowTable {
        components: ["left", "front", "right", "rear"]
            .map(str::to_owned)
            .to_vec(),
        facing_bins: 0,
        rows: rows.collect(),
    }
}

/// Rows all over the ground, three cars in a row, and a forest grown on others.
fn files(folder: &Path) -> [String; 3] {
    let file = |name: &str| folder.join(name).display().to_string();
    let (rows, three, forest) = (file("rows.csv"), file("three.csv"), file("a.forest"));
    let spread = (0..1500).map(f64::from);
    let anywhere = |seed: f64| {
        let share = |factor: f64| ((at_golden(seed) * factor).fract(), factor);
        let ((x, _), (y, _), (turn, _)) = (share(1.0), share(7.0), share(31.0));
        row(30.0 * x - 15.0, 20.0 + 20.0 * y, TAU * turn)
    };
    table(spread.clone().map(anywhere))
        .write(Path::new(&rows))
        .expect("written");
    let grown = table(spread.map(|at| anywhere(at + 0.5)));
    let grown = Forest::grow(&grown, ForestOptions::default(), |_, _| ()).expect("a forest");
    grown.write(Path::new(&forest)).expect("written");
    let cars = [-8.0, 0.0, 8.0].map(|loc_x_m| row(loc_x_m, 30.0, 0.0));
    table(cars.into_iter())
        .write(Path::new(&three))
        .expect("written");
    [rows, three, forest]
}

/// Evenly spread numbers without a pattern.
fn at_golden(step: f64) -> f64 {
    step * 0.618_033_988_749_895
}

#[test]
fn both_calibrations_bring_three_cars_in_a_row_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let [rows, three, forest] = files(folder.path());
    let file = |name: &str| folder.path().join(name).display().to_string();
    let (curve, picture, report) = (file("curve.json"), file("curve.png"), file("report"));
    let calibrate = ["calibrate", "rotation", &rows, "--forest", &forest];
    let options = ["-o", &curve, "--picture", &picture];
    let said = stdout(&run_well(&[&calibrate[..], &options].concat()));
    assert!(said.contains("rows 30 m ahead"), "{said}");
    assert!(fs::metadata(&picture).expect("a picture").len() > 10_000);
    let evaluate = ["rotation", "evaluate", &rows, &forest, "--car-row", &three];
    let options = ["--curve", &curve, "--report", &report, "--json"];
    let output = run_well(&[&evaluate[..], &options].concat());
    let json: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let spread = &json["car_rows"]["a"][0]["spread_deg"];
    let [before, by_curve, by_ray] = [0, 1, 2].map(|at| spread[at].as_f64().expect("degrees"));
    // Two arc tangents of 8 / 30.
    assert!((before - 29.9).abs() < 3.0, "{spread}");
    assert!(by_curve < 4.0 && by_ray < 4.0, "{spread}");
    assert!(fs::metadata(Path::new(&report).join("car_rows.png")).is_ok());
}

#[test]
fn rows_and_curves_that_cannot_be_used_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let [rows, _, forest] = files(folder.path());
    let few = [
        "calibrate",
        "rotation",
        &rows,
        "--forest",
        &forest,
        "--loc-y-m",
        "90",
    ];
    let said = refusal(&few);
    assert!(
        said.contains("0 rows are 90 m ahead, within 5 m; 20 or more make a curve"),
        "{said}"
    );
    let foreign = root()
        .join("models/roadwatch_rotation.forest")
        .display()
        .to_string();
    let said = refusal(&["calibrate", "rotation", &rows, "--forest", &foreign]);
    assert!(
        said.contains("was grown on rows of another model"),
        "{said}"
    );
    // In the daemon.
    let garbage = write(folder.path(), "curve.json", "{\"loc_y_m\": 30}");
    let config = demo(folder.path(), |shipped| {
        format!("{shipped}\nposition_curve = \"{garbage}\"\n")
    });
    let said = refusal(&["check", &config]);
    assert!(
        said.contains("rotation.position_curve") && said.contains("is not a curve of"),
        "{said}"
    );
}
