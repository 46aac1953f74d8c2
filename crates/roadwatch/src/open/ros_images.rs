//! ROS's images as the pipeline's.

use roadwatch_camera::{Counted, DecodeCount, RawImage, Recording, Span, StillImage};
use roadwatch_core::{DecodeError, Image, ImageSize, SourceError, Timestamp};
use roadwatch_ros::{BagImages, ImageMessage, bag::EncodedImage, input::ToImage};
use std::time::Duration;

const PNG_START: &[u8] = b"\x89PNG";

/// An image that is decoded when somebody looks; it must be of the camera's size. `origin` is what errors call it.
pub(super) fn to_image(size: ImageSize, origin: String, decodes: DecodeCount) -> ToImage {
    Box::new(move |message| {
        let decodes = decodes.clone();
        Ok(match message {
            ImageMessage::Compressed(image) => {
                let still = StillImage::new(image.data, size, origin.clone());
                Image::encoded(Box::new(Counted::new(still, decodes)))
            }
            ImageMessage::Raw(image) => {
                let raw = RawImage {
                    expected: size,
                    origin: origin.clone(),
                    size: ImageSize {
                        width_px: image.width,
                        height_px: image.height,
                    },
                    encoding: image.encoding,
                    big_endian: image.is_bigendian != 0,
                    step: usize::try_from(image.step)
                        .map_err(|_| DecodeError::new("the step is too large"))?,
                    bytes: image.data,
                };
                Image::encoded(Box::new(Counted::new(raw, decodes)))
            }
        })
    })
}

/// An image as a file: the one it came as, or a JPEG of its pixels.
///
/// # Errors
/// When it cannot be decoded or encoded.
pub fn encoded(image: &Image) -> Result<EncodedImage, DecodeError> {
    if let Some(file) = image.as_file() {
        let is_png = file.starts_with(PNG_START);
        return Ok(EncodedImage {
            format: if is_png { "png" } else { "jpeg" },
            bytes: file.to_vec(),
        });
    }
    let pixels = image.pixels().map_err(Clone::clone)?;
    let bytes = roadwatch_picture::jpeg(pixels);
    Ok(EncodedImage {
        format: "jpeg",
        bytes: bytes.map_err(|error| DecodeError::new(error.to_string()))?,
    })
}

/// A bag's images as a camera's recording.
pub(super) struct BagRecording {
    pub(super) images: BagImages,
    pub(super) to_image: ToImage,
}

impl Recording for BagRecording {
    fn span(&self) -> Span {
        let span = self.images.span();
        let intervals = u32::try_from(span.count.saturating_sub(1)).unwrap_or(u32::MAX);
        let length = span.last.saturating_since(span.first);
        Span {
            first: span.first,
            last: span.last.max(span.first),
            interval: length.checked_div(intervals).unwrap_or(LONE_IMAGE),
        }
    }

    fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError> {
        self.images.next_stamp()
    }

    fn take_image(&mut self) -> Result<Image, SourceError> {
        let message = self.images.take()?;
        (self.to_image)(message).map_err(|error| SourceError::FrameLost(error.into()))
    }

    fn rewind(&mut self) -> Result<(), SourceError> {
        self.images.rewind();
        Ok(())
    }
}

/// What a bag of one image counts for: 10 Hz, the usual rate of a recorded rig.
const LONE_IMAGE: Duration = Duration::from_millis(100);
