//! Letterbox: an image resized with its aspect kept, padded to the network's input, as planar floats.
//!
//! The resize is the 11-bit fixed-point bilinear one of OpenCV's `INTER_LINEAR`, bit by bit, because
//! networks are trained and judged behind that one; resize, padding, channel order and scaling are
//! one pass over the image.

use roadwatch_core::{BoxPx, ImageSize, Pixels};

/// Grey that YOLO families pad with, of 255.
const PADDING: f32 = 114.0;
const CHANNELS: usize = 3;
/// Fixed-point weights sum to this, as in OpenCV (`INTER_RESIZE_COEF_SCALE`).
const WEIGHT_ONE: f64 = 2048.0;

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
    columns: Vec<Tap>,
    rows: Vec<Tap>,
}

/// Two neighbouring source positions and their fixed-point weights.
#[derive(Debug, Clone, Copy)]
struct Tap {
    near: usize,
    far: usize,
    near_weight: u32,
    far_weight: u32,
}

/// Scratch rows of [`Letterbox::fill`]; kept between frames so that none is allocated per frame.
#[derive(Debug, Default)]
pub struct Scratch {
    near: Vec<i16>,
    far: Vec<i16>,
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
            columns: taps(image.width_px as usize, width),
            rows: taps(image.height_px as usize, height),
        }
    }

    /// The image size this letterbox is for.
    #[must_use]
    pub fn image_size(&self) -> ImageSize {
        self.image
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
        let width = self.columns.len();
        scratch.near.resize(CHANNELS * width, 0);
        scratch.far.resize(CHANNELS * width, 0);
        let (mut near_row, mut far_row) = (usize::MAX, usize::MAX);
        for (y, tap) in self.rows.iter().enumerate() {
            if far_row == tap.near {
                std::mem::swap(&mut scratch.near, &mut scratch.far);
                std::mem::swap(&mut near_row, &mut far_row);
            }
            if near_row != tap.near {
                self.resize_row(image, tap.near, &mut scratch.near);
                near_row = tap.near;
            }
            if far_row != tap.far {
                self.resize_row(image, tap.far, &mut scratch.far);
                far_row = tap.far;
            }
            self.blend_rows(*tap, y, scratch, input);
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

    /// One source row resized horizontally, planar blue, green, red, weighted by 128: OpenCV drops the four
    /// low bits of its weight of 2048 before it goes on, after which 16 bits are enough.
    fn resize_row(&self, image: &Pixels, row: usize, out: &mut [i16]) {
        let stride = self.image.width_px as usize * CHANNELS;
        let source = &image.bgr()[row * stride..];
        let width = self.columns.len();
        let (blue, rest) = out.split_at_mut(width);
        let (green, red) = rest.split_at_mut(width);
        let taps = self.columns.iter();
        for (((tap, blue), green), red) in taps.zip(blue).zip(green).zip(red) {
            let start = tap.near * CHANNELS;
            // An image one pixel wide has no second pixel.
            let Some(pair) = source
                .get(start..)
                .and_then(<[u8]>::first_chunk::<{ 2 * CHANNELS }>)
            else {
                [*blue, *green, *red] = std::array::from_fn(|c| i16::from(source[start + c]) << 7);
                continue;
            };
            let mix = |c: usize| {
                let near = u32::from(pair[c]) * tap.near_weight;
                ((near + u32::from(pair[CHANNELS + c]) * tap.far_weight) >> 4) as i16
            };
            *blue = mix(0);
            *green = mix(1);
            *red = mix(2);
        }
    }

    fn blend_rows(&self, tap: Tap, y: usize, scratch: &Scratch, input: &mut [f32]) {
        let width = self.columns.len();
        let input_width = self.input.width_px as usize;
        let plane_len = input_width * self.input.height_px as usize;
        let scale = self.scale();
        let weights = (tap.near_weight as i16, tap.far_weight as i16);
        for channel in 0..CHANNELS {
            let plane = match self.values {
                Values::RgbUnit => CHANNELS - 1 - channel,
                Values::BgrByte => channel,
            };
            let start = plane * plane_len + (self.top + y) * input_width + self.left;
            let near = &scratch.near[channel * width..][..width];
            let far = &scratch.far[channel * width..][..width];
            blend(near, far, weights, scale, &mut input[start..start + width]);
        }
    }
}

/// Two rows mixed vertically, with OpenCV's shifts, which set the rounding: the high halves of 16-bit
/// products are one instruction for eight of them, so everything before the floats stays in 16 bits.
fn blend(near: &[i16], far: &[i16], weights: (i16, i16), scale: f32, out: &mut [f32]) {
    let high = |weight: i16, value: i16| ((i32::from(weight) * i32::from(value)) >> 16) as i16;
    for ((out, &near), &far) in out.iter_mut().zip(near).zip(far) {
        let mixed = high(weights.0, near) + high(weights.1, far);
        *out = f32::from((mixed + 2) >> 2) * scale;
    }
}

/// For each of `resized` positions the two of `source` it lies between, pixel centres aligned. The far one
/// is the near one's successor, also at the end, where all weight is on it.
fn taps(source: usize, resized: usize) -> Vec<Tap> {
    let step = source as f64 / resized as f64;
    let last = source - 1;
    (0..resized)
        .map(|at| {
            let position = ((at as f64 + 0.5) * step - 0.5).clamp(0.0, last as f64);
            let near = (position as usize).min(last.saturating_sub(1));
            let far_share = position - near as f64;
            Tap {
                near,
                far: (near + 1).min(last),
                near_weight: ((1.0 - far_share) * WEIGHT_ONE).round_ties_even() as u32,
                far_weight: (far_share * WEIGHT_ONE).round_ties_even() as u32,
            }
        })
        .collect()
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
