//! A camera that delivers now: a V4L2 device or a network stream, image by image, for who looks at some of them.

use crate::{mat::fill_pixels, video_file::frame_size};
use opencv::{
    core::Vector,
    prelude::*,
    videoio::{
        CAP_FFMPEG, CAP_PROP_BUFFERSIZE, CAP_PROP_OPEN_TIMEOUT_MSEC, CAP_PROP_READ_TIMEOUT_MSEC,
        CAP_V4L2, VideoCapture,
    },
};
use roadwatch_core::{DecodeError, ImageSize, Pixels};

/// A stream that says nothing for so long is taken for dead, milliseconds: key frames come every few seconds.
const STREAM_TIMEOUT_MS: i32 = 5_000;

/// A camera that cannot be looked through.
#[derive(Debug, thiserror::Error)]
pub enum LiveCameraError {
    /// It is neither a device nor an address.
    #[error(
        "`{0}` is no camera: expected a device such as /dev/video0, or an address such as rtsp://HOST/PATH"
    )]
    NoCamera(String),
    /// Nobody answers, or what answers is no video.
    #[error(
        "`{0}` cannot be opened: no such device, not ours to read, in use by another program, or no video comes from there"
    )]
    NotOpened(String),
    /// It was there, and is not any more.
    #[error("`{0}` delivers no more images")]
    Gone(String),
    /// An image came that is none.
    #[error("`{name}` delivered an image that cannot be used")]
    Image {
        /// The camera.
        name: String,
        /// Why.
        source: DecodeError,
    },
    /// OpenCV failed.
    #[error("OpenCV failed on `{name}`")]
    OpenCv {
        /// The camera.
        name: String,
        /// What it says.
        source: opencv::Error,
    },
}

/// An open live camera. Its images carry no stamps: it is for looking, not for the pipeline.
#[derive(Debug)]
pub struct LiveCamera {
    name: String,
    size: ImageSize,
    capture: VideoCapture,
}

impl LiveCamera {
    /// Opens a V4L2 device by its path or anything with an address (`rtsp://`, `http://`, `udp://`) that FFmpeg
    /// plays.
    ///
    /// # Errors
    /// When it is neither, or does not open.
    pub fn open(name: &str) -> Result<Self, LiveCameraError> {
        let failed = |source| LiveCameraError::OpenCv {
            name: name.to_owned(),
            source,
        };
        let capture = if name.contains("://") {
            open_stream(name)
        } else if name.starts_with('/') {
            open_device(name)
        } else {
            return Err(LiveCameraError::NoCamera(name.to_owned()));
        };
        let capture = capture.map_err(failed)?;
        if !capture.is_opened().map_err(failed)? {
            return Err(LiveCameraError::NotOpened(name.to_owned()));
        }
        Ok(Self {
            size: frame_size(&capture).map_err(failed)?,
            name: name.to_owned(),
            capture,
        })
    }

    /// The next image; waits for it, at most some seconds.
    ///
    /// # Errors
    /// When none comes, or one that cannot be used.
    pub fn next_image(&mut self) -> Result<Pixels, LiveCameraError> {
        let grabbed = self.capture.grab();
        let grabbed = grabbed.map_err(|source| LiveCameraError::OpenCv {
            name: self.name.clone(),
            source,
        })?;
        if !grabbed {
            return Err(LiveCameraError::Gone(self.name.clone()));
        }
        let capture = &mut self.capture;
        let filled = fill_pixels(self.size, |mat| capture.retrieve_def(mat).map(|_filled| ()));
        filled.map_err(|source| LiveCameraError::Image {
            name: self.name.clone(),
            source,
        })
    }
}

fn open_stream(address: &str) -> opencv::Result<VideoCapture> {
    let limits = Vector::from_slice(&[
        CAP_PROP_OPEN_TIMEOUT_MSEC,
        STREAM_TIMEOUT_MS,
        CAP_PROP_READ_TIMEOUT_MSEC,
        STREAM_TIMEOUT_MS,
    ]);
    VideoCapture::from_file_with_params(address, CAP_FFMPEG, &limits)
}

fn open_device(path: &str) -> opencv::Result<VideoCapture> {
    let mut capture = VideoCapture::from_file(path, CAP_V4L2)?;
    // The newest image, not one that waited; a driver that cannot is as good, only later.
    if capture.is_opened()? && !capture.set(CAP_PROP_BUFFERSIZE, 1.0)? {
        tracing::debug!(path, "this driver keeps its own number of buffers");
    }
    Ok(capture)
}
