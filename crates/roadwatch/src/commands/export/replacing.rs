//! Files that take their place when all of them is there.

use anyhow::{Context as _, Result};
use std::{
    fs::{self, File},
    path::{Path, PathBuf},
};

/// A file that takes its place at the end; until then, and after a failure, what was there before stays.
pub(super) struct Replacing {
    unfinished: PathBuf,
    path: PathBuf,
}

impl Replacing {
    /// Nothing is written yet.
    pub(super) fn new(path: &Path) -> Self {
        let mut unfinished = path.as_os_str().to_owned();
        unfinished.push(".unfinished");
        Self {
            unfinished: PathBuf::from(unfinished),
            path: path.to_owned(),
        }
    }

    /// Where it is written.
    pub(super) fn unfinished(&self) -> &Path {
        &self.unfinished
    }

    /// The file to write.
    pub(super) fn create(&self) -> Result<File> {
        File::create(&self.unfinished).with_context(|| self.unwritten())
    }

    /// What to say when it cannot be written.
    pub(super) fn unwritten(&self) -> String {
        format!("`{}` cannot be written", self.path.display())
    }

    /// Puts it in its place.
    pub(super) fn finish(self) -> Result<()> {
        fs::rename(&self.unfinished, &self.path).with_context(|| self.unwritten())
    }
}

impl Drop for Replacing {
    fn drop(&mut self) {
        // Gone already when all went well.
        let _gone = fs::remove_file(&self.unfinished);
    }
}
