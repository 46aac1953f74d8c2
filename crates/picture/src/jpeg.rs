//! Pictures small enough to be sent.

use crate::canvas::{Canvas, DrawError};
use opencv::{
    core::{Mat, Size, Vector},
    imgcodecs::{IMWRITE_JPEG_QUALITY, imencode},
    imgproc::{INTER_AREA, resize},
    prelude::*,
};
use roadwatch_core::Pixels;

/// Tried one after the other until the picture is small enough.
const QUALITIES: [i32; 4] = [80, 65, 50, 35];
/// How much narrower the picture becomes when the lowest quality does not make it small enough.
const SHRINK: f64 = 0.75;
/// Narrower than this nothing is seen in it any more, pixels.
const NARROWEST_PX: f64 = 64.0;

/// So good that a detector sees the same, percent.
const LASTING_QUALITY: i32 = 95;

/// An image as JPEG, to be kept.
///
/// # Errors
/// When OpenCV refuses.
pub fn jpeg(image: &Pixels) -> Result<Vec<u8>, DrawError> {
    encoded(Canvas::of_image(image)?.mat(), LASTING_QUALITY)
}

impl Canvas {
    /// The picture as JPEG, at most `widest_px` wide and of at most `most_bytes`: it is first scaled, then compressed
    /// harder, then scaled again.
    ///
    /// # Errors
    /// When OpenCV refuses, or nothing that is seen fits.
    pub fn jpeg_within(&self, widest_px: u32, most_bytes: usize) -> Result<Vec<u8>, DrawError> {
        let mut width = f64::from(self.size().width_px.min(widest_px));
        while width >= NARROWEST_PX {
            let scaled = self.scaled_to_width(width)?;
            for quality in QUALITIES {
                let bytes = encoded(&scaled, quality)?;
                if bytes.len() <= most_bytes {
                    return Ok(bytes);
                }
            }
            width *= SHRINK;
        }
        Err(DrawError::TooLarge { most_bytes })
    }

    fn scaled_to_width(&self, width: f64) -> Result<Mat, DrawError> {
        let size = self.size();
        let height = width * f64::from(size.height_px) / f64::from(size.width_px);
        let to = Size::new(width.round() as i32, height.round().max(1.0) as i32);
        let mut scaled = Mat::default();
        resize(self.mat(), &mut scaled, to, 0.0, 0.0, INTER_AREA)?;
        Ok(scaled)
    }
}

fn encoded(mat: &Mat, quality: i32) -> Result<Vec<u8>, DrawError> {
    let mut bytes = Vector::new();
    let options = Vector::from_slice(&[IMWRITE_JPEG_QUALITY, quality]);
    imencode(".jpg", mat, &mut bytes, &options)?;
    Ok(bytes.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use opencv::imgcodecs::{IMREAD_COLOR, imdecode};
    use roadwatch_core::ImageSize;

    /// Noise, which does not compress.
    fn noise() -> Canvas {
        let size = ImageSize {
            width_px: 1280,
            height_px: 720,
        };
        let mut state = 1_u32;
        let bytes = (0..1280 * 720 * 3).map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        });
        let pixels = Pixels::new(size, bytes.collect()).expect("pixels");
        Canvas::of_image(&pixels).expect("canvas")
    }

    #[test]
    fn a_picture_is_made_small_enough_and_no_smaller_than_need_be() {
        let plain = Canvas::new(
            ImageSize {
                width_px: 1280,
                height_px: 720,
            },
            [9, 99, 199],
        );
        let plain = plain
            .expect("canvas")
            .jpeg_within(640, 50_000)
            .expect("fits");
        let read = imdecode(&plain.as_slice(), IMREAD_COLOR).expect("JPEG");
        assert_eq!((read.cols(), read.rows()), (640, 360));
        let hard = noise().jpeg_within(640, 15_000).expect("fits");
        assert!(hard.len() <= 15_000);
        let read = imdecode(&hard.as_slice(), IMREAD_COLOR).expect("JPEG");
        assert!((100..640).contains(&read.cols()), "{}", read.cols());
    }

    #[test]
    fn what_cannot_fit_is_an_error() {
        let error = noise().jpeg_within(640, 100).expect_err("too small");
        assert_eq!(error.to_string(), "no picture of 100 bytes shows anything");
    }
}
