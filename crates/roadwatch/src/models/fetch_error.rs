//! Why a model could not be fetched, and what to do about it.

use super::{Sha256, part::PartError};
use std::{
    io::{self, ErrorKind},
    path::PathBuf,
};
use ureq::http::StatusCode;

/// A model that could not be fetched. Nothing lies under its final name that was not there before.
#[derive(Debug, thiserror::Error)]
pub enum FetchError {
    /// Something else has the final name.
    #[error(
        "`{path}` is there and is another file (sha256 {found}, expected {expected}): move it away, or name \
         another folder with --to"
    )]
    Occupied {
        /// The file.
        path: PathBuf,
        /// What it hashes to.
        found: Sha256,
        /// What the registry says.
        expected: Sha256,
    },
    /// The address makes no sense, or a secure connection cannot be made.
    #[error("{url} cannot be asked for: {reason}")]
    Unusable {
        /// The address.
        url: String,
        /// Why not.
        reason: String,
    },
    /// The server refuses.
    #[error("{url}: the server says {status}: {}", advice(*.status))]
    Refused {
        /// The address.
        url: String,
        /// Its answer.
        status: StatusCode,
    },
    /// Nothing new came for too long.
    #[error(
        "{url}: gave up after {tries} tries without a new byte, the last one because {reason}; {}",
        kept(*.kept_bytes)
    )]
    GaveUp {
        /// The address.
        url: String,
        /// Tries in a row.
        tries: u32,
        /// What went wrong with the last one.
        reason: String,
        /// Bytes that a later run will go on from.
        kept_bytes: u64,
    },
    /// Nobody says how long the file is, and nobody knows its hash.
    #[error(
        "{url}: the server does not say how long the file is, and its sha256 is unknown, so that half of it \
         could not be told from all of it; fetch it with a browser instead, and check it with \
         `roadwatch models verify`"
    )]
    Unmeasured {
        /// The address.
        url: String,
    },
    /// The file is of another length than the registry says.
    #[error(
        "{url} has {} bytes, the registry says {expected}: it is another file, or a broken one; nothing of it \
         was kept", length(*.found)
    )]
    WrongLength {
        /// The address.
        url: String,
        /// Bytes that it has; `None` for more than expected.
        found: Option<u64>,
        /// Bytes of the file that the registry means.
        expected: u64,
    },
    /// The file is not the one that the registry means.
    #[error(
        "{url}: what came ({size_bytes} bytes) has sha256 {found}, the registry says {expected}: it is another \
         file, or it was changed on its way; nothing of it was kept"
    )]
    WrongHash {
        /// The address.
        url: String,
        /// Bytes that came.
        size_bytes: u64,
        /// What they hash to.
        found: Sha256,
        /// What the registry says.
        expected: Sha256,
    },
    /// A file or folder cannot be used.
    #[error("`{path}`: {cause}{}", remedy(.cause))]
    Disk {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

impl FetchError {
    /// Whether the bytes that came are known to be of no use.
    pub(super) fn spoils_part(&self) -> bool {
        matches!(self, Self::WrongLength { .. } | Self::WrongHash { .. })
    }
}

impl From<PartError> for FetchError {
    fn from(PartError { path, cause }: PartError) -> Self {
        Self::Disk { path, cause }
    }
}

fn advice(status: StatusCode) -> &'static str {
    match status.as_u16() {
        404 | 410 => {
            "the file is not there (any more); look at the model's page, and name its address with --url"
        }
        401 | 403 | 407 => {
            "it wants credentials, or a proxy stands in the way; fetch the file with a browser"
        }
        _ => "it does not hand out the file like this; fetch it with a browser",
    }
}

fn kept(bytes: u64) -> String {
    match bytes {
        0 => "see whether the network and the server work, then run it again".to_owned(),
        bytes => format!("the {bytes} bytes that came are kept: run it again to go on from there"),
    }
}

fn length(found: Option<u64>) -> String {
    found.map_or_else(|| "more".to_owned(), |bytes| bytes.to_string())
}

fn remedy(cause: &io::Error) -> &'static str {
    match cause.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "; make room, or name a folder elsewhere with --to; run it again to go on from what came"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "; name a folder that you may write to with --to"
        }
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            "; a file stands where a folder has to be; name another folder with --to"
        }
        ErrorKind::WouldBlock => "; another `roadwatch models fetch` is writing it; let it finish",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_disk(kind: ErrorKind) -> String {
        let path = PathBuf::from("/m/a.onnx.part");
        let cause = kind.into();
        FetchError::Disk { path, cause }.to_string()
    }

    #[test]
    fn a_full_or_closed_disk_is_said_with_its_place_and_a_way_out() {
        let full = on_disk(ErrorKind::StorageFull);
        assert!(
            full.starts_with("`/m/a.onnx.part`: no storage space; make room"),
            "{full}"
        );
        let closed = on_disk(ErrorKind::ReadOnlyFilesystem);
        assert!(
            closed.ends_with("; name a folder that you may write to with --to"),
            "{closed}"
        );
        assert!(on_disk(ErrorKind::WouldBlock).contains("another `roadwatch models fetch`"));
    }
}
