//! Headings in the daemon: the shipped models on the shipped clips, and what is said of models that do not fit.

mod support;

use std::fs;
use support::{refusal, root, run_well, stderr, stdout, write};

/// The demo's configuration with its files at hand, changed by `change`.
fn demo(folder: &std::path::Path, change: impl Fn(String) -> String) -> String {
    let shipped = fs::read_to_string(root().join("config/demo.toml")).expect("shipped");
    let placed = shipped
        .replace("\"../models/", &format!("\"{}/models/", root().display()))
        .replace("\"../demo\"", &format!("\"{}/demo\"", root().display()));
    write(folder, "demo.toml", &change(placed))
}

#[test]
fn the_shipped_clips_get_headings_that_are_mostly_right() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let options = ["--pace", "lossless", "--frames", "6", "--score"];
    let output = run_well(&[&["run", config.as_str()][..], &options].concat());
    let said = [stdout(&output), stderr(&output)].concat();
    let line = said.lines().find(|line| line.contains("heading of"));
    let line = line.expect("a line of headings");
    let median = line
        .split("median ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let median: f64 = median
        .and_then(|number| number.parse().ok())
        .expect("a median");
    assert!(median < 10.0, "{line}");
}

#[test]
fn models_that_do_not_fit_are_named_with_their_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = write(folder.path(), "text.onnx", "no model");
    let detector = "/models/roadwatch_detector.onnx\"";
    let refused = |key: &str, file: &str| {
        let line = format!("{key} = \"{file}\"");
        let config = demo(folder.path(), |shipped| {
            let lines = shipped.lines().map(|old| {
                let in_rotation = old.starts_with(&format!("{key} =")) && !old.contains(detector);
                if in_rotation {
                    line.clone()
                } else {
                    old.to_owned()
                }
            });
            let lines: Vec<String> = lines.collect();
            let absent = !lines.contains(&line);
            let more = if absent {
                format!("\n{line}\n")
            } else {
                String::new()
            };
            lines.join("\n") + &more
        });
        refusal(&["check", &config])
    };
    let said = refused("model", &text);
    assert!(
        said.contains("rotation.model") && said.contains("no key-component model"),
        "{said}"
    );
    let said = refused("forest", &text);
    assert!(
        said.contains("rotation.forest") && said.contains("RWFOREST"),
        "{said}"
    );
    let said = refused("features", &text);
    assert!(
        said.contains("rotation.features") && said.contains("another detector"),
        "{said}"
    );
}
