//! `roadwatch models list` and `fetch`, as a user sees them.

use crate::{
    server::{Server, Turn},
    support::{daemon, root, runtime_library, shared, stderr, stdout},
};
use serde_json::Value;
use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

/// The program with a data folder of its own, and without the proxies of whoever runs the tests.
fn models(data: &Path, arguments: &[&str]) -> Command {
    let arguments: Vec<_> = [&["models"], arguments].concat();
    let mut command = daemon(&arguments);
    command.env("XDG_DATA_HOME", data);
    for proxy in ["ALL_PROXY", "HTTP_PROXY", "HTTPS_PROXY"] {
        command.env_remove(proxy).env_remove(proxy.to_lowercase());
    }
    command
}

fn run(data: &Path, arguments: &[&str]) -> Output {
    models(data, arguments).output().expect("it starts")
}

fn fail(data: &Path, arguments: &[&str]) -> String {
    let output = run(data, arguments);
    assert_eq!(output.status.code(), Some(1), "{}", stdout(&output));
    stderr(&output)
}

fn state(data: &Path, name: &str) -> Value {
    let output = run(data, &["list", "--json"]);
    let models: Vec<Value> = serde_json::from_slice(&output.stdout).expect("JSON");
    let mut models = models.into_iter();
    models
        .find(|model| model["name"] == name)
        .expect("it is listed")
}

#[test]
fn the_list_has_every_model_with_its_licence_and_head() {
    let data = tempfile::tempdir().expect("a folder");
    let output = run(data.path(), &["list"]);
    let text = stdout(&output);
    let rows = [
        ("yolov5s ", "AGPL-3.0", "yolov5"),
        ("yolov8n ", "AGPL-3.0", "yolov8"),
        ("yolox_s ", "Apache-2.0", "yolox"),
        ("yolox_nano ", "Apache-2.0", "yolox"),
        ("roadwatch_detector ", "MIT OR Apache-2.0", "yolov8"),
    ];
    for (name, licence, head) in rows {
        let mut lines = text.lines();
        let line = lines.find(|line| line.starts_with(name)).expect("a line");
        assert!(line.contains(licence) && line.contains(head), "{line}");
    }
}

#[test]
fn the_list_says_what_was_fetched_and_what_only_began() {
    let data = tempfile::tempdir().expect("a folder");
    let folder = data.path().join("roadwatch/models");
    fs::create_dir_all(&folder).expect("made");
    fs::write(folder.join("yolox_s.onnx.part"), [0; 10]).expect("written");
    fs::write(folder.join("yolox_nano.onnx"), [0; 10]).expect("written");
    fs::write(folder.join("yolov5s.onnx"), [0; 10]).expect("written");
    assert_eq!(state(data.path(), "yolov8n")["state"], "absent");
    assert_eq!(state(data.path(), "yolox_s")["state"], "partly_fetched");
    assert_eq!(state(data.path(), "yolox_nano")["state"], "unlike");
    let exported = state(data.path(), "yolov5s");
    assert_eq!(exported["state"], "fetched");
    let path = folder.join("yolov5s.onnx");
    assert_eq!(exported["path"], path.to_str().expect("text"));
}

#[test]
fn an_unknown_name_is_answered_with_the_known_ones() {
    let data = tempfile::tempdir().expect("a folder");
    let text = fail(data.path(), &["fetch", "yolov9"]);
    assert!(
        text.contains("`yolov9`") && text.contains("yolov5s, yolov8n"),
        "{text}"
    );
}

#[test]
fn what_nobody_publishes_is_fetched_with_an_explanation() {
    let data = tempfile::tempdir().expect("a folder");
    let text = fail(data.path(), &["fetch", "yolov5s"]);
    assert!(
        text.contains("AGPL-3.0") && text.contains("export.py"),
        "{text}"
    );
}

#[test]
fn our_own_detector_is_pointed_to_or_said_to_be_in_a_checkout() {
    let data = tempfile::tempdir().expect("a folder");
    let output = run(data.path(), &["fetch", "roadwatch_detector"]);
    let path = root().join("models/roadwatch_detector.onnx");
    if path.is_file() {
        assert!(
            stdout(&output).contains("model = \""),
            "{}",
            stdout(&output)
        );
    } else {
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains("models/roadwatch_detector.onnx"));
    }
}

#[test]
fn without_a_known_hash_nothing_is_asked_for_before_the_user_says_so() {
    let data = tempfile::tempdir().expect("a folder");
    let server = Server::start(b"bytes", &[Turn::Serve]);
    let output = run(data.path(), &["fetch", "yolov5s", "--url", &server.url()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--accept-unverified"));
    assert!(
        stdout(&output).contains("licence   AGPL-3.0"),
        "{}",
        stdout(&output)
    );
    assert!(server.requests().is_empty());
}

#[test]
fn what_is_taken_unverified_is_printed_with_size_and_hash() {
    let data = tempfile::tempdir().expect("a folder");
    let server = Server::start(b"abc", &[Turn::Serve]);
    let to = data.path().join("here");
    let to = to.to_str().expect("text");
    let url = server.url();
    let arguments = [
        "fetch",
        "yolov5s",
        "--url",
        &url,
        "--to",
        to,
        "--accept-unverified",
    ];
    // Without ONNX Runtime the file cannot be opened, which is said and no failure.
    let output = models(data.path(), &arguments)
        .env("ORT_DYLIB_PATH", "/nowhere")
        .output()
        .expect("it starts");
    let text = stdout(&output);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(text.contains("(3 bytes)"), "{text}");
    let hash = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad (not checked";
    assert!(text.contains(hash), "{text}");
    assert!(
        text.contains("not opened, because ONNX Runtime's"),
        "{text}"
    );
    assert!(
        text.ends_with(&format!("model = \"{to}/yolov5s.onnx\"\n")),
        "{text}"
    );
    assert_eq!(
        fs::read(format!("{to}/yolov5s.onnx")).expect("the file"),
        b"abc"
    );
}

#[test]
fn a_file_that_is_no_detector_is_said_to_be_none() {
    let data = tempfile::tempdir().expect("a folder");
    if runtime_library().is_none() {
        return;
    }
    let server = Server::start(b"abc", &[Turn::Serve]);
    let url = server.url();
    let arguments = ["fetch", "yolov5s", "--url", &url, "--accept-unverified"];
    let text = fail(data.path(), &arguments);
    assert!(text.contains("was fetched and cannot be used"), "{text}");
}

#[test]
fn another_file_than_the_registrys_is_refused_also_from_a_mirror() {
    let data = tempfile::tempdir().expect("a folder");
    let server = Server::start(&vec![0; 3_659_407], &[Turn::Serve]);
    let url = server.url();
    let text = fail(data.path(), &["fetch", "yolox_nano", "--url", &url]);
    assert!(text.contains("the registry says c789161e"), "{text}");
    let folder = data.path().join("roadwatch/models");
    assert_eq!(fs::read_dir(folder).expect("the folder").count(), 0);
}

#[test]
fn a_fetched_detector_is_opened_and_described() {
    let data = tempfile::tempdir().expect("a folder");
    let (Some(shared), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let content = fs::read(shared.join("models/yolov5n_640.onnx")).expect("the model");
    let server = Server::start(&content, &[Turn::Die(2_000_000), Turn::Serve]);
    let url = server.url();
    let arguments = ["fetch", "yolov5s", "--url", &url, "--accept-unverified"];
    let output = run(data.path(), &arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("head      yolov5, 25200 boxes"),
        "{}",
        stdout(&output)
    );
    let told = stderr(&output);
    assert!(
        told.contains("it broke off after 2000000 of 7551434 bytes"),
        "{told}"
    );
    assert!(told.contains("7552/7552 kB"), "{told}");
}
