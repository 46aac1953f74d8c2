//! The field loop: what is collected in operation is a dataset, and with truth it can be evaluated and learnt from.

mod support;

use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use support::{demo, refusal, root, run, run_well, runtime_library, stderr};
use tempfile::TempDir;

/// A folder with a configuration of the demo that publishes nothing; `None` without ONNX Runtime.
fn place() -> Option<(TempDir, String)> {
    runtime_library()?;
    let folder = tempfile::tempdir().expect("a folder");
    let silent = |text: String| text.replacen("[node]", "[node]\npublish = false", 1);
    let config = demo(folder.path(), silent);
    Some((folder, config))
}

fn within(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

fn lines(file: PathBuf) -> Vec<Value> {
    let text =
        fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    text.lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect()
}

/// Labels of the demo for the frames that were collected, found by camera and stamp, as anybody's truth would be.
fn truth_arrives(field: &Path) {
    let demo = root().join("demo");
    let key = |camera: &str, stamp: &Value| {
        (
            camera.to_owned(),
            stamp.as_f64().expect("seconds").to_bits(),
        )
    };
    let mut numbers = BTreeMap::new();
    for frame in lines(demo.join("frames.jsonl")) {
        for (camera, stamp) in frame["stamp"].as_object().expect("stamps") {
            numbers.insert(
                key(camera, stamp),
                frame["frame"].as_u64().expect("a number"),
            );
        }
    }
    let labels = lines(demo.join("truth.jsonl")).into_iter().map(|label| {
        let camera = label["camera"].as_str().expect("a name").to_owned();
        ((label["frame"].as_u64().expect("a number"), camera), label)
    });
    let labels: BTreeMap<_, _> = labels.collect();
    let mut text = String::new();
    for frame in lines(field.join("frames.jsonl")) {
        for (camera, stamp) in frame["stamp"].as_object().expect("stamps") {
            let mut label = labels[&(numbers[&key(camera, stamp)], camera.clone())].clone();
            label["frame"] = frame["frame"].clone();
            text += &format!("{label}\n");
        }
    }
    fs::write(field.join("truth.jsonl"), text).expect("written");
}

#[test]
fn what_was_collected_is_evaluated_and_becomes_tables_and_rows_when_truth_arrives() {
    let Some((folder, config)) = place() else {
        return;
    };
    let field = folder.path().join("field");
    let out = field.display().to_string();
    let arguments = [
        "collect", &config, "--pace", "lossless", "--frames", "40", "--every", "5", "-o", &out,
    ];
    let said = stderr(&run_well(&arguments));
    assert!(said.contains("collected: 8 of 40 rounds"), "{said}");
    let (frames, estimates) = (
        lines(field.join("frames.jsonl")),
        lines(field.join("estimates.jsonl")),
    );
    assert_eq!(frames.len(), 8);
    assert_eq!(estimates.len(), 8 * 6, "a line for every image");
    let objects = estimates
        .iter()
        .flat_map(|line| line["objects"].as_array().expect("objects"));
    let asked = objects
        .clone()
        .filter(|object| object["others_base_m"]["ground"].is_array())
        .count();
    assert!(
        asked > 20,
        "{asked} of {} have a second opinion",
        objects.count()
    );

    truth_arrives(&field);
    is_evaluated_and_learnt_from(folder.path(), &config, &out);
}

fn is_evaluated_and_learnt_from(folder: &Path, config: &str, field: &str) {
    let report = within(folder, "report");
    run_well(&[
        "evaluate",
        "--config",
        config,
        "--dataset",
        field,
        "--report",
        &report,
    ]);
    let report: Value = serde_json::from_str(
        &fs::read_to_string(Path::new(&report).join("report.json")).expect("written"),
    )
    .expect("JSON");
    let recall = report["detection"]["recall"].as_f64().expect("a share");
    assert!(recall > 0.8, "the same images as the demo's: {recall}");
    let table = within(folder, "front.rwtable");
    run_well(&[
        "table",
        "build",
        "--from-dataset",
        field,
        "--camera",
        "front",
        "-o",
        &table,
    ]);
    let rows = within(folder, "rows.csv");
    let models = root().join("models");
    let (head, features) = (
        within(&models, "roadwatch_parts.onnx"),
        within(&models, "roadwatch_detector.onnx"),
    );
    run_well(&[
        "rotation",
        "rows",
        field,
        "--model",
        &head,
        "--features",
        &features,
        "-o",
        &rows,
    ]);
    let rows = fs::read_to_string(&rows).expect("written");
    assert!(rows.lines().count() > 20, "{}", rows.lines().count());
}

#[test]
fn a_collection_ends_at_its_budget_and_never_adds_to_another() {
    let Some((folder, config)) = place() else {
        return;
    };
    let out = within(folder.path(), "field");
    let arguments = [
        "collect",
        &config,
        "--pace",
        "lossless",
        "-o",
        &out,
        "--budget-mb",
        "2",
    ];
    let said = stderr(&run_well(&arguments));
    assert!(said.contains("--budget-mb"), "{said}");
    let size = |folder: &Path| -> u64 {
        let mut all = vec![folder.to_owned()];
        let mut bytes = 0;
        while let Some(folder) = all.pop() {
            for entry in fs::read_dir(folder).expect("a folder") {
                let entry = entry.expect("an entry");
                match entry.file_type().expect("a kind").is_dir() {
                    true => all.push(entry.path()),
                    false => bytes += entry.metadata().expect("a size").len(),
                }
            }
        }
        bytes
    };
    let bytes = size(Path::new(&out));
    assert!((1_000_000..=2_000_000).contains(&bytes), "{bytes}");
    let said = refusal(&arguments);
    assert!(said.contains("not empty"), "{said}");
    assert_eq!(size(Path::new(&out)), bytes);
}

#[test]
fn a_full_disk_ends_a_collection_and_what_was_collected_is_whole() {
    let Some((_folder, config)) = place() else {
        return;
    };
    let disk = tempfile::tempdir().expect("a folder");
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=2m", "tmpfs"])
        .arg(disk.path())
        .status();
    if !mounted.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED: this user cannot mount a small disk to fill");
        return;
    }
    let field = disk.path().join("field");
    let output = run(&[
        "collect",
        &config,
        "--pace",
        "lossless",
        "-o",
        &field.display().to_string(),
    ]);
    let frames = lines(field.join("frames.jsonl"));
    let images = fs::read_dir(field.join("front")).map(Iterator::count);
    let estimates = lines(field.join("estimates.jsonl"));
    let unmounted = Command::new("umount").arg(disk.path()).status();
    assert!(
        unmounted.is_ok_and(|status| status.success()),
        "still mounted"
    );
    let said = stderr(&output);
    assert!(!output.status.success(), "{said}");
    assert!(
        said.contains("No space left") && said.contains("ended early"),
        "{said}"
    );
    assert!(!frames.is_empty());
    assert_eq!(
        images.expect("a folder"),
        frames.len(),
        "no image without its line"
    );
    assert_eq!(estimates.len(), 6 * frames.len());
}
