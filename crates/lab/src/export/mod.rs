//! What others take recordings in: data frames, glTF.

mod data_frame;
mod frames;
pub mod gltf;

pub use data_frame::{DataFrameError, DataFrameFile, Field, Kind, Value};
pub use frames::{LOCATIONAL, ROTATIONAL, locational_rows, rotational_rows};
