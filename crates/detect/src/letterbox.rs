//! Letterbox: an image resized with its aspect kept, padded to the network's input, as planar floats.
//!
//! The resize is OpenCV's `INTER_LINEAR`, bit by bit (module `bilinear`), because networks are trained and judged
//! behind that one; resize, padding, channel order and scaling are one pass over the image.

mod bilinear;

use bilinear::{CHANNELS, Columns, Row, Tap, blend, taps};
use roadwatch_core::{BoxPx, ImageSize, Pixels};

/// Grey that YOLO families pad with, of 255.
const PADDING: f32 = 114.0;

/// Where the image sits inside the network's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// Bars on both sides (YOLOv5, YOLOv8).
    Centred,
    /// Bars to the right and below (YOLOX).
    TopLeft,
}

/// Order and scale of the values a network takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Red, green, blue, 0 to 1.
    RgbUnit,
    /// Blue, green, red, 0 to 255.
    BgrByte,
}

/// How images of one size become network inputs, and boxes come back. Built once per image size.
#[derive(Debug, Clone)]
pub struct Letterbox {
    image: ImageSize,
    input: ImageSize,
    values: Values,
    gain: f32,
    left: usize,
    top: usize,
    columns: Columns,
    rows: Vec<Tap>,
}

/// Scratch rows of [`Letterbox::fill`]; kept between frames so that none is allocated per frame.
#[derive(Debug, Default)]
pub struct Scratch {
    near: Row,
    far: Row,
}

impl Letterbox {
    /// The letterbox from images of size `image` to a network input of size `input`.
    #[must_use]
    pub fn new(image: ImageSize, input: ImageSize, placement: Placement, values: Values) -> Self {
        let gain = (f64::from(input.width_px) / f64::from(image.width_px))
            .min(f64::from(input.height_px) / f64::from(image.height_px));
        let resized = |side: u32| {
            let exact = f64::from(side) * gain;
            // Each family's own rounding, which its training saw.
            let whole = match placement {
                Placement::Centred => exact.round_ties_even(),
                Placement::TopLeft => exact.floor(),
            };
            (whole as usize).max(1)
        };
        let (width, height) = (resized(image.width_px), resized(image.height_px));
        let bar = |input: u32, resized: usize| match placement {
            // YOLOv5's own rounding: an odd remainder goes to the far side.
            Placement::Centred => (input as usize - resized) / 2,
            Placement::TopLeft => 0,
        };
        Self {
            image,
            input,
            values,
            gain: gain as f32,
            left: bar(input.width_px, width),
            top: bar(input.height_px, height),
            columns: Columns::new(image.width_px as usize, width),
            rows: taps(image.height_px as usize, height),
        }
    }

    /// The image size this letterbox is for.
    #[must_use]
    pub fn image_size(&self) -> ImageSize {
        self.image
    }

    /// Side of one pixel of the network's input, in pixels of the image.
    #[must_use]
    pub fn input_pixel_px(&self) -> f32 {
        self.gain.recip()
    }

    /// Number of floats of one input: three planes of the network's input size.
    #[must_use]
    pub fn input_len(input: ImageSize) -> usize {
        CHANNELS * input.width_px as usize * input.height_px as usize
    }

    /// Writes an image of [`Letterbox::image_size`] into `input`, three planes of the network's input size.
    ///
    /// # Panics
    /// When the image or `input` has another size.
    pub fn fill(&self, image: &Pixels, input: &mut [f32], scratch: &mut Scratch) {
        assert_eq!(image.size(), self.image, "image size of the letterbox");
        assert_eq!(input.len(), Self::input_len(self.input), "input size");
        self.fill_bars(input);
        let stride = self.image.width_px as usize * CHANNELS;
        let from_row = |row: usize| &image.bgr()[row * stride..];
        let Scratch { near, far } = scratch;
        near.forget();
        far.forget();
        for (y, tap) in self.rows.iter().enumerate() {
            if far.is(tap.near) {
                std::mem::swap(near, far);
            }
            if !near.is(tap.near) {
                near.resize(tap.near, from_row(tap.near), &self.columns);
            }
            if !far.is(tap.far) {
                far.resize(tap.far, from_row(tap.far), &self.columns);
            }
            blend(near, far, *tap, self.scale(), self.row_of_planes(y, input));
        }
    }

    /// A box in the network's input, mapped back to the image and clipped to it; `None` when nothing is left.
    #[must_use]
    pub fn to_image(&self, [x_min, y_min, x_max, y_max]: [f32; 4]) -> Option<BoxPx> {
        let (width, height) = (self.image.width_px as f32, self.image.height_px as f32);
        let x = |x: f32| ((x - self.left as f32) / self.gain).clamp(0.0, width);
        let y = |y: f32| ((y - self.top as f32) / self.gain).clamp(0.0, height);
        BoxPx::new(x(x_min), y(y_min), x(x_max), y(y_max))
    }

    fn fill_bars(&self, input: &mut [f32]) {
        let (width, height) = (self.columns.len(), self.rows.len());
        let input_width = self.input.width_px as usize;
        let grey = PADDING * self.scale();
        for plane in input.chunks_exact_mut(input_width * self.input.height_px as usize) {
            plane[..self.top * input_width].fill(grey);
            plane[(self.top + height) * input_width..].fill(grey);
            let beside = plane
                .chunks_exact_mut(input_width)
                .skip(self.top)
                .take(height);
            for row in beside {
                row[..self.left].fill(grey);
                row[self.left + width..].fill(grey);
            }
        }
    }

    fn scale(&self) -> f32 {
        match self.values {
            Values::RgbUnit => 1.0 / 255.0,
            Values::BgrByte => 1.0,
        }
    }

    /// Row `y` of the resized image in each plane of the input: blue, green, red.
    fn row_of_planes<'input>(
        &self,
        y: usize,
        input: &'input mut [f32],
    ) -> [&'input mut [f32]; CHANNELS] {
        let input_width = self.input.width_px as usize;
        let start = (self.top + y) * input_width + self.left;
        let row = start..start + self.columns.len();
        let plane_len = input_width * self.input.height_px as usize;
        let (first, rest) = input.split_at_mut(plane_len);
        let (second, third) = rest.split_at_mut(plane_len);
        let mut planes = [first, second, third].map(|plane| &mut plane[row.clone()]);
        if self.values == Values::RgbUnit {
            planes.reverse();
        }
        planes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn size(width_px: u32, height_px: u32) -> ImageSize {
        ImageSize {
            width_px,
            height_px,
        }
    }

    fn letterbox(image: ImageSize, input: ImageSize) -> Letterbox {
        Letterbox::new(image, input, Placement::Centred, Values::RgbUnit)
    }

    #[test]
    fn an_image_of_the_input_size_goes_through_unchanged() {
        let bytes: Vec<u8> = (0..4 * 4 * 3).map(|v| v as u8 * 5).collect();
        let image = Pixels::new(size(4, 4), bytes.clone()).expect("pixels");
        let mut input = vec![0.0; 48];
        Letterbox::new(size(4, 4), size(4, 4), Placement::TopLeft, Values::BgrByte).fill(
            &image,
            &mut input,
            &mut Scratch::default(),
        );
        for (at, &byte) in bytes.iter().enumerate() {
            let (pixel, channel) = (at / 3, at % 3);
            assert_eq!(input[channel * 16 + pixel], f32::from(byte));
        }
    }

    #[test]
    fn bars_are_grey_and_split_evenly() {
        let image = Pixels::new(size(8, 4), vec![255; 96]).expect("pixels");
        let mut input = vec![0.0; 3 * 64];
        letterbox(size(8, 4), size(8, 8)).fill(&image, &mut input, &mut Scratch::default());
        let grey = 114.0 / 255.0;
        for (at, &value) in input.iter().enumerate() {
            let row = at % 64 / 8;
            let expected = if (2..6).contains(&row) { 1.0 } else { grey };
            assert!((value - expected).abs() < 1e-6, "row {row}");
        }
    }

    proptest! {
        #[test]
        fn boxes_come_back_where_they_were(
            (w, h) in (32_u32..2000, 32_u32..2000),
            x in 0.0..0.5_f32, y in 0.0..0.5_f32, side in 0.1..0.5_f32,
        ) {
            let letterbox = letterbox(size(w, h), size(640, 640));
            let (w, h) = (w as f32, h as f32);
            let there = [x * w, y * h, (x + side) * w, (y + side) * h];
            let offsets = [letterbox.left, letterbox.top, letterbox.left, letterbox.top];
            let inside: [f32; 4] =
                std::array::from_fn(|i| there[i] * letterbox.gain + offsets[i] as f32);
            let back = letterbox.to_image(inside).expect("has an area");
            for (a, b) in [back.x_min, back.y_min, back.x_max, back.y_max].iter().zip(there) {
                prop_assert!((a - b).abs() < 0.02);
            }
        }

        #[test]
        fn a_flat_image_stays_flat(value: u8, w in 16_u32..300, h in 16_u32..300) {
            let image = Pixels::new(size(w, h), vec![value; (w * h * 3) as usize]).expect("pixels");
            let letterbox = letterbox(size(w, h), size(64, 64));
            let mut input = vec![0.0; 3 * 64 * 64];
            letterbox.fill(&image, &mut input, &mut Scratch::default());
            let middle = input[32 * 64 + 32] * 255.0;
            prop_assert!((middle - f32::from(value)).abs() <= 1.0);
        }
    }
}
