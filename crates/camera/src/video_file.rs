//! Video files: any container that OpenCV's FFmpeg opens.

use crate::{
    frame_rate::FrameRate, mat::fill_pixels, player::Recording, span::Span, video_clock::VideoClock,
};
use opencv::{
    prelude::*,
    videoio::{
        CAP_FFMPEG, CAP_PROP_FPS, CAP_PROP_FRAME_COUNT, CAP_PROP_FRAME_HEIGHT,
        CAP_PROP_FRAME_WIDTH, CAP_PROP_ORIENTATION_AUTO, CAP_PROP_POS_MSEC, VideoCapture,
    },
};
use roadwatch_core::{DecodeError, Image, ImageSize, SourceError, Timestamp};
use std::{
    fs::File,
    io,
    path::{Path, PathBuf},
    time::Duration,
};

/// A file that cannot be played as a camera.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The file is not there or not ours to read.
    #[error("the video `{}` cannot be read", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// FFmpeg does not take it for a video.
    #[error(
        "`{}` is not a video that FFmpeg can open: it is of another kind, or truncated before its index",
        file.display()
    )]
    NotAVideo {
        /// The file.
        file: PathBuf,
    },
    /// OpenCV failed.
    #[error("OpenCV failed on the video `{}`", file.display())]
    OpenCv {
        /// The file.
        file: PathBuf,
        /// What it says.
        source: opencv::Error,
    },
    /// The images are of another size than the camera's.
    #[error("the video `{}` is {found}, the rig says {expected}", file.display())]
    OtherSize {
        /// The file.
        file: PathBuf,
        /// The video's.
        found: ImageSize,
        /// The camera's.
        expected: ImageSize,
    },
    /// The header has no usable frame rate.
    #[error(
        "the video `{}` says it has {hz} frames per second: convert it to a constant frame rate",
        file.display()
    )]
    NoRate {
        /// The file.
        file: PathBuf,
        /// The header's frames per second.
        hz: f64,
    },
    /// Another number of frames than stamps.
    #[error("the video `{}` has {found} frames, and {stamps} stamps are given for them", file.display())]
    OtherCount {
        /// The file.
        file: PathBuf,
        /// Frames in the file.
        found: u64,
        /// Stamps given.
        stamps: usize,
    },
    /// There is no frame in it.
    #[error("the video `{}` has no frame", file.display())]
    NoFrames {
        /// The file.
        file: PathBuf,
    },
}

/// A video file as a recording.
///
/// A frame's stamp is the one listed for it or, where none are listed, the start plus its presentation time, made
/// exact where it follows the header's frame rate.
/// The decoder holds one frame at a time, so each image is decoded here, before it is due, and not when
/// somebody looks: replaced frames of a video have cost their decoding. Where the file breaks off inside a frame,
/// FFmpeg may still give that last one, partly invented.
#[derive(Debug)]
pub struct VideoFile {
    file: PathBuf,
    size: ImageSize,
    stamps: Stamps,
    rate: FrameRate,
    frames_in_header: u64,
    lap: Lap,
    short_lap: ShortLap,
}

/// Where stamps come from.
#[derive(Debug)]
enum Stamps {
    /// The container's presentation times, counted from this.
    Container(Timestamp),
    /// One for each frame, at least one.
    Listed(Vec<Timestamp>, Span),
}

/// One pass through the file.
#[derive(Debug)]
struct Lap {
    capture: VideoCapture,
    clock: VideoClock,
    frames_read: u64,
    stage: Stage,
}

/// Where the decoder stands.
#[derive(Clone, Copy, Debug)]
enum Stage {
    BetweenFrames,
    Holding(Timestamp),
    AtEnd,
}

/// Whether it was said that the file has fewer frames than its header; once is enough for a looped video.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ShortLap {
    Unsaid,
    Said,
}

impl VideoFile {
    /// Opens a video whose first frame was captured at `start`. A file whose header does not count its frames
    /// is read through once.
    ///
    /// # Errors
    /// When the file cannot be read, is no video, has no frame or no frame rate, or is not `size`.
    pub fn open(path: &Path, size: ImageSize, start: Timestamp) -> Result<Self, VideoError> {
        Self::with_stamps(path, size, Stamps::Container(start))
    }

    /// Opens a video whose frames were captured at these rising `stamps`.
    ///
    /// # Errors
    /// As for [`VideoFile::open`], and when there are more or fewer stamps than frames.
    pub fn open_stamped(
        path: &Path,
        size: ImageSize,
        stamps: Vec<Timestamp>,
    ) -> Result<Self, VideoError> {
        let count = stamps.len();
        let other_count = |found| VideoError::OtherCount {
            file: path.to_owned(),
            found,
            stamps: count,
        };
        let span = Span::from_stamps(stamps.iter().copied()).ok_or_else(|| other_count(0))?;
        let video = Self::with_stamps(path, size, Stamps::Listed(stamps, span))?;
        if video.frames_in_header == count as u64 {
            Ok(video)
        } else {
            Err(other_count(video.frames_in_header))
        }
    }

    fn with_stamps(path: &Path, size: ImageSize, stamps: Stamps) -> Result<Self, VideoError> {
        let file = || path.to_owned();
        let opencv = |source| VideoError::OpenCv {
            file: path.to_owned(),
            source,
        };
        let capture = open_capture(path)?;
        let found = frame_size(&capture).map_err(opencv)?;
        if found != size {
            return Err(VideoError::OtherSize {
                file: file(),
                found,
                expected: size,
            });
        }
        let hz = capture.get(CAP_PROP_FPS).map_err(opencv)?;
        let rate = FrameRate::from_hz(hz).ok_or_else(|| VideoError::NoRate { file: file(), hz })?;
        let frames_in_header = match header_frames(&capture).map_err(opencv)? {
            Some(frames) => frames,
            None => count_frames(open_capture(path)?).map_err(opencv)?,
        };
        if frames_in_header == 0 {
            return Err(VideoError::NoFrames { file: file() });
        }
        Ok(Self {
            file: file(),
            size,
            stamps,
            rate,
            frames_in_header,
            lap: Lap::new(capture, rate),
            short_lap: ShortLap::Unsaid,
        })
    }

    /// A video that breaks off is played as far as it goes; that is worth a warning, not a failure.
    fn warn_if_short(&mut self) {
        let frames_read = self.lap.frames_read;
        if frames_read >= self.frames_in_header || self.short_lap == ShortLap::Said {
            return;
        }
        self.short_lap = ShortLap::Said;
        tracing::warn!(
            file = %self.file.display(),
            frames_read,
            frames_in_header = self.frames_in_header,
            "video ended before its last frame"
        );
    }
}

impl Stamps {
    /// The stamp of a frame with its place and its offset from the first; `None` behind the last listed one.
    fn of(&self, place: u64, offset: Duration) -> Option<Timestamp> {
        match self {
            Self::Container(start) => Some(start.saturating_add(offset)),
            Self::Listed(stamps, _) => stamps.get(usize::try_from(place).ok()?).copied(),
        }
    }
}

impl Lap {
    fn new(capture: VideoCapture, rate: FrameRate) -> Self {
        Self {
            capture,
            clock: VideoClock::new(rate),
            frames_read: 0,
            stage: Stage::BetweenFrames,
        }
    }

    /// Decodes the next frame into the decoder; its offset from the first one, `None` at the end.
    fn grab(&mut self) -> opencv::Result<Option<Duration>> {
        if !self.capture.grab()? {
            return Ok(None);
        }
        self.frames_read += 1;
        let position_msec = self.capture.get(CAP_PROP_POS_MSEC)?;
        Ok(Some(self.clock.advance(position_msec)))
    }
}

impl Recording for VideoFile {
    fn span(&self) -> Span {
        match &self.stamps {
            Stamps::Container(start) => Span {
                first: *start,
                last: start.saturating_add(self.rate.offset(self.frames_in_header - 1)),
                interval: self.rate.interval(),
            },
            Stamps::Listed(_, span) => *span,
        }
    }

    fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError> {
        match self.lap.stage {
            Stage::Holding(stamp) => return Ok(Some(stamp)),
            Stage::AtEnd => return Ok(None),
            Stage::BetweenFrames => {}
        }
        match self.lap.grab() {
            Ok(Some(offset)) => {
                let stamp = self.stamps.of(self.lap.frames_read - 1, offset);
                self.lap.stage = stamp.map_or(Stage::AtEnd, Stage::Holding);
                Ok(stamp)
            }
            Ok(None) => {
                self.lap.stage = Stage::AtEnd;
                self.warn_if_short();
                Ok(None)
            }
            Err(error) => {
                // A decoder that threw is not asked again: it could throw for ever.
                self.lap.stage = Stage::AtEnd;
                Err(SourceError::FrameLost(Box::new(error)))
            }
        }
    }

    fn take_image(&mut self) -> Result<Image, SourceError> {
        self.lap.stage = Stage::BetweenFrames;
        let capture = &mut self.lap.capture;
        fill_pixels(self.size, |mat| capture.retrieve_def(mat).map(|_filled| ()))
            .map(Image::decoded)
            .map_err(|error| {
                let reason = format!("`{}`: {error}", self.file.display());
                SourceError::FrameLost(Box::new(DecodeError::new(reason)))
            })
    }

    fn rewind(&mut self) -> Result<(), SourceError> {
        let capture =
            open_capture(&self.file).map_err(|error| SourceError::Disconnected(Box::new(error)))?;
        self.lap = Lap::new(capture, self.rate);
        Ok(())
    }
}

/// Width and height of a video's frames, for those who do not know them beforehand.
///
/// # Errors
/// When the file cannot be read or is no video.
pub fn video_size(path: &Path) -> Result<ImageSize, VideoError> {
    let capture = open_capture(path)?;
    frame_size(&capture).map_err(|source| VideoError::OpenCv {
        file: path.to_owned(),
        source,
    })
}

/// Names FFmpeg as the back end, because others take file names for patterns or pipelines.
fn open_capture(path: &Path) -> Result<VideoCapture, VideoError> {
    let file = path.to_owned();
    if let Err(source) = File::open(path) {
        return Err(VideoError::Unreadable { file, source });
    }
    match ffmpeg_capture(path) {
        Ok(Some(capture)) => Ok(capture),
        Ok(None) => Err(VideoError::NotAVideo { file }),
        Err(source) => Err(VideoError::OpenCv { file, source }),
    }
}

fn ffmpeg_capture(path: &Path) -> opencv::Result<Option<VideoCapture>> {
    let mut capture = VideoCapture::from_file(path, CAP_FFMPEG)?;
    if !capture.is_opened()? {
        return Ok(None);
    }
    // The rig describes the sensor's own rows and columns, so a phone's orientation must not turn them.
    if !capture.set(CAP_PROP_ORIENTATION_AUTO, 0.0)? {
        tracing::debug!("this FFmpeg back end never turns images");
    }
    Ok(Some(capture))
}

pub(crate) fn frame_size(capture: &VideoCapture) -> opencv::Result<ImageSize> {
    Ok(ImageSize {
        width_px: capture.get(CAP_PROP_FRAME_WIDTH)? as u32,
        height_px: capture.get(CAP_PROP_FRAME_HEIGHT)? as u32,
    })
}

/// `None` when the header does not count them; OpenCV then gives zero or a large negative number.
fn header_frames(capture: &VideoCapture) -> opencv::Result<Option<u64>> {
    let frames = capture.get(CAP_PROP_FRAME_COUNT)?;
    Ok((frames >= 1.0).then_some(frames as u64))
}

fn count_frames(mut capture: VideoCapture) -> opencv::Result<u64> {
    let mut frames = 0;
    while capture.grab()? {
        frames += 1;
    }
    Ok(frames)
}
