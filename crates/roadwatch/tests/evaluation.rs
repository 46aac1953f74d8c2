//! `roadwatch evaluate` on the shared drive, as it is and in KITTI's layout.

mod support;

use serde_json::Value;
use std::{fs, path::Path};
use support::{pandaset_config, root, run, run_well, runtime_library, shared, stderr, write};

/// What `roadwatch evaluate` printed, which must be what it wrote.
fn evaluated(folder: &Path, arguments: &[&str]) -> Value {
    let out = folder.join("evaluation");
    let out_text = out.display().to_string();
    let all = [&["evaluate", "--json", "--report", &out_text], arguments].concat();
    let output = run_well(&all);
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let written = fs::read(out.join("report.json")).expect("written");
    assert_eq!(
        serde_json::from_slice::<Value>(&written).expect("JSON"),
        report
    );
    report
}

fn number(report: &Value, path: &str) -> f64 {
    report.pointer(path).and_then(Value::as_f64).expect(path)
}

#[test]
fn evaluation_gives_the_figures_known_of_this_drive() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = pandaset_config(&shared, "publish = false");
    let config = write(folder.path(), "config.toml", &config);
    let report = evaluated(folder.path(), &["--config", &config]);
    let number = |path: &str| number(&report, path);
    // Measured independently on the same images and labels: n 366 of 544, 14.7 %, bias -13.2 %.
    assert_eq!(number("/detection/n"), 544.0);
    assert!((number("/distance/triangle_fy/n") - 366.0).abs() <= 4.0);
    assert!((number("/distance/triangle_fy/mean_relative_error") - 0.147).abs() < 0.01);
    assert!((number("/distance/triangle_fy/bias_relative") + 0.132).abs() < 0.01);
    // The default method is to be at least a third better than the formula alone.
    let table = number("/distance/table/mean_relative_error");
    assert!(
        table < 0.667 * number("/distance/triangle_fy/mean_relative_error"),
        "{table}"
    );
    groups_hold_every_object_once(&report);
    intervals_hold_their_figures(&report);
    assert!(number("/latency_ms/p99") >= number("/latency_ms/p50"));
    plots_are_beside_the_report(&folder.path().join("evaluation"));
}

fn groups_hold_every_object_once(report: &Value) {
    let whole = report["distance"]["table"]["n"].as_u64();
    for grouping in [
        "distance_band",
        "class",
        "label",
        "camera",
        "box_height",
        "truncation",
    ] {
        let groups = report["by"][grouping].as_object().expect(grouping);
        let counts = groups
            .values()
            .map(|group| group["table"]["distance"]["n"].as_u64());
        assert_eq!(counts.sum::<Option<u64>>(), whole, "{grouping}");
        let objects = report["recall_by"][grouping].as_object().expect(grouping);
        let objects = objects.values().map(|group| group["n"].as_u64());
        assert_eq!(
            objects.sum::<Option<u64>>(),
            report["detection"]["n"].as_u64(),
            "{grouping}"
        );
    }
}

/// Twenty-three different cars say less than 366 boxes of them.
fn intervals_hold_their_figures(report: &Value) {
    assert_eq!(report["intervals_95"]["triangle_fy"]["objects"], 23);
    let mean = number(report, "/distance/triangle_fy/mean_relative_error");
    let low = number(report, "/intervals_95/triangle_fy/mean_relative_error/0");
    let high = number(report, "/intervals_95/triangle_fy/mean_relative_error/1");
    assert!(low < mean && mean < high, "{low} {mean} {high}");
    assert!(high - low > 0.03, "{low} {high}");
}

fn plots_are_beside_the_report(folder: &Path) {
    let text = fs::read_to_string(folder.join("report.md")).expect("a report");
    let shown: Vec<_> = text
        .lines()
        .filter_map(|line| line.strip_prefix("![")?.split_once("]("))
        .collect();
    assert_eq!(shown.len(), 6, "{text}");
    for (_, file) in shown {
        assert!(folder.join(file.trim_end_matches(')')).is_file(), "{file}");
    }
}

/// The front camera's frames of the shared drive in KITTI's layout. Its camera is turned level, which moves the
/// places of objects, but not their distances by more than its tilt of half a degree.
fn kitti_of_front(shared: &Path, kitti: &Path, frames: u64) {
    let dataset = shared.join("data/pandaset-dev");
    for part in ["image_2", "calib", "label_2"] {
        fs::create_dir_all(kitti.join(part)).expect("a folder");
    }
    let truth = fs::read_to_string(dataset.join("truth.jsonl")).expect("labels");
    for line in truth.lines() {
        let line: Value = serde_json::from_str(line).expect("a line of labels");
        let frame = line["frame"].as_u64().expect("a number");
        if line["camera"] != "front" || frame >= frames {
            continue;
        }
        let name = format!("{frame:06}");
        let image = dataset.join(format!("front/{frame:04}.jpg"));
        fs::copy(image, kitti.join(format!("image_2/{name}.jpg"))).expect("copied");
        let calibration = "P2: 985.0065 0 485.0001 0 0 985.0045 241.6494 0 0 0 1 0\n";
        fs::write(kitti.join(format!("calib/{name}.txt")), calibration).expect("written");
        let objects = line["objects"].as_array().expect("objects").iter();
        let labels: String = objects.map(kitti_label).collect();
        fs::write(kitti.join(format!("label_2/{name}.txt")), labels).expect("written");
    }
}

fn kitti_label(object: &Value) -> String {
    let list = |key: &str| -> Vec<f64> {
        let numbers = object[key].as_array().expect(key).iter();
        numbers.map(|number| number.as_f64().expect(key)).collect()
    };
    let (box_px, center, size) = (list("box_px"), list("center_camera_m"), list("size_lwh_m"));
    let occluded = object["occluded"].as_f64().expect("a share");
    let level = if occluded <= 0.3 { 0 } else { 2 };
    let kind = match object["class"].as_str().expect("a class") {
        "car" => "Car",
        "truck" => "Truck",
        "person" => "Pedestrian",
        _ => "Misc",
    };
    format!(
        "{kind} {} {level} 0 {} {} {} {} {} {} {} {} {} {} {}\n",
        object["truncated"],
        box_px[0] - 0.5,
        box_px[1] - 0.5,
        box_px[2] - 0.5,
        box_px[3] - 0.5,
        size[2],
        size[1],
        size[0],
        center[0],
        center[1] + size[2] / 2.0,
        center[2],
        object["rotation_y_rad"],
    )
}

#[test]
fn kittis_layout_is_scored_like_the_same_images_in_a_rig_dataset() {
    const FRAMES: u64 = 10;
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let kitti = folder.path().join("kitti");
    kitti_of_front(&shared, &kitti, FRAMES);
    let shipped = fs::read_to_string(root().join("config/kitti.toml")).expect("shipped");
    let placed = shipped.replace(
        "${ROADWATCH_SHARED:-../../shared}",
        &shared.display().to_string(),
    );
    let config = write(folder.path(), "kitti.toml", &placed);
    let kitti = kitti.display().to_string();
    let report = evaluated(
        folder.path(),
        &[
            "--config",
            &config,
            "--format",
            "kitti",
            "--dataset",
            &kitti,
        ],
    );
    assert_eq!(report["frames"], FRAMES);
    let config = write(
        folder.path(),
        "rig.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let frames = FRAMES.to_string();
    let expected = evaluated(folder.path(), &["--config", &config, "--frames", &frames]);
    let front = &expected["by"]["camera"]["front"];
    let recall = &expected["recall_by"]["camera"]["front"];
    assert_eq!(report["detection"]["n"], recall["n"]);
    assert_eq!(report["detection"]["matched"], recall["matched"]);
    // Depths need no mount, so they are the same but for the digits of the labels.
    let (found, expected) = (
        number(&report, "/depth/triangle_fy/mean_relative_error"),
        number(front, "/triangle_fy/depth/mean_relative_error"),
    );
    assert!((found - expected).abs() < 1e-3, "{found} {expected}");
}

#[test]
fn a_mistake_in_kittis_files_is_said_with_file_and_line() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    kitti_of_front(&shared, folder.path(), 2);
    let kitti = folder.path().display().to_string();
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let evaluate = || {
        run(&[
            "evaluate",
            "--config",
            &config,
            "--format",
            "kitti",
            "--dataset",
            &kitti,
        ])
    };
    let expect = |said: &str| {
        let output = evaluate();
        assert!(!output.status.success());
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
    };
    fs::write(
        folder.path().join("label_2/000001.txt"),
        "Car 0 0 0 1 2 3 4\n",
    )
    .expect("written");
    expect(
        "label_2/000001.txt:1: a label has 15 fields, this line has 8: `height` and what follows are missing",
    );
    fs::write(
        folder.path().join("calib/000001.txt"),
        "P2: -1 0 0 0 0 1 0 0 0 0 1 0\n",
    )
    .expect("written");
    expect("calib/000001.txt:1: P2: fx is -1: expected a focal length above 0, in pixels");
    fs::write(
        folder.path().join("calib/000001.txt"),
        "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n",
    )
    .expect("written");
    expect("calib/000001.txt:1: no line `P2: ...`");
}

#[test]
fn labels_of_a_camera_that_the_rig_does_not_have_are_refused() {
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let dataset = folder.path().join("dataset");
    fs::create_dir_all(dataset.join("front")).expect("a folder");
    let drive = shared.join("data/pandaset-dev");
    let rig = fs::read_to_string(drive.join("rig.toml")).expect("a rig");
    let front = rig
        .split("[[camera]]")
        .find(|camera| camera.contains("\"front\""))
        .expect("front");
    fs::write(dataset.join("rig.toml"), format!("[[camera]]{front}")).expect("written");
    fs::write(
        dataset.join("frames.jsonl"),
        "{\"frame\": 0, \"stamp\": {\"front\": 1.5}}\n",
    )
    .expect("written");
    fs::copy(drive.join("truth.jsonl"), dataset.join("truth.jsonl")).expect("copied");
    fs::copy(drive.join("front/0000.jpg"), dataset.join("front/0000.jpg")).expect("copied");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    let dataset = dataset.display().to_string();
    let output = run(&["evaluate", "--config", &config, "--dataset", &dataset]);
    assert!(!output.status.success());
    let said = "frame 0 has labels of camera `back`, but the rig has only front";
    assert!(stderr(&output).contains(said), "{}", stderr(&output));
}
