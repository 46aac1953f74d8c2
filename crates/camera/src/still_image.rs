//! Encoded stills: the bytes of a JPEG or PNG file, decoded when somebody looks.

use crate::mat::fill_pixels;
use opencv::imgcodecs::{IMREAD_COLOR, IMREAD_IGNORE_ORIENTATION, imdecode_to};
use roadwatch_core::{DecodeError, DecodeImage, ImageSize, Pixels};

/// The rig describes the sensor's own rows and columns, so an EXIF orientation must not turn them.
const AS_THE_SENSOR_SAW_IT: i32 = IMREAD_COLOR | IMREAD_IGNORE_ORIENTATION;

const JPEG_START: &[u8] = &[0xFF, 0xD8, 0xFF];
/// The "end of image" marker.
const JPEG_END: &[u8] = &[0xFF, 0xD9];
const PNG_START: &[u8] = b"\x89PNG\r\n\x1A\n";
/// The IEND chunk's name and its constant checksum.
const PNG_END: &[u8] = b"IEND\xAE\x42\x60\x82";

/// The bytes of a JPEG or PNG image.
#[derive(Debug)]
pub struct StillImage {
    bytes: Vec<u8>,
    expected: ImageSize,
    origin: String,
}

impl StillImage {
    /// An image that must turn out `expected` in size. `origin` is what errors call it: a file, a topic.
    #[must_use]
    pub fn new(bytes: Vec<u8>, expected: ImageSize, origin: impl Into<String>) -> Self {
        Self {
            bytes,
            expected,
            origin: origin.into(),
        }
    }

    fn decode_whole(&self) -> Result<Pixels, DecodeError> {
        check_whole(&self.bytes).map_err(DecodeError::new)?;
        fill_pixels(self.expected, |mat| {
            imdecode_to(&self.bytes.as_slice(), AS_THE_SENSOR_SAW_IT, mat).map(|_same_mat| ())
        })
    }
}

impl DecodeImage for StillImage {
    fn decode(&self) -> Result<Pixels, DecodeError> {
        self.decode_whole()
            .map_err(|error| DecodeError::new(format!("`{}`: {error}", self.origin)))
    }

    fn as_file(&self) -> Option<&[u8]> {
        Some(&self.bytes)
    }
}

/// Finds truncation by the end marker, because libjpeg paints what is missing grey and reports success.
fn check_whole(bytes: &[u8]) -> Result<(), &'static str> {
    if bytes.is_empty() {
        return Err("the file is empty");
    }
    // Some cameras pad their JPEG buffers with zeros.
    let padding = bytes.iter().rev().take_while(|&&byte| byte == 0).count();
    let content = &bytes[..bytes.len() - padding];
    let whole = if content.starts_with(JPEG_START) {
        content.ends_with(JPEG_END)
    } else if content.starts_with(PNG_START) {
        content.ends_with(PNG_END)
    } else {
        return Err("neither a JPEG nor a PNG image");
    };
    if whole {
        Ok(())
    } else {
        Err("the image is truncated: its end marker is missing")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opencv::{
        core::{Mat, Scalar, Vec3b, Vector},
        imgcodecs::imencode_def,
        prelude::*,
    };

    const SIZE: ImageSize = ImageSize {
        width_px: 64,
        height_px: 48,
    };

    fn encoded(extension: &str) -> Vec<u8> {
        let mat = Mat::new_rows_cols_with_default(
            48,
            64,
            Vec3b::opencv_type(),
            Scalar::new(10.0, 120.0, 240.0, 0.0),
        )
        .expect("a plain image");
        let mut bytes = Vector::new();
        assert!(imencode_def(extension, &mat, &mut bytes).expect("encoded"));
        bytes.to_vec()
    }

    fn decode(bytes: Vec<u8>) -> Result<Pixels, String> {
        StillImage::new(bytes, SIZE, "front/0001.jpg")
            .decode()
            .map_err(|error| error.to_string())
    }

    #[test]
    fn jpeg_and_png_become_packed_blue_green_red() {
        for extension in [".jpg", ".png"] {
            let pixels = decode(encoded(extension)).expect("an image");
            assert_eq!(pixels.size(), SIZE);
            let far_corner = &pixels.bgr()[64 * 48 * 3 - 3..];
            for (found, painted) in far_corner.iter().zip([10_u8, 120, 240]) {
                assert!(found.abs_diff(painted) <= 3, "{extension}: {far_corner:?}");
            }
        }
    }

    #[test]
    fn an_exif_orientation_does_not_turn_the_image() {
        // APP1: TIFF header, one entry, tag 0x0112 (orientation) = 6 (turn by 90 degrees).
        let exif = b"\xFF\xE1\x00\x22Exif\0\0MM\0\x2A\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
        let mut bytes = encoded(".jpg");
        bytes.splice(2..2, exif.iter().copied());
        assert_eq!(decode(bytes).expect("an image").size(), SIZE);
    }

    #[test]
    fn zero_padding_behind_the_image_is_not_truncation() {
        let mut bytes = encoded(".jpg");
        bytes.extend([0; 512]);
        assert!(decode(bytes).is_ok());
    }

    #[test]
    fn a_cut_anywhere_is_an_error_that_names_the_file() {
        for extension in [".jpg", ".png"] {
            let bytes = encoded(extension);
            for length in 0..bytes.len() {
                let error = decode(bytes[..length].to_vec()).expect_err("cut");
                assert!(error.starts_with("`front/0001.jpg`: "), "{error}");
            }
        }
        assert!(
            decode(Vec::new())
                .expect_err("empty")
                .contains("the file is empty")
        );
    }

    #[test]
    fn text_is_not_an_image() {
        let error = decode(b"hello, this is a text file\n".to_vec()).expect_err("text");
        assert!(error.contains("neither a JPEG nor a PNG image"), "{error}");
    }

    #[test]
    fn another_size_is_named_beside_the_rigs() {
        let expected = ImageSize {
            width_px: 960,
            height_px: 540,
        };
        let image = StillImage::new(encoded(".jpg"), expected, "front/0001.jpg");
        assert_eq!(
            image.decode().expect_err("wrong size").to_string(),
            "`front/0001.jpg`: image is 64x48, the rig says 960x540"
        );
    }

    #[test]
    fn rubbish_between_the_markers_never_panics() {
        let mut bytes = encoded(".jpg");
        let end = bytes.len() - 2;
        bytes[2..end].fill(0xA5);
        assert!(decode(bytes).is_err());
    }
}
