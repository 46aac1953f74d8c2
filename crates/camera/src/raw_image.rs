//! Pixels as cameras and drivers send them, in one of ROS's encodings (`sensor_msgs/image_encodings`).

use crate::mat::fill_pixels;
use opencv::{
    boxed_ref::BoxedRef,
    core::{Mat, Vec2b, Vec3b, Vec4b},
    imgproc::{
        COLOR_BGRA2BGR, COLOR_BayerBG2BGR, COLOR_BayerGB2BGR, COLOR_BayerGR2BGR, COLOR_BayerRG2BGR,
        COLOR_GRAY2BGR, COLOR_RGB2BGR, COLOR_RGBA2BGR, COLOR_YUV2BGR_UYVY, COLOR_YUV2BGR_YUY2,
        cvt_color_def,
    },
};
use roadwatch_core::{DecodeError, DecodeImage, ImageSize, Pixels};
use std::borrow::Cow;

/// How the bytes of a pixel become blue, green, red.
#[derive(Clone, Copy)]
enum Conversion {
    /// They are that.
    None,
    /// By OpenCV's code of that number.
    Color(i32),
    /// Grey of sixteen bits, of which the upper eight count.
    Grey16,
}

/// ROS's name, bytes per pixel, conversion. ROS names a Bayer pattern by its first row, OpenCV by its second.
const ENCODINGS: [(&str, usize, Conversion); 16] = [
    ("bgr8", 3, Conversion::None),
    ("8UC3", 3, Conversion::None),
    ("rgb8", 3, Conversion::Color(COLOR_RGB2BGR)),
    ("bgra8", 4, Conversion::Color(COLOR_BGRA2BGR)),
    ("rgba8", 4, Conversion::Color(COLOR_RGBA2BGR)),
    ("mono8", 1, Conversion::Color(COLOR_GRAY2BGR)),
    ("8UC1", 1, Conversion::Color(COLOR_GRAY2BGR)),
    ("mono16", 2, Conversion::Grey16),
    ("yuv422", 2, Conversion::Color(COLOR_YUV2BGR_UYVY)),
    ("uyvy", 2, Conversion::Color(COLOR_YUV2BGR_UYVY)),
    ("yuv422_yuy2", 2, Conversion::Color(COLOR_YUV2BGR_YUY2)),
    ("yuyv", 2, Conversion::Color(COLOR_YUV2BGR_YUY2)),
    ("bayer_rggb8", 1, Conversion::Color(COLOR_BayerBG2BGR)),
    ("bayer_bggr8", 1, Conversion::Color(COLOR_BayerRG2BGR)),
    ("bayer_gbrg8", 1, Conversion::Color(COLOR_BayerGR2BGR)),
    ("bayer_grbg8", 1, Conversion::Color(COLOR_BayerGB2BGR)),
];

/// An image that is not compressed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawImage {
    /// What the rig says of its size.
    pub expected: ImageSize,
    /// What errors call it: a topic.
    pub origin: String,
    /// Its width and height.
    pub size: ImageSize,
    /// ROS's name of what the bytes mean, such as `rgb8`.
    pub encoding: String,
    /// Whether the higher byte of a number comes first.
    pub big_endian: bool,
    /// Bytes from one row to the next.
    pub step: usize,
    /// Row by row.
    pub bytes: Vec<u8>,
}

impl RawImage {
    fn converted(&self) -> Result<Pixels, String> {
        if self.size != self.expected {
            return Err(format!(
                "image is {}, the rig says {}",
                self.size, self.expected
            ));
        }
        let known = ENCODINGS.iter().find(|(name, ..)| *name == self.encoding);
        let Some(&(_, bytes_per_pixel, conversion)) = known else {
            let names: Vec<_> = ENCODINGS.iter().map(|(name, ..)| *name).collect();
            let found = &self.encoding;
            return Err(format!(
                "encoding `{found}` is unknown; known are {}",
                names.join(", ")
            ));
        };
        let rows = self.rows(bytes_per_pixel)?;
        let code = match conversion {
            Conversion::None => {
                let pixels = Pixels::new(self.size, rows.into_owned());
                return pixels.map_err(|error| error.to_string());
            }
            Conversion::Color(code) => return self.by_open_cv(&rows, bytes_per_pixel, code),
            Conversion::Grey16 => COLOR_GRAY2BGR,
        };
        let upper = usize::from(!self.big_endian);
        let grey: Vec<u8> = rows.chunks_exact(2).map(|pixel| pixel[upper]).collect();
        self.by_open_cv(&grey, 1, code)
    }

    /// The rows without what pads them.
    fn rows(&self, bytes_per_pixel: usize) -> Result<Cow<'_, [u8]>, String> {
        let (width, height) = (self.size.width_px as usize, self.size.height_px as usize);
        let (row, step) = (width * bytes_per_pixel, self.step);
        if step < row {
            return Err(format!(
                "a step of {step} bytes is less than a row of {width} `{}`",
                self.encoding
            ));
        }
        let needed = step.saturating_mul(height);
        if self.bytes.len() < needed {
            let found = self.bytes.len();
            return Err(format!(
                "{found} bytes are less than {height} rows of {step}"
            ));
        }
        if step == row {
            return Ok(Cow::Borrowed(&self.bytes[..needed]));
        }
        let rows = self.bytes[..needed].chunks_exact(step);
        Ok(rows.flat_map(|padded| &padded[..row]).copied().collect())
    }

    fn by_open_cv(&self, rows: &[u8], bytes_per_pixel: usize, code: i32) -> Result<Pixels, String> {
        let converted = fill_pixels(self.expected, |mat| {
            let source = self.as_mat(rows, bytes_per_pixel)?;
            cvt_color_def(&source, mat, code)
        });
        converted.map_err(|error| error.to_string())
    }

    fn as_mat<'a>(
        &self,
        rows: &'a [u8],
        bytes_per_pixel: usize,
    ) -> opencv::Result<BoxedRef<'a, Mat>> {
        // Sizes are those of the rig, which fit.
        let (height, width) = (self.size.height_px as i32, self.size.width_px as i32);
        match bytes_per_pixel {
            1 => Mat::new_rows_cols_with_bytes::<u8>(height, width, rows),
            2 => Mat::new_rows_cols_with_bytes::<Vec2b>(height, width, rows),
            3 => Mat::new_rows_cols_with_bytes::<Vec3b>(height, width, rows),
            _ => Mat::new_rows_cols_with_bytes::<Vec4b>(height, width, rows),
        }
    }
}

impl DecodeImage for RawImage {
    fn decode(&self) -> Result<Pixels, DecodeError> {
        self.converted()
            .map_err(|what| DecodeError::new(format!("`{}`: {what}", self.origin)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize {
        width_px: 8,
        height_px: 4,
    };
    /// A warm red, blue green red.
    const BGR: [u8; 3] = [20, 60, 200];
    /// Its brightness by ITU-R BT.601.
    const GREY: u8 = 97;

    fn image(encoding: &str, pixel: &[u8], padding: usize) -> RawImage {
        let mut row: Vec<u8> = pixel
            .iter()
            .copied()
            .cycle()
            .take(8 * pixel.len())
            .collect();
        row.resize(row.len() + padding, 0xEE);
        RawImage {
            expected: SIZE,
            origin: "/front/image_raw".to_owned(),
            size: SIZE,
            encoding: encoding.to_owned(),
            big_endian: false,
            step: row.len(),
            bytes: row.repeat(4),
        }
    }

    fn assert_is(image: &RawImage, expected: [u8; 3]) {
        let pixels = image.decode().expect("decoded");
        for pixel in pixels.bgr().chunks_exact(3) {
            for (found, expected) in pixel.iter().zip(expected) {
                assert!(
                    found.abs_diff(expected) <= 2,
                    "{}: {pixel:?}",
                    image.encoding
                );
            }
        }
    }

    #[test]
    fn every_encoding_becomes_blue_green_red_with_or_without_padding() {
        let [b, g, r] = BGR;
        for padding in [0, 5] {
            assert_is(&image("bgr8", &[b, g, r], padding), BGR);
            assert_is(&image("rgb8", &[r, g, b], padding), BGR);
            assert_is(&image("bgra8", &[b, g, r, 9], padding), BGR);
            assert_is(&image("rgba8", &[r, g, b, 9], padding), BGR);
            assert_is(&image("mono8", &[GREY], padding), [GREY; 3]);
            assert_is(&image("mono16", &[1, GREY], padding), [GREY; 3]);
        }
        let big = RawImage {
            big_endian: true,
            ..image("mono16", &[GREY, 1], 0)
        };
        assert_is(&big, [GREY; 3]);
    }

    #[test]
    fn two_pixels_share_their_colour_in_yuv() {
        // Studio range of BT.601: Y 100, U 90, V 200.
        let (y, u, v) = (100, 90, 200);
        let mut uyvy = image("yuv422", &[u, y], 0);
        let mut yuyv = image("yuv422_yuy2", &[y, u], 0);
        uyvy.bytes = [u, y, v, y].repeat(16);
        yuyv.bytes = [y, u, y, v].repeat(16);
        let expected = uyvy.decode().expect("decoded");
        assert_eq!(yuyv.decode().expect("decoded"), expected);
        // R = 1.164 (Y - 16) + 1.596 (V - 128), and so on.
        assert_is(&uyvy, [21, 54, 213]);
    }

    #[test]
    fn a_bayer_pattern_is_named_by_its_first_row() {
        let [b, g, r] = BGR;
        for (encoding, first, second) in [
            ("bayer_rggb8", [r, g], [g, b]),
            ("bayer_bggr8", [b, g], [g, r]),
            ("bayer_gbrg8", [g, b], [r, g]),
            ("bayer_grbg8", [g, r], [b, g]),
        ] {
            let mut bayer = image(encoding, &[0], 0);
            bayer.bytes = [first.repeat(4), second.repeat(4)].concat().repeat(2);
            assert_is(&bayer, BGR);
        }
    }

    #[test]
    fn what_does_not_fit_is_said_with_the_topic() {
        let said = |image: RawImage| image.decode().expect_err("refused").to_string();
        let good = || image("rgb8", &[1, 2, 3], 0);
        let short_step = RawImage { step: 23, ..good() };
        assert_eq!(
            said(short_step),
            "`/front/image_raw`: a step of 23 bytes is less than a row of 8 `rgb8`"
        );
        let mut cut = good();
        cut.bytes.truncate(95);
        assert_eq!(
            said(cut),
            "`/front/image_raw`: 95 bytes are less than 4 rows of 24"
        );
        assert!(
            said(image("32FC1", &[1; 4], 0))
                .contains("encoding `32FC1` is unknown; known are bgr8")
        );
        let expected = ImageSize {
            width_px: 9,
            height_px: 4,
        };
        let other = RawImage { expected, ..good() };
        assert!(said(other).contains("image is 8x4, the rig says 9x4"));
        let huge = RawImage {
            step: usize::MAX,
            ..good()
        };
        assert!(said(huge).contains("bytes are less than"));
    }
}
