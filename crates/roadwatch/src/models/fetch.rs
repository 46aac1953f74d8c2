//! Fetching a file over HTTP: resumed where it broke off, and only under its name once it is the right one.

use super::{
    FetchError, Sha256,
    part::Part,
    registry::Checksum,
    transfer::{Transfer, Trouble},
};
use std::{
    path::PathBuf,
    thread::park_timeout,
    time::{Duration, Instant},
};

/// A file to fetch.
#[derive(Debug, Clone)]
pub struct Download {
    /// Its address.
    pub url: String,
    /// Its final name.
    pub to: PathBuf,
    /// What it has to hash to.
    pub checksum: Checksum,
    /// Its length; `None` when unknown.
    pub size_bytes: Option<u64>,
}

/// How patiently to fetch.
#[derive(Debug, Clone)]
pub struct FetchOptions {
    /// For a connection to be made.
    pub connect_timeout: Duration,
    /// For an answer to begin, and for each further piece of it.
    pub read_timeout: Duration,
    /// Tries in a row that may bring nothing new.
    pub tries: u32,
    /// Before the second try; doubled before each further one.
    pub first_pause: Duration,
    /// The longest that this grows to.
    pub longest_pause: Duration,
    /// Whether a proxy is asked.
    pub proxy: Proxy,
}

/// Whether a proxy is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proxy {
    /// The one that `ALL_PROXY`, `HTTPS_PROXY` or `HTTP_PROXY` name, with the exceptions of `NO_PROXY`.
    AsUsual,
    /// None.
    Never,
}

impl Default for FetchOptions {
    fn default() -> Self {
        Self {
            connect_timeout: Duration::from_secs(15),
            read_timeout: Duration::from_secs(30),
            tries: 5,
            first_pause: Duration::from_millis(500),
            longest_pause: Duration::from_secs(8),
            proxy: Proxy::AsUsual,
        }
    }
}

/// What happens while a file is fetched.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum News {
    /// So much of it is there.
    Has {
        /// Bytes on disk.
        bytes: u64,
        /// Bytes of the whole; `None` when nobody says.
        total: Option<u64>,
    },
    /// A try failed; after the pause comes another.
    Again {
        /// Why it failed.
        reason: String,
        /// How long the pause is.
        pause: Duration,
    },
    /// The server sends everything, so that what was there is of no use.
    Anew,
}

/// A file that is there, whole and checked as far as it can be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fetched {
    /// What it hashes to.
    pub sha256: Sha256,
    /// Its length.
    pub size_bytes: u64,
    /// Whether it had to be fetched.
    pub arrival: Arrival,
}

/// Whether a file had to be fetched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// It came now.
    Now,
    /// It was there. Where its hash is unknown it may be any file of this name.
    Before,
}

/// Fetches a file, unless it is there. `tell` hears what happens.
///
/// # Errors
/// See [`FetchError`]. What came is kept for a later call where it may be of use, never under the final name.
pub fn fetch(
    download: &Download,
    options: &FetchOptions,
    tell: &mut dyn FnMut(News),
) -> Result<Fetched, FetchError> {
    if download.to.exists() {
        return look_at(download);
    }
    let mut part = Part::open(&download.to)?;
    let arrived = receive(download, options, &mut part, tell).and_then(|()| check(download, &part));
    match arrived {
        Ok(fetched) => {
            part.finish()?;
            Ok(fetched)
        }
        Err(error) => {
            if error.spoils_part() || part.len() == 0 {
                part.remove()?;
            }
            Err(error)
        }
    }
}

/// What already has the final name.
fn look_at(download: &Download) -> Result<Fetched, FetchError> {
    let path = &download.to;
    let on_disk = |cause| FetchError::Disk {
        path: path.clone(),
        cause,
    };
    let found = Sha256::of_file(path).map_err(on_disk)?;
    match download.checksum {
        Checksum::Known(expected) if expected != found => Err(FetchError::Occupied {
            path: path.clone(),
            found,
            expected,
        }),
        _ => Ok(Fetched {
            sha256: found,
            size_bytes: path.metadata().map_err(on_disk)?.len(),
            arrival: Arrival::Before,
        }),
    }
}

fn receive(
    download: &Download,
    options: &FetchOptions,
    part: &mut Part,
    tell: &mut dyn FnMut(News),
) -> Result<(), FetchError> {
    let mut transfer = Transfer::new(download, options, part, tell)?;
    let mut furthest = transfer.bytes();
    let mut fruitless = 0;
    loop {
        let reason = match transfer.attempt() {
            Ok(()) => return Ok(()),
            Err(Trouble::Stays(error)) => return Err(error),
            Err(Trouble::MayPass(reason)) => reason,
        };
        let bytes = transfer.bytes();
        fruitless = if bytes > furthest { 1 } else { fruitless + 1 };
        furthest = furthest.max(bytes);
        if fruitless >= options.tries {
            return Err(FetchError::GaveUp {
                url: download.url.clone(),
                tries: fruitless,
                reason,
                kept_bytes: bytes,
            });
        }
        let pause = options.pause_after(fruitless);
        transfer.tell(News::Again { reason, pause });
        wait(pause);
    }
}

impl FetchOptions {
    fn pause_after(&self, fruitless: u32) -> Duration {
        let doubled = 2_u32.saturating_pow(fruitless.saturating_sub(1));
        self.first_pause
            .saturating_mul(doubled)
            .min(self.longest_pause)
    }
}

fn check(download: &Download, part: &Part) -> Result<Fetched, FetchError> {
    let found = Sha256::of_file(part.path()).map_err(|cause| FetchError::Disk {
        path: part.path().to_owned(),
        cause,
    })?;
    match download.checksum {
        Checksum::Known(expected) if expected != found => Err(FetchError::WrongHash {
            url: download.url.clone(),
            size_bytes: part.len(),
            found,
            expected,
        }),
        _ => Ok(Fetched {
            sha256: found,
            size_bytes: part.len(),
            arrival: Arrival::Now,
        }),
    }
}

/// A pause between two tries. There is no event to wait for: a signal ends the program, with the part on disk.
fn wait(pause: Duration) {
    let until = Instant::now() + pause;
    while let Some(left) = until.checked_duration_since(Instant::now()) {
        if left.is_zero() {
            return;
        }
        park_timeout(left);
    }
}
