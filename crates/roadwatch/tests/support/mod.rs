//! The daemon as a process, the shared data, and the Python peers.
//!
//! What is skipped is written to standard error itself: the test runner keeps what `eprintln!` prints.

#![expect(dead_code, reason = "each test file uses its part")]

use std::io::Write as _;
use std::{
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

/// The repository's root.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .expect("the repository")
}

/// The folder with models and data that are not this project's to ship; `None`, said loudly, when absent.
pub(crate) fn shared() -> Option<PathBuf> {
    let named =
        variable("ROADWATCH_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from);
    let wanted = [
        "models/yolov5n_640.onnx",
        "models/yolox_nano.onnx",
        "data/pandaset-dev/rig.toml",
    ];
    for part in wanted {
        if !named.join(part).is_file() {
            writeln!(
                std::io::stderr(),
                "SKIPPED: {} is not there; set ROADWATCH_SHARED",
                named.join(part).display()
            )
            .expect("standard error");
            return None;
        }
    }
    Some(named.canonicalize().expect("the shared folder"))
}

/// The Python of the peers; `None`, said loudly, when absent.
pub(crate) fn python() -> Option<PathBuf> {
    let named = variable("ROADWATCH_TEST_PYTHON").map(PathBuf::from);
    let python = named.unwrap_or_else(|| root().join(".cache/venv/bin/python"));
    if python.is_file() {
        return Some(python);
    }
    writeln!(
        std::io::stderr(),
        "SKIPPED: {} is not there; ./dev test sets it up",
        python.display()
    )
    .expect("standard error");
    None
}

/// The peer on Fast DDS; `None`, said loudly, when absent.
pub(crate) fn fast_dds_peer() -> Option<Command> {
    let named = variable("ROADWATCH_FAST_DDS_PEER").map(PathBuf::from);
    let peer = named.unwrap_or_else(|| root().join(".cache/fastdds_peer"));
    if peer.is_file() {
        return Some(Command::new(peer));
    }
    writeln!(
        std::io::stderr(),
        "SKIPPED: {} is not there; ./dev test compiles it",
        peer.display()
    )
    .expect("standard error");
    None
}

/// ONNX Runtime's library, for tests that open models in their own process.
pub(crate) fn runtime_library() -> Option<PathBuf> {
    let named = variable("ORT_DYLIB_PATH").map(PathBuf::from);
    let library = named.unwrap_or_else(|| root().join(".cache/onnxruntime/libonnxruntime.so"));
    if library.is_file() {
        return Some(library);
    }
    writeln!(
        std::io::stderr(),
        "SKIPPED: {} is not there; ./dev test fetches it",
        library.display()
    )
    .expect("standard error");
    None
}

#[expect(
    clippy::disallowed_methods,
    reason = "tests are told by the environment where things are"
)]
fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok()
}

/// The daemon, with its outputs piped, in the repository's root.
pub(crate) fn daemon(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roadwatch"));
    command
        .args(arguments)
        .current_dir(root())
        .stdin(Stdio::null());
    if let Some(library) = runtime_library() {
        command.env("ORT_DYLIB_PATH", library);
    }
    command
}

/// Runs the daemon to its end.
pub(crate) fn run(arguments: &[&str]) -> Output {
    daemon(arguments).output().expect("the daemon starts")
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What the program says on standard error when it refuses these arguments, as it must.
pub(crate) fn refusal(arguments: &[&str]) -> String {
    let output = run(arguments);
    let text = stderr(&output);
    assert!(
        !output.status.success() && !text.contains("panicked"),
        "{text}"
    );
    text
}

/// Runs the daemon to its end and expects it to succeed.
pub(crate) fn run_well(arguments: &[&str]) -> Output {
    let output = run(arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    output
}

/// Runs a peer's script and reads the JSON it prints.
pub(crate) fn peer_json(python: &Path, script: &str, arguments: &[&str]) -> serde_json::Value {
    let script = root().join("tests/peers").join(script);
    let output = Command::new(python)
        .arg("-B")
        .arg(script)
        .args(arguments)
        .output()
        .expect("python starts");
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).expect("the peer prints JSON")
}

/// The shipped configuration for the shared drive, without its `[[camera]]` tables, so that tests add their own;
/// `node` goes into `[node]`.
pub(crate) fn pandaset_config(shared: &Path, node: &str) -> String {
    let shipped = std::fs::read_to_string(root().join("config/pandaset.toml")).expect("shipped");
    let shipped = shipped
        .split("[[camera]]")
        .next()
        .expect("what comes before");
    let placed = shipped.replace(
        "${ROADWATCH_SHARED:-../../shared}",
        &shared.display().to_string(),
    );
    let models = format!("\"{}/models/", root().display());
    let placed = placed.replace("\"../models/", &models);
    placed.replacen("[node]", &format!("[node]\n{node}"), 1)
}

/// Writes a configuration into a folder and gives its path as text.
pub(crate) fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.display().to_string()
}

/// The demo's configuration with its files at hand, changed by `change`.
pub(crate) fn demo(folder: &Path, change: impl Fn(String) -> String) -> String {
    let shipped = std::fs::read_to_string(root().join("config/demo.toml")).expect("shipped");
    let placed = shipped
        .replace("\"../models/", &format!("\"{}/models/", root().display()))
        .replace("\"../demo\"", &format!("\"{}/demo\"", root().display()));
    write(folder, "demo.toml", &change(placed))
}
