//! Whether a model is here, and where.

use super::{Model, Origin, part};
use crate::config::Environment;
use std::path::{Path, PathBuf};

/// Whether a model is here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// It came with the checkout that the program was built in.
    InRepository(PathBuf),
    /// It comes with a checkout, and this is none, or one without it.
    OnlyInRepository,
    /// It lies in the folder of fetched models. Its bytes are not looked at, only their number.
    Fetched(PathBuf),
    /// A file of its name lies there, of a length that it cannot have.
    Unlike {
        /// The file.
        path: PathBuf,
        /// Its length.
        size_bytes: u64,
    },
    /// A fetch broke off.
    PartlyFetched {
        /// Bytes that came.
        size_bytes: u64,
    },
    /// It is not here.
    Absent,
}

impl State {
    /// Of a model, with `folder` being where fetched models lie.
    #[must_use]
    pub fn of(model: &Model, folder: Option<&Path>, environment: &Environment) -> Self {
        if let Origin::Repository(place) = &model.origin {
            let path = environment.checkout().map(|checkout| checkout.join(place));
            return match path.filter(|path| path.is_file()) {
                Some(path) => Self::InRepository(path),
                None => Self::OnlyInRepository,
            };
        }
        let Some(path) = folder.map(|folder| folder.join(&model.file)) else {
            return Self::Absent;
        };
        let length = |path: &Path| path.metadata().ok().map(|metadata| metadata.len());
        match (length(&path), length(&part::part_path(&path))) {
            (Some(size_bytes), _) if model.size_bytes.is_some_and(|size| size != size_bytes) => {
                Self::Unlike { path, size_bytes }
            }
            (Some(_), _) => Self::Fetched(path),
            (None, Some(size_bytes)) => Self::PartlyFetched { size_bytes },
            (None, None) => Self::Absent,
        }
    }

    /// In one word, for programs.
    #[must_use]
    pub fn as_str(&self) -> &'static str {
        match self {
            Self::InRepository(_) => "in_repository",
            Self::OnlyInRepository => "only_in_repository",
            Self::Fetched(_) => "fetched",
            Self::Unlike { .. } => "unlike",
            Self::PartlyFetched { .. } => "partly_fetched",
            Self::Absent => "absent",
        }
    }

    /// Where it is; `None` when it is not here.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::InRepository(path) | Self::Fetched(path) => Some(path),
            _ => None,
        }
    }
}
