//! Recording: a folder with one MCAP file and `metadata.yaml`, as `ros2 bag` and others read it.

mod metadata;
mod recording;

use crate::{
    convert::{Messages, Outgoing},
    surface::{InvalidSurface, Surface},
};
use recording::Recording;
use roadwatch_core::{Output, Rig, Sink, SinkError, Timestamp};
use std::{
    error::Error,
    fmt,
    fs::{self, File},
    io::{self, BufWriter},
    path::{Path, PathBuf},
    sync::Arc,
};

pub use metadata::Summary;
pub use recording::RecordingError;

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

/// Records exactly what [`crate::RosSink`] publishes, in the same order.
///
/// `/tf_static` is recorded once, with the stamp of the first output. After a failed write (a full
/// disk) nothing more is written: every further output is an error, and what was written before stays
/// readable to `mcap recover`. A sink that is dropped unfinished is finished as far as that works.
#[derive(Debug)]
pub struct BagSink {
    messages: Messages,
    log_time: LogTime,
    recording: Recording<BufWriter<File>>,
    folder: PathBuf,
    file_name: String,
    stage: Stage,
}

/// How far a recording is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Nothing is recorded, so `/tf_static` has no stamp yet.
    Empty,
    Recording,
    Finished,
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
        log_time: LogTime,
    ) -> Result<Self, BagError> {
        let messages = Messages::new(rig, surface)?;
        let folder = empty_folder(folder)?;
        let file_name = format!(
            "{}_0.mcap",
            folder.file_name().unwrap_or("bag".as_ref()).display()
        );
        let path = folder.join(&file_name);
        let file = match File::create_new(&path) {
            Ok(file) => BufWriter::new(file),
            Err(source) => return Err(BagError::File { path, source }),
        };
        let recording = Recording::begin(file, messages.topics())
            .map_err(|source| BagError::Start { path, source })?;
        Ok(Self {
            messages,
            log_time,
            recording,
            folder,
            file_name,
            stage: Stage::Empty,
        })
    }

    fn outgoing(&mut self, output: &Output) -> Vec<Outgoing> {
        let mut outgoing = Vec::new();
        if self.stage == Stage::Empty {
            outgoing.push(self.messages.tf_static(output.stamp()));
            self.stage = Stage::Recording;
        }
        outgoing.extend(self.messages.of(output));
        outgoing
    }

    fn write_ending(&mut self) -> Result<(), SinkError> {
        let not_finished =
            |cause: Box<dyn Error + Send + Sync>| SinkError::new("bag not finished", cause);
        let summary = self.recording.summary();
        let metadata = metadata::yaml(&self.file_name, self.messages.topics(), &summary);
        let file = self
            .recording
            .finish(&metadata)
            .map_err(|e| not_finished(e.into()))?;
        file.into_inner()
            .map_err(io::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .and_then(|()| fs::write(self.folder.join("metadata.yaml"), &metadata))
            .map_err(|e| not_finished(e.into()))
    }

    /// What is recorded so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        self.recording.summary()
    }
}

impl Sink for BagSink {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let logged_at = match &self.log_time {
            LogTime::Stamp => output.stamp(),
            LogTime::WallClock(now) => now(),
        };
        let outgoing = self.outgoing(output);
        self.recording
            .write(&outgoing, logged_at)
            .map_err(|cause| SinkError::new("output not recorded", cause))
    }

    fn finish(&mut self) -> Result<(), SinkError> {
        if self.stage == Stage::Finished {
            return Ok(());
        }
        self.stage = Stage::Finished;
        self.write_ending()
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
