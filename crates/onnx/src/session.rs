//! Opening a model.

use crate::runtime::Runtime;
use ort::session::{
    Session,
    builder::{GraphOptimizationLevel, SessionBuilder},
};
use std::path::Path;

/// ONNX Runtime's dynamic cost model, at the value its documentation suggests: threads take shrinking shares
/// of each operator instead of equal ones, so that a core which decodes the next image in between does not
/// hold up the others.
const DYNAMIC_BLOCK_BASE: u32 = 4;

/// How a model is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SessionOptions {
    /// Threads inside one run.
    pub threads: usize,
    /// Busy-wait between runs: a little faster alone, and burns every core beside other work.
    pub spinning: bool,
}

/// Opens a model's file.
///
/// # Errors
/// What ONNX Runtime says.
pub fn open_file(
    runtime: &Runtime,
    path: &Path,
    options: SessionOptions,
) -> Result<Session, String> {
    let opened = builder(runtime, options).and_then(|mut builder| builder.commit_from_file(path));
    opened.map_err(|error| error.to_string())
}

/// Opens a model that lies in memory.
///
/// # Errors
/// What ONNX Runtime says.
pub fn open_bytes(
    runtime: &Runtime,
    model: &[u8],
    options: SessionOptions,
) -> Result<Session, String> {
    let opened =
        builder(runtime, options).and_then(|mut builder| builder.commit_from_memory(model));
    opened.map_err(|error| error.to_string())
}

fn builder(runtime: &Runtime, options: SessionOptions) -> ort::Result<SessionBuilder> {
    Ok(Session::builder(runtime.environment())?
        .with_optimization_level(GraphOptimizationLevel::All)?
        .with_intra_threads(options.threads)?
        .with_intra_op_spinning(options.spinning)?
        .with_dynamic_block_base(DYNAMIC_BLOCK_BASE)?)
}
