//! `roadwatch table build --from-dataset`, as somebody types it.

mod support;

use std::{fs, path::Path};
use support::{run_well, stderr, stdout};

const RIG: &str = r#"
[[camera]]
name = "front"
width = 960
height = 540
fx = 985.0
fy = 985.0
cx = 485.0
cy = 241.6
position_m = [0.85, 0.0, 2.18]
orientation_wxyz = [0.5, -0.5, 0.5, -0.5]
"#;

/// One labelled car 21 m ahead of the vehicle; `more` adds keys.
fn label(class: &str, more: &str) -> String {
    format!(
        r#"{{"frame": 0, "camera": "front", "objects": [{{"id": "a", "class": "{class}", {more}
           "box_px": [420, 246, 520, 330], "truncated": 0.0, "occluded": 0.0,
           "center_base_m": [21.0, 0.5, 0.75]}}]}}"#
    )
    .replace('\n', " ")
}

/// Writes a rig dataset without images.
fn dataset(folder: &Path, truth: &str) -> String {
    fs::write(folder.join("rig.toml"), RIG).expect("rig");
    fs::write(folder.join("truth.jsonl"), truth).expect("truth");
    folder.display().to_string()
}

fn refusal(arguments: &[&str]) -> String {
    support::refusal(&[&["table", "build"], arguments].concat())
}

#[test]
fn labels_become_rows_and_the_table_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let seen = r#""silhouette_px": [424, 256, 516, 328], "visible_px": 5000,"#;
    let data = dataset(folder.path(), &label("car", seen));
    let table = folder.path().join("front.rwtable").display().to_string();
    let csv = folder.path().join("rows.csv").display().to_string();
    let build = [
        "table",
        "build",
        "--from-dataset",
        &data,
        "--camera",
        "front",
        "-o",
        &table,
    ];
    let built = run_well(&build);
    assert!(stdout(&built).contains("1 rows for camera front"));
    assert!(stderr(&built).contains("1 labelled, left out 0 of another class"));
    let bytes = fs::read(&table).expect("the table");
    run_well(&build);
    assert_eq!(bytes, fs::read(&table).expect("written again"));
    let inspected = stdout(&run_well(&["table", "inspect", &table, "--export", &csv]));
    assert!(
        inspected.contains(&format!("labels of {data}: 1 boxes of silhouettes")),
        "{inspected}"
    );
    let rows = fs::read_to_string(&csv).expect("CSV");
    let row = rows.lines().nth(1).expect("a row");
    assert_eq!(row, "6624,469.5,291.5,20.15,-0.5,20.15,2358");
}

#[test]
fn what_gives_no_table_is_said_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = dataset(folder.path(), &label("car", ""));
    let table = folder.path().join("front.rwtable").display().to_string();
    let build = ["--from-dataset", &data, "-o", &table, "--camera"];
    let with = |more: &[&str]| refusal(&[&build, more].concat());
    assert!(with(&["rear"]).contains("no camera `rear`; the rig has front"));
    let buses = with(&["front", "--class", "bus"]);
    assert!(
        buses.contains("no labelled object of camera `front` is usable: 1 labelled, left out 1 of another class"),
        "{buses}"
    );
    let high = with(&["front", "--min-height-px", "200"]);
    assert!(high.contains("1 too small"), "{high}");
    let near = with(&["front", "--farthest-m", "10"]);
    assert!(near.contains("1 off the grid"), "{near}");
    fs::remove_file(folder.path().join("truth.jsonl")).expect("removed");
    assert!(with(&["front"]).contains("cannot read the labels"));
    assert!(!Path::new(&table).exists());
}

#[test]
fn a_dataset_goes_with_no_other_origin_and_its_options_with_nothing_else() {
    let base = ["--camera", "front", "-o", "never.rwtable"];
    let with = |more: &[&str]| refusal(&[&base, more].concat());
    assert!(with(&[]).contains("--rig"));
    assert!(with(&["--from-dataset", "a", "--import", "b"]).contains("cannot be used with"));
    assert!(with(&["--from-dataset", "a", "--rig", "b"]).contains("cannot be used with"));
    let filtered = with(&["--rig", "a", "--max-occluded", "0.1"]);
    assert!(filtered.contains("cannot be used with"), "{filtered}");
}

#[test]
fn a_folder_in_the_tables_place_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = dataset(folder.path(), &label("car", ""));
    let text = refusal(&["--from-dataset", &data, "--camera", "front", "-o", &data]);
    assert!(text.contains(&data), "{text}");
}
