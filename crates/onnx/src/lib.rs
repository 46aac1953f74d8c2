//! ONNX Runtime for the stages with a network: its library, sessions, and features out of the middle of one.

pub mod cut;
pub mod runtime;
pub mod session;
mod wire;

pub use cut::{CutError, cut};
pub use runtime::{Runtime, RuntimeError};
pub use session::{SessionOptions, open_bytes, open_file};
