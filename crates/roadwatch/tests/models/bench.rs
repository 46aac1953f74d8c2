//! A file to fetch from a server with a script, and what is expected then.

use crate::server::{Request, Server, Turn};
use roadwatch::models::{
    Arrival, Checksum, Download, FetchError, FetchOptions, Fetched, News, Proxy, Sha256, fetch,
};
use std::{fs, path::PathBuf, time::Duration};
use tempfile::TempDir;

pub(crate) const SIZE: usize = 300_000;
/// Where servers break off.
pub(crate) const BROKEN_AT: usize = 100_000;

/// A file to fetch into a folder of its own.
pub(crate) struct Bench {
    pub(crate) folder: TempDir,
    pub(crate) content: Vec<u8>,
    checksum: Checksum,
    size_bytes: Option<u64>,
    pub(crate) news: Vec<News>,
}

impl Bench {
    pub(crate) fn new() -> Self {
        let content: Vec<u8> = (0..SIZE as u32)
            .flat_map(u32::to_le_bytes)
            .take(SIZE)
            .collect();
        Self {
            folder: tempfile::tempdir().expect("a folder"),
            checksum: Checksum::Known(Sha256::of_bytes(&content)),
            size_bytes: Some(SIZE as u64),
            content,
            news: Vec::new(),
        }
    }

    pub(crate) fn sized(self, size_bytes: Option<u64>) -> Self {
        Self { size_bytes, ..self }
    }

    pub(crate) fn unchecked(self) -> Self {
        Self {
            checksum: Checksum::Unknown,
            ..self
        }
    }

    pub(crate) fn server(&self, script: &[Turn]) -> Server {
        Server::start(&self.content, script)
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.folder.path().join("models/model.onnx")
    }

    pub(crate) fn fetch(&mut self, url: &str, tries: u32) -> Result<Fetched, FetchError> {
        let download = Download {
            url: url.to_owned(),
            to: self.path(),
            checksum: self.checksum,
            size_bytes: self.size_bytes,
        };
        let options = FetchOptions {
            connect_timeout: Duration::from_secs(5),
            read_timeout: Duration::from_millis(200),
            tries,
            first_pause: Duration::from_millis(1),
            longest_pause: Duration::from_millis(4),
            proxy: Proxy::Never,
        };
        fetch(&download, &options, &mut |news| self.news.push(news))
    }

    /// Serves by `script`, fetches, and expects what came to be right. Gives the requests.
    pub(crate) fn expect_well(&mut self, script: &[Turn]) -> Vec<Request> {
        let server = self.server(script);
        let fetched = self.fetch(&server.url(), 3).expect("it is fetched");
        assert_eq!(fetched.arrival, Arrival::Now);
        assert_eq!(fetched.size_bytes, SIZE as u64);
        self.expect_whole();
        server.requests()
    }

    pub(crate) fn expect_whole(&self) {
        assert_eq!(fs::read(self.path()).expect("the file"), self.content);
        assert_eq!(self.left(), ["model.onnx"]);
    }

    /// Serves by `script`, fetches, and expects that to fail without a file of the final name.
    pub(crate) fn expect_failure(&mut self, script: &[Turn]) -> (FetchError, Vec<Request>) {
        let server = self.server(script);
        let error = self.fetch(&server.url(), 3).expect_err("it fails");
        assert!(!self.path().exists());
        (error, server.requests())
    }

    /// What lies in the folder.
    pub(crate) fn left(&self) -> Vec<String> {
        let folder = self.folder.path().join("models");
        let mut names: Vec<_> = fs::read_dir(folder)
            .expect("the folder")
            .map(|entry| {
                entry
                    .expect("an entry")
                    .file_name()
                    .into_string()
                    .expect("text")
            })
            .collect();
        names.sort();
        names
    }

    pub(crate) fn breaks(&self) -> usize {
        let again = |news: &&News| matches!(news, News::Again { .. });
        self.news.iter().filter(again).count()
    }
}

pub(crate) fn ranges(requests: &[Request]) -> Vec<Option<&str>> {
    requests
        .iter()
        .map(|request| request.range.as_deref())
        .collect()
}

/// How the rest is asked for.
pub(crate) const REST: Option<&str> = Some("bytes=100000-");
