//! A file on its way: `NAME.part`, beside it what it is a part of, and the one step that makes it `NAME`.

use serde::{Deserialize, Serialize};
use std::{
    fs::{self, File, TryLockError},
    io::{self, ErrorKind, Seek as _, SeekFrom, Write as _},
    path::{Path, PathBuf},
};

/// What a part is a part of: without this, a later run could not tell whether the rest still belongs to it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PartOf {
    /// Where it comes from.
    pub(super) url: String,
    /// The server's word for this version of it (a strong ETag, or a date); `None` when it has none.
    pub(super) version: Option<String>,
}

/// The part of a file that has come so far. Only one process at a time has it.
#[derive(Debug)]
pub(super) struct Part {
    whole_path: PathBuf,
    path: PathBuf,
    origin_path: PathBuf,
    file: File,
    len: u64,
    origin: Option<PartOf>,
}

/// A part that could not be opened, written or renamed.
#[derive(Debug)]
pub(super) struct PartError {
    pub(super) path: PathBuf,
    pub(super) cause: io::Error,
}

impl Part {
    /// Takes up what an earlier run left of `whole_path`, or begins; makes the folder where it is missing.
    ///
    /// # Errors
    /// When the folder cannot be made or written to, or another process has the part (`WouldBlock`).
    pub(super) fn open(whole_path: &Path) -> Result<Self, PartError> {
        let path = part_path(whole_path);
        let origin_path = with_suffix(whole_path, ".part.from");
        let folder = whole_path.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder).map_err(at(folder))?;
        let file = File::options()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(at(&path))?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => at(&path)(ErrorKind::WouldBlock.into()),
            TryLockError::Error(error) => at(&path)(error),
        })?;
        let len = file.metadata().map_err(at(&path))?.len();
        // What cannot be read names no origin, and then the part is begun anew.
        let origin = fs::read_to_string(&origin_path)
            .ok()
            .and_then(|text| serde_json::from_str(&text).ok());
        Ok(Self {
            whole_path: whole_path.to_owned(),
            path,
            origin_path,
            file,
            len,
            origin,
        })
    }

    /// Bytes that are there.
    pub(super) fn len(&self) -> u64 {
        self.len
    }

    /// What they are a part of; `None` when nobody knows.
    pub(super) fn origin(&self) -> Option<&PartOf> {
        self.origin.as_ref()
    }

    /// Throws away what is there and begins with `origin`.
    pub(super) fn restart(&mut self, origin: Option<PartOf>) -> Result<(), PartError> {
        self.file.set_len(0).map_err(at(&self.path))?;
        self.len = 0;
        if let Some(origin) = &origin {
            let text = serde_json::to_string(origin).map_err(io::Error::from);
            text.and_then(|text| fs::write(&self.origin_path, text))
                .map_err(at(&self.origin_path))?;
        }
        self.origin = origin;
        Ok(())
    }

    /// Writes behind what is there.
    pub(super) fn append(&mut self, bytes: &[u8]) -> Result<(), PartError> {
        let written = self
            .file
            .seek(SeekFrom::Start(self.len))
            .and_then(|_| self.file.write_all(bytes));
        written.map_err(at(&self.path))?;
        self.len += bytes.len() as u64;
        Ok(())
    }

    /// The file, to be hashed.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the part the whole, in one step: nobody ever sees half of it under its final name.
    pub(super) fn finish(self) -> Result<(), PartError> {
        // A machine that loses power must not keep the name and lose the bytes.
        self.file.sync_all().map_err(at(&self.path))?;
        fs::rename(&self.path, &self.whole_path).map_err(at(&self.whole_path))?;
        remove(&self.origin_path)
    }

    /// Removes it, because it is not what was asked for.
    pub(super) fn remove(self) -> Result<(), PartError> {
        remove(&self.path)?;
        remove(&self.origin_path)
    }
}

/// The name of a file while it is on its way.
pub(super) fn part_path(whole_path: &Path) -> PathBuf {
    with_suffix(whole_path, ".part")
}

fn remove(path: &Path) -> Result<(), PartError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(at(path)(error)),
        _ => Ok(()),
    }
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

fn at(path: &Path) -> impl Fn(io::Error) -> PartError {
    let path = path.to_owned();
    move |cause| PartError {
        path: path.clone(),
        cause,
    }
}
