//! The images of one topic of a recorded bag.

use super::{
    ImageMessage,
    bag_error::{BagImagesError, COMPRESSED, RAW},
    bag_file::{TopicReader, summary},
    stands_still,
};
use crate::{
    cdr,
    msg::sensor_msgs::{CompressedImage, Image},
};
use mcap::{McapError, Summary, sans_io::indexed_reader::ReadOrder};
use roadwatch_core::{SourceError, Timestamp};
use std::{
    collections::BTreeSet,
    fmt, fs, io,
    path::{Path, PathBuf},
};

const EXTENSION: &str = "mcap";

/// What a bag's images cover in time, by their stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BagSpan {
    /// Stamp of the first.
    pub first: Timestamp,
    /// Stamp of the last.
    pub last: Timestamp,
    /// Number of images.
    pub count: u64,
}

pub(super) struct OneFile {
    pub(super) path: PathBuf,
    pub(super) summary: Summary,
}

/// The images of one topic, one after the other, with the stamps in their headers.
pub struct BagImages {
    topic: String,
    files: Vec<OneFile>,
    compressed: bool,
    span: BagSpan,
    /// File that is being read, and the reader of it.
    at: usize,
    reader: Option<TopicReader>,
    next: Option<Next>,
    last_stamp: Option<Timestamp>,
}

/// What stands at the front.
enum Next {
    Image(ImageMessage),
    /// No image that could follow those before it, and why.
    Lost(String),
}

impl fmt::Debug for BagImages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BagImages({}, {:?})", self.topic, self.span)
    }
}

impl BagImages {
    /// Opens an `.mcap` file, or a folder with the files of one recording, and looks for `topic`.
    ///
    /// # Errors
    /// When there is no bag, no such topic, or no image on it.
    pub fn open(path: &Path, topic: &str) -> Result<Self, BagImagesError> {
        let files = files(path)?;
        let count = check_topic(path, &files, topic)?;
        let mut images = Self {
            topic: topic.to_owned(),
            compressed: files
                .iter()
                .any(|file| type_of(&file.summary, topic) == Some(COMPRESSED)),
            files,
            span: BagSpan {
                first: Timestamp::default(),
                last: Timestamp::default(),
                count,
            },
            at: 0,
            reader: None,
            next: None,
            last_stamp: None,
        };
        images.span.last = images.stamp_of_last(path)?;
        let damaged = |source: SourceError| BagImagesError::Damaged {
            path: path.to_owned(),
            source: McapError::Io(io::Error::other(source)),
        };
        images.span.first = images.next_stamp().map_err(damaged)?.unwrap_or_default();
        Ok(images)
    }

    /// What the images cover in time.
    #[must_use]
    pub fn span(&self) -> BagSpan {
        self.span
    }

    /// The stamp of the image that [`BagImages::take`] gives next; `None` behind the last. Stamps rise: an image whose
    /// stamp does not is lost, at the stamp of the one before it.
    ///
    /// # Errors
    /// When the file cannot be read any more.
    pub fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError> {
        if self.next.is_none() {
            let Some(bytes) = self.next_message()? else {
                return Ok(None);
            };
            self.next = Some(self.look_at(&bytes));
        }
        Ok(match &self.next {
            Some(Next::Image(image)) => Some(image.stamp()),
            _ => Some(self.last_stamp.unwrap_or_default()),
        })
    }

    /// The image whose stamp [`BagImages::next_stamp`] gave.
    ///
    /// # Errors
    /// [`SourceError::FrameLost`] when it is damaged or out of order.
    pub fn take(&mut self) -> Result<ImageMessage, SourceError> {
        self.next_stamp()?;
        match self.next.take() {
            Some(Next::Image(image)) => {
                self.last_stamp = Some(image.stamp());
                Ok(image)
            }
            Some(Next::Lost(why)) => Err(SourceError::FrameLost(
                format!("{}: {why}", self.topic).into(),
            )),
            None => Err(SourceError::EndOfStream),
        }
    }

    /// Goes back to the first image.
    pub fn rewind(&mut self) {
        self.at = 0;
        self.reader = None;
        self.next = None;
        self.last_stamp = None;
    }

    fn next_message(&mut self) -> Result<Option<Vec<u8>>, SourceError> {
        let gone = |error: McapError| SourceError::Disconnected(error.into());
        while let Some(file) = self.files.get(self.at) {
            if self.reader.is_none() {
                let opened =
                    TopicReader::open(&file.path, &file.summary, &self.topic, ReadOrder::LogTime);
                self.reader = Some(opened.map_err(gone)?);
            }
            if let Some(reader) = &mut self.reader
                && let Some(message) = reader.next().map_err(gone)?
            {
                return Ok(Some(message));
            }
            self.reader = None;
            self.at += 1;
        }
        Ok(None)
    }

    fn look_at(&self, bytes: &[u8]) -> Next {
        let image = match self.decoded(bytes) {
            Ok(image) => image,
            Err(error) => return Next::Lost(error.to_string()),
        };
        match self.last_stamp {
            Some(last) if image.stamp() <= last => Next::Lost(stands_still(image.stamp(), last)),
            _ => Next::Image(image),
        }
    }

    fn decoded(&self, bytes: &[u8]) -> Result<ImageMessage, cdr::DecodeError> {
        Ok(match self.compressed {
            true => ImageMessage::Compressed(cdr::decode::<CompressedImage>(bytes)?),
            false => ImageMessage::Raw(cdr::decode::<Image>(bytes)?),
        })
    }

    fn stamp_of_last(&self, path: &Path) -> Result<Timestamp, BagImagesError> {
        let damaged = |source| BagImagesError::Damaged {
            path: path.to_owned(),
            source,
        };
        let mut last = Timestamp::default();
        for file in &self.files {
            let order = ReadOrder::ReverseLogTime;
            let reader = TopicReader::open(&file.path, &file.summary, &self.topic, order);
            let bytes = reader
                .and_then(|mut reader| reader.next())
                .map_err(damaged)?;
            let image = bytes.and_then(|bytes| self.decoded(&bytes).ok());
            last = image.map_or(last, |image| last.max(image.stamp()));
        }
        Ok(last)
    }
}

/// The bag's files, in order of their names' numbers, as `ros2 bag` numbers them.
pub(super) fn files(path: &Path) -> Result<Vec<OneFile>, BagImagesError> {
    let mut paths = vec![path.to_owned()];
    if path.is_dir() {
        let unreadable = |source| BagImagesError::Unreadable {
            path: path.to_owned(),
            source,
        };
        let entries = fs::read_dir(path).map_err(unreadable)?;
        let entries = entries.collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
        let all = entries.into_iter().map(|entry| entry.path());
        paths = all
            .filter(|path| path.extension().is_some_and(|end| end == EXTENSION))
            .collect();
        paths.sort_by_key(|path| (number(path), path.clone()));
    }
    if paths.is_empty() || !paths.iter().all(|path| path.is_file()) {
        return Err(BagImagesError::NoBag(path.to_owned()));
    }
    let opened = paths.into_iter().map(|path| match summary(&path) {
        Ok(Some(summary)) => Ok(OneFile { path, summary }),
        Ok(None)
        | Err(McapError::BadMagic | McapError::UnexpectedEof | McapError::UnexpectedEoc) => {
            Err(BagImagesError::NotFinished(path))
        }
        Err(source) => Err(BagImagesError::Damaged { path, source }),
    });
    opened.collect()
}

/// The number at the end of a file's name, as in `drive_12.mcap`.
fn number(path: &Path) -> u64 {
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let digits = stem.and_then(|stem| stem.rsplit_once('_'));
    digits
        .and_then(|(_, digits)| digits.parse().ok())
        .unwrap_or(0)
}

pub(super) fn type_of<'a>(summary: &'a Summary, topic: &str) -> Option<&'a str> {
    let mut channels = summary.channels.values();
    let channel = channels.find(|channel| channel.topic == topic)?;
    channel.schema.as_ref().map(|schema| schema.name.as_str())
}

/// The number of messages on the topic.
fn check_topic(path: &Path, files: &[OneFile], topic: &str) -> Result<u64, BagImagesError> {
    let found: BTreeSet<_> = files
        .iter()
        .filter_map(|file| type_of(&file.summary, topic))
        .collect();
    if let Some(other) = found.iter().find(|name| ![RAW, COMPRESSED].contains(name)) {
        return Err(BagImagesError::OtherType {
            path: path.to_owned(),
            topic: topic.to_owned(),
            found: (*other).to_owned(),
        });
    }
    let channels = || {
        files
            .iter()
            .flat_map(|file| file.summary.channels.values().map(move |c| (file, c)))
    };
    let count = |(file, channel): (&OneFile, &std::sync::Arc<mcap::Channel<'_>>)| {
        let counts = file
            .summary
            .stats
            .as_ref()
            .map(|stats| &stats.channel_message_counts);
        counts
            .and_then(|counts| counts.get(&channel.id).copied())
            .unwrap_or(0)
    };
    let messages: u64 = channels()
        .filter(|(_, channel)| channel.topic == topic)
        .map(count)
        .sum();
    if messages > 0 {
        return Ok(messages);
    }
    let is_image = |channel: &mcap::Channel<'_>| {
        let schema = channel.schema.as_ref();
        schema.is_some_and(|schema| [RAW, COMPRESSED].contains(&schema.name.as_str()))
    };
    let topics = channels().filter(|(_, channel)| is_image(channel));
    Err(BagImagesError::NoTopic {
        path: path.to_owned(),
        topic: topic.to_owned(),
        topics: topics.map(|(_, channel)| channel.topic.clone()).collect(),
    })
}
