//! A picture to draw into. OpenCV draws; positions are pixel positions, fractions kept.

use crate::palette::Colour;
use opencv::{
    core::{Mat, Point, Rect, Scalar, Size, Vec3b, Vector},
    imgcodecs, imgproc,
    prelude::*,
};
use roadwatch_core::{ImageSize, Pixels};
use std::path::{Path, PathBuf};

/// OpenCV takes positions in sixteenths of a pixel.
const SUBPIXEL_BITS: i32 = 4;
/// Beyond this OpenCV's 32-bit positions overflow; nothing that far outside is seen, pixels.
const FARTHEST_PX: f64 = 30_000.0;
/// Hershey's letters at scale 1 are about this high, pixels.
const LETTER_HEIGHT_PX: f64 = 22.0;

/// A picture that could not be drawn or written.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// OpenCV refuses.
    #[error("OpenCV cannot draw")]
    OpenCv(#[from] opencv::Error),
    /// The image of a camera is not there.
    #[error("an image cannot be decoded: {0}")]
    Decode(#[from] roadwatch_core::DecodeError),
    /// Whatever is seen is larger.
    #[error("no picture of {most_bytes} bytes shows anything")]
    TooLarge {
        /// What was asked for.
        most_bytes: usize,
    },
    /// The file cannot be written.
    #[error("cannot write the picture `{}`", .0.display())]
    Unwritable(PathBuf),
}

/// A picture in work.
pub struct Canvas {
    mat: Mat,
}

/// A place in the picture, pixels.
pub(crate) type At = (f64, f64);

impl Canvas {
    pub(crate) fn mat(&self) -> &Mat {
        &self.mat
    }

    /// An empty picture of one colour, blue green red.
    ///
    /// # Errors
    /// When OpenCV refuses the size.
    pub fn new(size: ImageSize, colour: [u8; 3]) -> Result<Self, DrawError> {
        let (rows, columns) = (size.height_px as i32, size.width_px as i32);
        let mat = Mat::new_rows_cols_with_default(
            rows,
            columns,
            Vec3b::opencv_type(),
            scalar(colour, 1.0),
        )?;
        Ok(Self { mat })
    }

    /// A picture that begins as an image.
    ///
    /// # Errors
    /// When OpenCV refuses the image.
    pub fn of_image(image: &Pixels) -> Result<Self, DrawError> {
        let rows = image.size().height_px as i32;
        let flat = Mat::from_slice(image.bgr())?;
        let mat = flat.reshape(3, rows)?.try_clone()?;
        Ok(Self { mat })
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        ImageSize {
            width_px: self.mat.cols() as u32,
            height_px: self.mat.rows() as u32,
        }
    }

    pub(crate) fn line(
        &mut self,
        a: At,
        b: At,
        colour: Colour,
        width: i32,
    ) -> Result<(), DrawError> {
        imgproc::line(
            &mut self.mat,
            point(a),
            point(b),
            scalar(colour, 1.0),
            width,
            imgproc::LINE_AA,
            SUBPIXEL_BITS,
        )?;
        Ok(())
    }

    pub(crate) fn outline(
        &mut self,
        corners: &[At],
        colour: Colour,
        width: i32,
    ) -> Result<(), DrawError> {
        let next = corners.iter().cycle().skip(1);
        for (&a, &b) in corners.iter().zip(next) {
            self.line(a, b, colour, width)?;
        }
        Ok(())
    }

    pub(crate) fn fill(&mut self, corners: &[At], colour: Colour) -> Result<(), DrawError> {
        let points: Vector<Point> = corners.iter().map(|&at| point(at)).collect();
        imgproc::fill_convex_poly(
            &mut self.mat,
            &points,
            scalar(colour, 1.0),
            imgproc::LINE_AA,
            SUBPIXEL_BITS,
        )?;
        Ok(())
    }

    /// Fills a region with a share of a colour over what is there.
    pub(crate) fn tint(
        &mut self,
        corners: &[At],
        colour: Colour,
        opacity: f64,
    ) -> Result<(), DrawError> {
        let mut filled = Self {
            mat: self.mat.try_clone()?,
        };
        filled.fill(corners, colour)?;
        let below = self.mat.try_clone()?;
        opencv::core::add_weighted(
            &filled.mat,
            opacity,
            &below,
            1.0 - opacity,
            0.0,
            &mut self.mat,
            -1,
        )?;
        Ok(())
    }

    pub(crate) fn circle(
        &mut self,
        center: At,
        radius_px: f64,
        colour: Colour,
    ) -> Result<(), DrawError> {
        let radius = (radius_px * f64::from(1 << SUBPIXEL_BITS)).round() as i32;
        imgproc::circle(
            &mut self.mat,
            point(center),
            radius,
            scalar(colour, 1.0),
            1,
            imgproc::LINE_AA,
            SUBPIXEL_BITS,
        )?;
        Ok(())
    }

    /// One line of text whose letters are `height_px` high; `at` is where the first one stands.
    pub(crate) fn text(
        &mut self,
        text: &str,
        at: At,
        height_px: f64,
        colour: Colour,
    ) -> Result<(), DrawError> {
        imgproc::put_text(
            &mut self.mat,
            text,
            Point::new(at.0.round() as i32, at.1.round() as i32),
            imgproc::FONT_HERSHEY_SIMPLEX,
            height_px / LETTER_HEIGHT_PX,
            scalar(colour, 1.0),
            1,
            imgproc::LINE_AA,
            false,
        )?;
        Ok(())
    }

    /// Width of one line of text, pixels.
    pub(crate) fn text_width(text: &str, height_px: f64) -> Result<f64, DrawError> {
        let scale = height_px / LETTER_HEIGHT_PX;
        let size = imgproc::get_text_size(text, imgproc::FONT_HERSHEY_SIMPLEX, scale, 1, &mut 0)?;
        Ok(f64::from(size.width))
    }

    /// Puts another picture, resized to `size`, with its upper left corner at `(left, top)`.
    pub(crate) fn paste(
        &mut self,
        other: &Self,
        (left, top): (i32, i32),
        size: ImageSize,
    ) -> Result<(), DrawError> {
        let size = Size::new(size.width_px as i32, size.height_px as i32);
        let mut resized = Mat::default();
        imgproc::resize(
            &other.mat,
            &mut resized,
            size,
            0.0,
            0.0,
            imgproc::INTER_AREA,
        )?;
        let mut place = Mat::roi_mut(&mut self.mat, Rect::new(left, top, size.width, size.height))?;
        resized.copy_to(&mut place)?;
        Ok(())
    }

    /// Writes the picture; the file's extension says the format (PNG, JPEG).
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), DrawError> {
        let written = imgcodecs::imwrite(file, &self.mat, &Vector::new());
        if matches!(written, Ok(true)) {
            Ok(())
        } else {
            Err(DrawError::Unwritable(file.to_owned()))
        }
    }

    /// The picture's pixels, blue green red.
    ///
    /// # Errors
    /// When OpenCV refuses.
    pub fn pixels(&self) -> Result<Pixels, DrawError> {
        Ok(Pixels::new(self.size(), self.mat.data_bytes()?.to_vec())?)
    }
}

fn scalar(colour: Colour, opacity: f64) -> Scalar {
    let [blue, green, red] = colour.map(f64::from);
    Scalar::new(blue, green, red, 255.0 * opacity)
}

fn point((x, y): At) -> Point {
    let fixed = |value: f64| {
        (value.clamp(-FARTHEST_PX, FARTHEST_PX) * f64::from(1 << SUBPIXEL_BITS)).round() as i32
    };
    Point::new(fixed(x), fixed(y))
}
