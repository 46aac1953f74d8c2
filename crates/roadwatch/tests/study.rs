//! `roadwatch study`: what it refuses, and how it says so.

mod support;

use std::fs;
use support::{run, stderr, write};

const RIG: &str = "[[camera]]\nname = \"camera\"\nwidth = 1920\nheight = 1080\nfx = 1400.0\nfy = 1400.0\ncx = 959.5\n\
                   cy = 539.5\nposition_m = [0.0, 0.0, 1.6]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n";

/// A dataset of one frame, with these labels.
fn dataset(truth: Option<&str>) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "rig.toml", RIG);
    let frame = "{\"frame\": 0, \"stamp\": {\"camera\": 1.5}}\n";
    write(folder.path(), "frames.jsonl", frame);
    fs::create_dir(folder.path().join("camera")).expect("a folder");
    if let Some(truth) = truth {
        write(folder.path(), "truth.jsonl", truth);
    }
    let path = folder.path().display().to_string();
    (folder, path)
}

#[test]
fn a_dataset_without_labels_or_without_a_path_is_refused_and_nothing_is_written() {
    let out = tempfile::tempdir().expect("a folder");
    let report = out.path().join("study").display().to_string();
    let (_unlabelled, folder) = dataset(None);
    let refused = run(&["study", &folder, "--report", &report]);
    let said = stderr(&refused);
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(
        said.contains("needs the truth") && said.contains("truth.jsonl"),
        "{said}"
    );
    let (_empty, folder) = dataset(Some(
        "{\"frame\": 0, \"camera\": \"camera\", \"objects\": []}\n",
    ));
    let said = stderr(&run(&["study", &folder, "--report", &report]));
    assert!(
        said.contains("no car, truck or bus") && said.contains("paper_x_path"),
        "{said}"
    );
    assert!(!out.path().join("study").exists());
}

#[test]
fn a_detector_needs_a_configuration() {
    let refused = run(&["study", "nowhere", "--boxes", "detector"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("--config"),
        "{}",
        stderr(&refused)
    );
}
