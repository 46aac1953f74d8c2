//! Images on their way through the pipeline: lazily decoded, shared, never copied between stages.

use crate::{camera_model::ImageSize, time::Timestamp};
use std::{
    fmt,
    sync::{Arc, OnceLock},
    time::Instant,
};

/// A camera's position in the rig. The name lives in [`crate::Rig`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CameraId(pub u8);

impl CameraId {
    /// The id as an index into per-camera arrays.
    #[must_use]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Decoded pixels: rows top to bottom, no padding, three bytes a pixel in blue, green, red order.
#[derive(Clone, PartialEq, Eq)]
pub struct Pixels {
    size: ImageSize,
    bgr: Vec<u8>,
}

impl Pixels {
    /// Pixels from `width * height * 3` bytes.
    ///
    /// # Errors
    /// When the number of bytes does not fit the size.
    pub fn new(size: ImageSize, bgr: Vec<u8>) -> Result<Self, DecodeError> {
        let expected = size.width_px as usize * size.height_px as usize * 3;
        if bgr.len() == expected && expected > 0 {
            Ok(Self { size, bgr })
        } else {
            Err(DecodeError::new(format!(
                "{} bytes do not make a {size} image of three bytes a pixel",
                bgr.len()
            )))
        }
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// The bytes, blue green red, row by row.
    #[must_use]
    pub fn bgr(&self) -> &[u8] {
        &self.bgr
    }
}

impl fmt::Debug for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Pixels({})", self.size)
    }
}

/// An image that could not be decoded. The frame is skipped and counted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct DecodeError {
    reason: String,
}

impl DecodeError {
    /// An error that says what is wrong with the image.
    #[must_use]
    pub fn new(reason: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
        }
    }
}

/// Turns what a source delivered into pixels. Called at most once per image.
pub trait DecodeImage: Send + Sync {
    /// The decoded pixels.
    ///
    /// # Errors
    /// When the bytes are truncated, not an image, or of another size than the camera's.
    fn decode(&self) -> Result<Pixels, DecodeError>;

    /// The bytes of a whole JPEG or PNG file, where that is what the source delivered.
    fn as_file(&self) -> Option<&[u8]> {
        None
    }
}

/// An image, decoded when somebody first looks. Clones share it.
#[derive(Clone)]
pub struct Image {
    lazy: Arc<Lazy>,
}

struct Lazy {
    encoded: Option<Box<dyn DecodeImage>>,
    decoded: OnceLock<Result<Pixels, DecodeError>>,
}

impl Image {
    /// An image that is decoded when first looked at.
    #[must_use]
    pub fn encoded(encoded: Box<dyn DecodeImage>) -> Self {
        Self {
            lazy: Arc::new(Lazy {
                encoded: Some(encoded),
                decoded: OnceLock::new(),
            }),
        }
    }

    /// An image that is decoded already, as cameras with raw formats deliver it.
    #[must_use]
    pub fn decoded(pixels: Pixels) -> Self {
        Self {
            lazy: Arc::new(Lazy {
                encoded: None,
                decoded: OnceLock::from(Ok(pixels)),
            }),
        }
    }

    /// The pixels; the first caller pays for decoding, others wait for it.
    ///
    /// # Errors
    /// The same error to every caller when the image cannot be decoded.
    pub fn pixels(&self) -> Result<&Pixels, &DecodeError> {
        self.lazy
            .decoded
            .get_or_init(|| match &self.lazy.encoded {
                Some(encoded) => encoded.decode(),
                None => Err(DecodeError::new("the image has no content")),
            })
            .as_ref()
    }
}

impl Image {
    /// The bytes of a whole JPEG or PNG file, where the source delivered one. They may be damaged.
    #[must_use]
    pub fn as_file(&self) -> Option<&[u8]> {
        self.lazy.encoded.as_ref()?.as_file()
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lazy.decoded.get() {
            Some(decoded) => write!(f, "Image({decoded:?})"),
            None => f.write_str("Image(encoded)"),
        }
    }
}

/// One image of one camera.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Which camera.
    pub camera: CameraId,
    /// The camera's own count of captured frames, from 0.
    pub seq: u64,
    /// The stamp of everything derived from this frame.
    pub captured_at: Timestamp,
    /// When the daemon got it; monotonic, never published, latencies are measured from it.
    pub received_at: Instant,
    /// The pixels, lazily decoded.
    pub image: Image,
}

/// What one stage learned about one frame.
#[derive(Clone, Debug)]
pub struct PerFrame<T> {
    /// The frame.
    pub frame: Frame,
    /// One item per object, in the stage's order.
    pub items: Vec<T>,
}
