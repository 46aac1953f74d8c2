//! One try after another to get a file, or the rest of it, into its part.

use super::{
    FetchError,
    fetch::{Download, FetchOptions, News, Proxy},
    part::{Part, PartOf},
    registry::Checksum,
    response::{Meaning, version},
};
use std::io::{self, Read as _};
use ureq::{
    Agent, Body,
    http::{Response, header},
};

/// What is read between two looks at the length, and what a broken connection loses at most.
const CHUNK_BYTES: usize = 1 << 16;

/// A file, what is there of it, and the way to the server.
pub(super) struct Transfer<'a> {
    agent: Agent,
    download: &'a Download,
    part: &'a mut Part,
    tell: &'a mut dyn FnMut(News),
}

/// Why a try failed.
pub(super) enum Trouble {
    /// Another may do better.
    MayPass(String),
    /// It makes no sense to try again.
    Stays(FetchError),
}

impl<E: Into<FetchError>> From<E> for Trouble {
    fn from(error: E) -> Self {
        Self::Stays(error.into())
    }
}

impl<'a> Transfer<'a> {
    pub(super) fn new(
        download: &'a Download,
        options: &FetchOptions,
        part: &'a mut Part,
        tell: &'a mut dyn FnMut(News),
    ) -> Result<Self, FetchError> {
        if !goes_on(download, part) {
            part.restart(None)?;
        }
        Ok(Self {
            agent: agent(options),
            download,
            part,
            tell,
        })
    }

    /// Bytes that are there.
    pub(super) fn bytes(&self) -> u64 {
        self.part.len()
    }

    pub(super) fn tell(&mut self, news: News) {
        (self.tell)(news);
    }

    /// Asks once for what is missing, and takes what comes. Well means that nothing is missing any more.
    pub(super) fn attempt(&mut self) -> Result<(), Trouble> {
        if !goes_on(self.download, self.part) {
            self.part.restart(None)?;
        } else if self.download.size_bytes == Some(self.bytes()) {
            return Ok(());
        }
        let mut response = self.ask()?;
        let version = version(&response);
        let total = match Meaning::of(&response, self.bytes()) {
            Meaning::Rest { total } if self.belongs(version.as_ref()) => total,
            Meaning::Rest { .. } => return self.cannot_go_on(),
            Meaning::Whole { total } => {
                measured(self.download, total)?;
                self.begin(version)?;
                total
            }
            Meaning::NothingBehind { total } if total == Some(self.bytes()) => return Ok(()),
            Meaning::NothingBehind { .. } => return self.cannot_go_on(),
            Meaning::Busy(status) => {
                return Err(Trouble::MayPass(format!("the server says {status}")));
            }
            Meaning::Refused(status) => {
                let url = self.download.url.clone();
                return Err(FetchError::Refused { url, status }.into());
            }
        };
        let total = measured(self.download, total)?;
        self.copy(response.body_mut(), total)
    }

    fn ask(&self) -> Result<Response<Body>, Trouble> {
        let mut request = self
            .agent
            .get(&self.download.url)
            // A compressed answer would have another length, and no ranges of its own.
            .header(header::ACCEPT_ENCODING, "identity");
        if self.bytes() > 0 {
            request = request.header(header::RANGE, format!("bytes={}-", self.bytes()));
            let version = self.part.origin().and_then(|from| from.version.as_ref());
            if let Some(version) = version {
                request = request.header(header::IF_RANGE, version);
            }
        }
        request.call().map_err(|error| {
            if may_pass(&error) {
                return Trouble::MayPass(error.to_string());
            }
            Trouble::Stays(FetchError::Unusable {
                url: self.download.url.clone(),
                reason: error.to_string(),
            })
        })
    }

    /// Whether an answer is of the version that the part is of. Servers that do not know `If-Range` send the rest
    /// of whatever they have now.
    fn belongs(&self, version: Option<&String>) -> bool {
        let known = self.part.origin().and_then(|from| from.version.as_ref());
        known.is_none() || version.is_none() || known == version
    }

    fn begin(&mut self, version: Option<String>) -> Result<(), FetchError> {
        if self.bytes() > 0 {
            self.tell(News::Anew);
        }
        self.part.restart(Some(PartOf {
            url: self.download.url.clone(),
            version,
        }))?;
        Ok(())
    }

    fn cannot_go_on(&mut self) -> Result<(), Trouble> {
        let bytes = self.bytes();
        self.part.restart(None)?;
        Err(Trouble::MayPass(format!(
            "the server has nothing that fits behind the {bytes} bytes that are there"
        )))
    }

    fn copy(&mut self, body: &mut Body, total: Option<u64>) -> Result<(), Trouble> {
        let mut reader = body.as_reader();
        let mut chunk = vec![0; CHUNK_BYTES];
        loop {
            let bytes = self.bytes();
            self.tell(News::Has { bytes, total });
            let read = match reader.read(&mut chunk) {
                Ok(0) => break,
                Ok(read) => read,
                Err(error) => return Err(Trouble::MayPass(broke_off(&error, bytes, total))),
            };
            if let Some(expected) = total.filter(|total| bytes + read as u64 > *total) {
                return Err(Trouble::Stays(FetchError::WrongLength {
                    url: self.download.url.clone(),
                    found: None,
                    expected,
                }));
            }
            self.part.append(&chunk[..read])?;
        }
        if total.is_some_and(|total| self.bytes() < total) {
            let ended = io::ErrorKind::UnexpectedEof.into();
            return Err(Trouble::MayPass(broke_off(&ended, self.bytes(), total)));
        }
        Ok(())
    }
}

/// Whether what is there may be gone on with. The server tells by its word for the version, or the hash does at the
/// end; without either, the halves of two files could be joined unnoticed.
fn goes_on(download: &Download, part: &Part) -> bool {
    let may_be_checked =
        |from: &PartOf| from.version.is_some() || download.checksum != Checksum::Unknown;
    let of_this = |from: &PartOf| from.url == download.url && may_be_checked(from);
    let fits = download.size_bytes.is_none_or(|size| part.len() <= size);
    fits && part.origin().is_some_and(of_this)
}

/// The length of the whole, as the server and the registry agree on it.
fn measured(download: &Download, said: Option<u64>) -> Result<Option<u64>, FetchError> {
    let url = || download.url.clone();
    match (said, download.size_bytes) {
        (Some(said), Some(expected)) if said != expected => Err(FetchError::WrongLength {
            url: url(),
            found: Some(said),
            expected,
        }),
        (None, None) if download.checksum == Checksum::Unknown => {
            Err(FetchError::Unmeasured { url: url() })
        }
        (said, expected) => Ok(said.or(expected)),
    }
}

fn broke_off(error: &io::Error, bytes: u64, total: Option<u64>) -> String {
    let of = total
        .map(|total| format!(" of {total}"))
        .unwrap_or_default();
    format!("it broke off after {bytes}{of} bytes ({error})")
}

fn agent(options: &FetchOptions) -> Agent {
    let proxy = match options.proxy {
        // The library reads the environment here: its rules for exceptions are many.
        Proxy::AsUsual => ureq::Proxy::try_from_env(),
        Proxy::Never => None,
    };
    let config = Agent::config_builder()
        .user_agent(concat!("roadwatch/", env!("CARGO_PKG_VERSION")))
        // A status is an answer here: the module `response` says what it means.
        .http_status_as_error(false)
        .timeout_connect(Some(options.connect_timeout))
        .timeout_recv_response(Some(options.read_timeout))
        .timeout_per_read(Some(options.read_timeout))
        .proxy(proxy)
        .build();
    config.into()
}

fn may_pass(error: &ureq::Error) -> bool {
    use ureq::Error;
    matches!(
        error,
        Error::Io(_)
            | Error::Timeout(_)
            | Error::HostNotFound
            | Error::ConnectionFailed
            | Error::Protocol(_)
    )
}
