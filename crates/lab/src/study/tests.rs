//! Studies of drives made by hand: every vehicle is an upright plate, for which eq. 2 is exact.

use super::*;
use serde_json::json;
use std::{fs, path::Path};
use tempfile::TempDir;

/// The paper's second F, so that one of the four is right.
const FOCAL_PX: f64 = 1375.0;
const PLATE_M: f64 = 1.5;

fn rig(cameras: &[&str]) -> String {
    let camera = |name: &&str| {
        format!(
            "[[camera]]\nname = \"{name}\"\nwidth = 1920\nheight = 1080\nfx = {FOCAL_PX}\nfy = {FOCAL_PX}\ncx = 959.5\n\
             cy = 539.5\nposition_m = [0.0, 0.0, 1.6]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n"
        )
    };
    cameras.iter().map(camera).collect()
}

/// A plate across the view, `(ahead, left)` of the camera.
fn plate(id: &str, (x, y): (f64, f64)) -> serde_json::Value {
    let column = |left_m: f64| 960.0 - FOCAL_PX * left_m / x;
    let row = |up_m: f64| 540.0 - FOCAL_PX * (up_m - 1.6) / x;
    json!({
        "id": id, "class": "car", "label": "plate", "truncated": 0.0, "occluded": 0.0,
        "box_px": [column(y + 0.9), row(PLATE_M), column(y - 0.9), row(0.0)],
        "center_base_m": [x, y, PLATE_M / 2.0],
        "size_lwh_m": [4.5, 1.8, PLATE_M], "yaw_base_rad": 0.0,
    })
}

/// Vehicles of a frame: id, and place as `(ahead, left)` of the camera.
type Frame = Vec<(&'static str, (f64, f64))>;

/// A dataset with these vehicles in each frame.
fn dataset(frames: &[Frame]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).expect(name);
    write("rig.toml", rig(&["camera"]));
    fs::create_dir(folder.path().join("camera")).expect("a folder");
    let numbered = || frames.iter().enumerate();
    let stamp = |at: usize| {
        format!(
            "{{\"frame\": {at}, \"stamp\": {{\"camera\": {}.5}}}}\n",
            at + 1
        )
    };
    write(
        "frames.jsonl",
        numbered().map(|(at, _)| stamp(at)).collect(),
    );
    let line = |(at, seen): (usize, &Frame)| {
        let objects: Vec<_> = seen.iter().map(|(id, place)| plate(id, *place)).collect();
        let line = json!({"frame": at, "camera": "camera", "objects": objects});
        format!("{line}\n")
    };
    write("truth.jsonl", numbered().map(line).collect());
    folder
}

fn one(places: impl IntoIterator<Item = (f64, f64)>) -> TempDir {
    let frames = places.into_iter().map(|place| vec![("1", place)]);
    dataset(&frames.collect::<Vec<_>>())
}

fn y_path() -> TempDir {
    one((8..=52).step_by(4).map(|x| (f64::from(x), 0.0)))
}

fn x_path() -> TempDir {
    one((-8..=8).step_by(2).map(|y| (30.0, f64::from(y))))
}

fn grid() -> TempDir {
    let cells = [10.0, 20.0, 30.0, 40.0].map(|x| [-3.0, 0.0, 3.0].map(|y| (x, y)));
    one(cells.into_iter().flatten())
}

fn vehicles() -> TempDir {
    dataset(&[
        vec![("1", (12.0, -2.0)), ("2", (25.0, 4.0))],
        vec![("1", (33.0, 6.0)), ("2", (18.0, -3.0))],
    ])
}

fn scene(folder: &TempDir) -> StudyScene {
    let opened = StudyScene::open(folder.path()).expect("a scene");
    let seen = seen_by_labels(&opened);
    StudyScene {
        seen,
        ..opened.scene
    }
}

fn studied(folders: &[&TempDir]) -> Study {
    let scenes = folders.iter().map(|folder| scene(folder)).collect();
    study(scenes, BoxSource::Truth, |_| ()).expect("a study")
}

fn near(found: Option<f64>, expected: f64) -> bool {
    (found.unwrap_or(f64::NAN) - expected).abs() < 1e-4
}

#[test]
fn the_f_values_are_the_published_points() {
    let values = PUBLISHED.map(|size_m| focal::published_focal(size_m).focal_px);
    let printed = [1964.28, 1375.0, 1774.19, 1617.64];
    for (value, printed) in values.into_iter().zip(printed) {
        assert!((value - printed).abs() < 0.01, "{value} {printed}");
    }
}

#[test]
fn what_moves_how_is_told_by_the_labels() {
    let shapes = [x_path(), y_path(), grid(), vehicles()].map(|folder| scene(&folder).shape);
    let expected = [Shape::XPath, Shape::YPath, Shape::Grid, Shape::Vehicles];
    assert_eq!(shapes, expected);
}

#[test]
fn errors_of_f_and_of_the_height_cost_what_eq_2_says() {
    let (grid, y_path) = (grid(), y_path());
    let study = studied(&[&grid, &y_path]);
    let measured = study.measured.expect("the Y path passes 50 m");
    assert!((measured.focal.focal_px - FOCAL_PX).abs() < 0.01);
    let focal = study.focal.expect("a grid");
    let published = |at: usize| focal.published[at].point;
    assert!(near(published(1).accuracy, 1.0) && near(published(1).coverage_90, 1.0));
    // W of 1.4 m instead of 2.0 makes F, and with it every distance, 2.0 / 1.4 as large.
    assert!(near(published(0).accuracy, 1.0 - 0.6 / 1.4));
    assert!(near(published(0).coverage_90, 0.0));
    let at = |curve, error_m| FocalStudy::at(curve, error_m).and_then(|point| point.accuracy);
    assert!(near(at(&focal.in_distance, 0.4), 1.0 - 0.4 / PLATE_M));
    assert!(near(at(&focal.in_distance, -0.2), 1.0 - 0.2 / PLATE_M));
    assert!(near(at(&focal.in_focal, -0.2), 1.0 - 0.2 / 1.3));
    assert!(near(at(&focal.in_focal, 0.4), 1.0 - 0.4 / 1.9));
    assert_eq!(focal.published[1].heat.len(), 12);
}

#[test]
fn the_real_height_makes_no_error_on_the_paths_and_the_best_constant_is_found() {
    let (x, y, several) = (x_path(), y_path(), vehicles());
    let study = studied(&[&y, &x, &several]);
    let shapes: Vec<_> = study.paths.iter().map(|path| path.shape).collect();
    assert_eq!(shapes, [Shape::XPath, Shape::YPath]);
    let figures = path_figures(study.paths.iter());
    let (name, known) = figures[0];
    assert_eq!(
        (name, known.distance.n, known.major_errors),
        ("real_height", 21, 0)
    );
    assert_eq!((known.near, known.major_errors_near), (5, 0));
    assert!(near(known.distance.mean_relative_error, 0.0) && near(known.coverage_90, 1.0));
    let groups = study.vehicles.expect("vehicles").groups;
    assert_eq!(groups[0].n, 4);
    assert!((groups[0].best_height_m - PLATE_M).abs() < 1e-9);
}

#[test]
fn the_report_is_the_same_every_time_and_says_nothing_of_what_is_not_there() {
    let folders = [x_path(), y_path(), grid(), vehicles()];
    let study = studied(&folders.each_ref());
    let (first, second) = (
        tempfile::tempdir().expect("a"),
        tempfile::tempdir().expect("b"),
    );
    let files = study.write(first.path()).expect("written");
    assert_eq!(study.write(second.path()).expect("written"), files);
    assert_eq!(files.len(), 7, "{files:?}");
    let read = |folder: &Path, file: &str| fs::read(folder.join(file)).expect("a file");
    for file in files {
        let bytes = read(first.path(), file);
        assert_eq!(bytes, read(second.path(), file), "{file}");
        // A blank picture packs into a few kilobytes.
        assert!(!file.ends_with(".png") || bytes.len() > 10_000, "{file}");
    }
    let part = studied(&[&folders[0]]);
    let third = tempfile::tempdir().expect("a folder");
    let files = part.write(third.path()).expect("written");
    assert_eq!(files, ["study.json", "study.md", "paths.png"]);
    let json = part.to_json();
    assert!(
        json["focal"].is_null() && json["vehicles"].is_null() && json["measured_focal"].is_null()
    );
    assert!(json["paths"]["x_path"]["triangle_measured_f"].is_null());
    assert!(json["paths"]["x_path"]["fused"]["distance"]["n"] == 9);
}

fn refusal(folder: &Path) -> String {
    let error = StudyScene::open(folder).expect_err("refused");
    roadwatch_core::error_chain(&error)
}

#[test]
fn datasets_that_no_study_fits_are_refused_with_what_to_do() {
    let short = one([(20.0, 0.0), (21.0, 0.5)]);
    let said = refusal(short.path());
    assert!(
        said.contains("1.0 m along") && said.contains("0.5 m aside"),
        "{said}"
    );
    let nothing = dataset(&[vec![]]);
    assert!(refusal(nothing.path()).contains("paper_x_path"));
    let without = y_path();
    fs::remove_file(without.path().join("truth.jsonl")).expect("removed");
    let said = refusal(without.path());
    assert!(
        said.contains("needs the truth") && said.contains("truth.jsonl"),
        "{said}"
    );
    let two = y_path();
    fs::write(two.path().join("rig.toml"), rig(&["camera", "other"])).expect("written");
    fs::create_dir(two.path().join("other")).expect("a folder");
    let frame = r#"{"frame": 0, "stamp": {"camera": 1.5, "other": 1.5}}"#;
    fs::write(two.path().join("frames.jsonl"), frame).expect("written");
    let said = refusal(two.path());
    assert!(said.contains("2 cameras"), "{said}");
    let nowhere = short.path().join("nowhere");
    assert!(refusal(&nowhere).contains("is no rig dataset"));
}
