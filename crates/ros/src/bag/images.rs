//! The cameras' images in a bag.

use crate::{
    convert::Message,
    msg::{sensor_msgs::CompressedImage, std_msgs::Header},
};
use roadwatch_core::{DecodeError, Frame, Image};

/// An image as a file would have it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedImage {
    /// `jpeg` or `png`.
    pub format: &'static str,
    /// The file's bytes.
    pub bytes: Vec<u8>,
}

/// Makes a file of an image.
pub type EncodeImage = Box<dyn Fn(&Image) -> Result<EncodedImage, DecodeError> + Send>;

pub(super) fn message(
    frame: &Frame,
    frame_id: String,
    encode: &EncodeImage,
) -> Result<Message, DecodeError> {
    let EncodedImage { format, bytes } = encode(&frame.image)?;
    Ok(Message::Image(CompressedImage {
        header: Header::new(frame.captured_at, frame_id),
        format: format.to_owned(),
        data: bytes,
    }))
}
