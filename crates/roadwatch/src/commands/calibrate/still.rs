//! Pictures from files, whatever their size.

use anyhow::{Context as _, anyhow};
use roadwatch_calibrate::read_picture;
use roadwatch_core::Pixels;
use std::path::Path;

/// Reads a picture.
pub(super) fn read(file: &Path) -> Result<Pixels, anyhow::Error> {
    if !file.is_file() {
        return Err(anyhow!("`{}` is not there", file.display()));
    }
    read_picture(file).with_context(|| format!("`{}`", file.display()))
}
