//! Recording: a folder with MCAP files and `metadata.yaml`, as `ros2 bag` and others read it.

mod images;
mod metadata;
mod recording;
mod sealed_file;

use crate::{
    convert::{Messages, Outgoing},
    surface::{InvalidSurface, Surface},
    topics::{Topic, Topics},
};
use metadata::Part;
use recording::Recording;
use roadwatch_core::{Output, Rig, Sink, SinkError, Timestamp};
use sealed_file::SealedFile;
use std::{
    error::Error,
    fmt,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

pub use images::{EncodeImage, EncodedImage};
pub use metadata::Summary;
pub use recording::RecordingError;

/// How much of recorded time a killed recording loses at most: then what was taken is in the file.
const FLUSH_AFTER: Duration = Duration::from_secs(1);
const METADATA_FILE: &str = "metadata.yaml";

/// What the log time of a message is; its publish time is the same.
pub enum LogTime {
    /// The stamp of its output, so that the same input gives the same bytes.
    Stamp,
    /// What this clock says when the output is recorded.
    WallClock(Box<dyn Fn() -> Timestamp + Send>),
}

impl fmt::Debug for LogTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stamp => "Stamp",
            Self::WallClock(_) => "WallClock",
        })
    }
}

/// How a bag is recorded.
pub struct BagOptions {
    /// Times in it.
    pub log_time: LogTime,
    /// A file of at least so many bytes is followed by another one; `None` for one file.
    pub split_bytes: Option<u64>,
    /// A file of at least so much time is followed by another one; `None` for one file.
    pub split_after: Option<Duration>,
    /// How the cameras' images are written; `None` to leave them out.
    pub images: Option<EncodeImage>,
}

impl BagOptions {
    /// One file without images.
    #[must_use]
    pub fn new(log_time: LogTime) -> Self {
        Self {
            log_time,
            split_bytes: None,
            split_after: None,
            images: None,
        }
    }
}

/// Why a recording could not begin.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// Somebody else's files are there.
    #[error("{} exists and is not empty: choose another folder or remove it", .0.display())]
    NotEmpty(PathBuf),
    /// The folder cannot be made or read.
    #[error("{} cannot be used as a folder for a bag: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file cannot be made.
    #[error("{} cannot be written: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The first bytes could not be written.
    #[error("recording to {} cannot begin: {source}", path.display())]
    Start {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: RecordingError,
    },
    /// A name that ROS 2 would refuse.
    #[error(transparent)]
    Surface(#[from] InvalidSurface),
}

/// Records what [`crate::RosSink`] publishes where everything is read, in the same order, and images on request.
///
/// `/tf_static` stands at the beginning of each file, with the stamp of that file's first output. `metadata.yaml` is
/// there from the beginning, and up to date to a second, so that a killed recording can be read. After a failed write
/// (a full disk) nothing more is written: every further output is an error, and what was written before stays readable
/// to `mcap recover`. A sink that is dropped unfinished is finished as far as that works.
pub struct BagSink {
    messages: Messages,
    options: BagOptions,
    topics: Vec<Topic>,
    folder: PathBuf,
    /// Files that are complete.
    parts: Vec<Part>,
    recording: Recording<SealedFile>,
    /// Whether `/tf_static` is in the present file.
    has_tf: bool,
    flushed_at: Option<Timestamp>,
    finished: bool,
}

impl fmt::Debug for BagSink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "BagSink({}, {:?})",
            self.folder.display(),
            self.summary()
        )
    }
}

impl BagSink {
    /// Makes the folder and begins `<folder>/<name>_0.mcap`, where `<name>` is the folder's.
    ///
    /// # Errors
    /// When the folder exists and holds anything, or cannot be made or written to.
    pub fn create(
        folder: &Path,
        rig: Arc<Rig>,
        surface: &Surface,
        options: BagOptions,
    ) -> Result<Self, BagError> {
        let messages = Messages::new(Arc::clone(&rig), surface)?;
        let mut topics = messages.topics().to_vec();
        if options.images.is_some() {
            topics.extend(Topics::of_images(&rig, surface));
        }
        let folder = empty_folder(folder)?;
        let recording = begin(&folder, 0, &topics)?;
        let bag = Self {
            messages,
            options,
            topics,
            parts: Vec::new(),
            recording,
            has_tf: false,
            flushed_at: None,
            finished: false,
            folder,
        };
        let path = bag.folder.join(METADATA_FILE);
        match bag.write_metadata() {
            Ok(()) => Ok(bag),
            Err(source) => Err(BagError::File { path, source }),
        }
    }

    /// What is recorded so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        Summary::of(&self.all_parts())
    }

    fn outgoing(&mut self, output: &Output) -> Result<Vec<Outgoing>, SinkError> {
        let mut outgoing = Vec::new();
        if !self.has_tf {
            outgoing.push(self.messages.tf_static(output.stamp()));
            self.has_tf = true;
        }
        outgoing.extend(self.messages.of(output));
        if let (Output::Camera(perceived), Some(encode)) = (output, &self.options.images) {
            let first = self.messages.topics().len();
            let frame = &perceived.tracks.frame;
            let name = self.messages.frame_of(frame.camera);
            let image = images::message(frame, name, encode);
            let image = image.map_err(|error| SinkError::new("image not recorded", error))?;
            outgoing.push(Outgoing {
                topic: first + frame.camera.index(),
                message: image,
            });
        }
        Ok(outgoing)
    }

    fn take(&mut self, output: &Output) -> Result<(), SinkError> {
        let logged_at = match &self.options.log_time {
            LogTime::Stamp => output.stamp(),
            LogTime::WallClock(now) => now(),
        };
        let lost = |cause: RecordingError| SinkError::new("output not recorded", cause);
        if self.is_full(logged_at) {
            self.next_file()
                .map_err(|cause| SinkError::new("bag not split", cause))?;
        }
        let outgoing = self.outgoing(output)?;
        self.recording.write(&outgoing, logged_at).map_err(lost)?;
        let flushed_at = *self.flushed_at.get_or_insert(logged_at);
        if logged_at.saturating_since(flushed_at) >= FLUSH_AFTER {
            self.flushed_at = Some(logged_at);
            self.recording.flush().map_err(lost)?;
            if let Err(cause) = self.write_metadata() {
                return Err(lost(self.recording.give_up(cause)));
            }
        }
        Ok(())
    }

    /// Whether the present file is to be followed by another one.
    fn is_full(&self, logged_at: Timestamp) -> bool {
        let span = self.recording.summary().span;
        let age = span.map(|(first, _)| logged_at.saturating_since(first));
        let is_long = self
            .options
            .split_after
            .zip(age)
            .is_some_and(|(most, age)| age >= most);
        let most = self.options.split_bytes;
        is_long || most.is_some_and(|most| self.recording.bytes() >= most)
    }

    fn next_file(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        let number = self.parts.len() + 1;
        let next = begin(&self.folder, number, &self.topics)?;
        self.finish_file()?;
        let part = self.part();
        self.parts.push(part);
        self.recording = next;
        self.has_tf = false;
        Ok(())
    }

    fn finish_file(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        let metadata = metadata::information(&self.topics, &[self.part()]);
        self.recording.finish(&metadata)?.close()?;
        Ok(())
    }

    /// The file that is being written.
    fn part(&self) -> Part {
        Part {
            file_name: file_name(&self.folder, self.parts.len()),
            summary: self.recording.summary(),
        }
    }

    fn all_parts(&self) -> Vec<Part> {
        let mut parts = self.parts.clone();
        parts.push(self.part());
        parts
    }

    /// In one go, so that a reader finds either the old file or the new one.
    fn write_metadata(&self) -> io::Result<()> {
        let text = metadata::yaml(&self.topics, &self.all_parts());
        let new = self.folder.join(format!("{METADATA_FILE}.new"));
        fs::write(&new, text)?;
        fs::rename(new, self.folder.join(METADATA_FILE))
    }
}

impl Sink for BagSink {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        self.take(output)
    }

    fn finish(&mut self) -> Result<(), SinkError> {
        if self.finished {
            return Ok(());
        }
        self.finished = true;
        let not_finished = |cause| SinkError::new("bag not finished", cause);
        self.finish_file().map_err(not_finished)?;
        self.write_metadata().map_err(|e| not_finished(e.into()))
    }
}

impl Drop for BagSink {
    fn drop(&mut self) {
        if let Err(error) = self.finish() {
            tracing::error!(
                folder = %self.folder.display(),
                error = &error as &dyn Error,
                "bag incomplete"
            );
        }
    }
}

/// `<name>_<number>.mcap` in a folder of that name.
fn file_name(folder: &Path, number: usize) -> String {
    let name = folder.file_name().unwrap_or("bag".as_ref());
    format!("{}_{number}.mcap", name.display())
}

fn begin(
    folder: &Path,
    number: usize,
    topics: &[Topic],
) -> Result<Recording<SealedFile>, BagError> {
    let path = folder.join(file_name(folder, number));
    let file = match File::create_new(&path) {
        Ok(file) => SealedFile::new(file),
        Err(source) => return Err(BagError::File { path, source }),
    };
    let begun = Recording::begin(file, topics).and_then(|mut recording| {
        // Should nobody finish it, readers of Jazzy still know by which version to read it.
        let part = Part {
            file_name: file_name(folder, number),
            summary: recording.summary(),
        };
        recording.note(&metadata::information(topics, &[part]))?;
        recording.flush()?;
        Ok(recording)
    });
    begun.map_err(|source| BagError::Start { path, source })
}

/// The folder's absolute path, after making sure that it exists and is empty.
fn empty_folder(path: &Path) -> Result<PathBuf, BagError> {
    let unusable = |source| BagError::Folder {
        path: path.to_owned(),
        source,
    };
    fs::create_dir_all(path).map_err(unusable)?;
    if fs::read_dir(path).map_err(unusable)?.next().is_some() {
        return Err(BagError::NotEmpty(path.to_owned()));
    }
    path.canonicalize().map_err(unusable)
}
