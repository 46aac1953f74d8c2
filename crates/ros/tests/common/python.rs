//! The Python peers of `tests/peers`, run as other processes.

use std::io::Write as _;
use std::{
    path::{Path, PathBuf},
    process::Command,
};

/// Names the interpreter that has the peers' packages.
const PYTHON_VARIABLE: &str = "ROADWATCH_TEST_PYTHON";

/// A command that runs the peer `script`; `None`, said loudly, where Python or `package` is missing.
#[expect(
    clippy::disallowed_methods,
    reason = "a test has no configuration to name its interpreter"
)]
pub(crate) fn peer(script: &str, package: &str) -> Option<Command> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let python = std::env::var_os(PYTHON_VARIABLE)
        .map_or_else(|| root.join(".cache/venv/bin/python"), PathBuf::from);
    let importable = Command::new(&python)
        .args(["-c", &format!("import {package}")])
        .output()
        .is_ok_and(|output| output.status.success());
    if !importable {
        writeln!(
            std::io::stderr(),
            "SKIPPED: {} cannot import {package}; set {PYTHON_VARIABLE} to one that can",
            python.display()
        )
        .expect("standard error");
        return None;
    }
    let mut command = Command::new(python);
    // No compiled copies of the peers beside them in the repository.
    command.arg("-B").arg(root.join("tests/peers").join(script));
    Some(command)
}
