//! Crop normalisation: a box of any shape in a crop of one size, never stretched (docs/method.md, section 4).

use roadwatch_core::{BoxPx, ImageSize, Pixels, camera_model::Pixel};

/// The paper's size of crops.
pub const DEFAULT_CROP_SIZE: ImageSize = ImageSize {
    width_px: 800,
    height_px: 800,
};

const CHANNELS: usize = 3;

/// What values networks take for pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Values {
    /// Whether blue comes first, as pixels lie in memory, or red.
    pub order: ChannelOrder,
    /// What 0 to 255 is multiplied by.
    pub scale: f32,
}

/// Which channel a network wants first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelOrder {
    /// Red, green, blue.
    Rgb,
    /// Blue, green, red.
    Bgr,
}

/// Where a box's pixels lie in its crop.
///
/// The box, clipped to the image and to whole pixels, is scaled by `SF = W_final / W_orig` to `H_new = H_orig * SF`
/// rows (rounded, at least 1), with `PT = floor((H_final - H_new) / 2)` black rows above and the rest below. Where
/// `H_new > H_final`, on which the paper is silent, it is scaled by height and padded left and right alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    size: ImageSize,
    /// Left, top, width, height in the image, pixels.
    source: [u32; 4],
    /// The same in the crop.
    place: [u32; 4],
}

impl Crop {
    /// The crop of a box; `None` where the box, clipped to the image, holds no pixel.
    #[must_use]
    pub fn new(box_px: &BoxPx, image: ImageSize, size: ImageSize) -> Option<Self> {
        let clipped = |edge: f32, most: u32| edge.round_ties_even().clamp(0.0, most as f32) as u32;
        let left = clipped(box_px.x_min, image.width_px);
        let top = clipped(box_px.y_min, image.height_px);
        let width = clipped(box_px.x_max, image.width_px).checked_sub(left)?;
        let height = clipped(box_px.y_max, image.height_px).checked_sub(top)?;
        if width == 0 || height == 0 {
            return None;
        }
        let scaled = |side: u32, to: u32, of: u32| {
            let exact = f64::from(side) * f64::from(to) / f64::from(of);
            (exact.round_ties_even() as u32).max(1)
        };
        let new_height = scaled(height, size.width_px, width);
        let place = if new_height <= size.height_px {
            let above = (size.height_px - new_height) / 2;
            [0, above, size.width_px, new_height]
        } else {
            let new_width = scaled(width, size.height_px, height).min(size.width_px);
            let beside = (size.width_px - new_width) / 2;
            [beside, 0, new_width, size.height_px]
        };
        Some(Self {
            size,
            source: [left, top, width, height],
            place,
        })
    }

    /// Numbers that a crop of this size takes in a network's input.
    #[must_use]
    pub fn input_len(size: ImageSize) -> usize {
        CHANNELS * size.width_px as usize * size.height_px as usize
    }

    /// Rows of black above and below (PT and PB).
    #[must_use]
    pub fn padding_rows(&self) -> (u32, u32) {
        let [_, above, _, height] = self.place;
        (above, self.size.height_px - above - height)
    }

    /// Columns of black left and right.
    #[must_use]
    pub fn padding_columns(&self) -> (u32, u32) {
        let [beside, _, width, _] = self.place;
        (beside, self.size.width_px - beside - width)
    }

    /// Height of the box over its width, as it is cropped.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        let [_, _, width, height] = self.source;
        f64::from(height) / f64::from(width)
    }

    /// A position in the image as one in the crop; pixel centres are whole numbers in both.
    #[must_use]
    pub fn to_crop(&self, image: Pixel) -> Pixel {
        Pixel::new(
            Axis::of(self, 0).to_crop(image.x),
            Axis::of(self, 1).to_crop(image.y),
        )
    }

    /// A position in the crop as one in the image, by the whole-numbered sizes, so that it is exact.
    #[must_use]
    pub fn to_image(&self, crop: Pixel) -> Pixel {
        Pixel::new(
            Axis::of(self, 0).to_image(crop.x),
            Axis::of(self, 1).to_image(crop.y),
        )
    }

    /// Writes the crop's pixels, bilinear, into a network's input: channel by channel, row by row,
    /// [`Self::input_len`] numbers. `scratch` is used again from crop to crop.
    ///
    /// # Panics
    /// When `input` is of another length.
    pub fn fill(&self, pixels: &Pixels, values: Values, input: &mut [f32], scratch: &mut Scratch) {
        assert_eq!(
            input.len(),
            Self::input_len(self.size),
            "the input is of another size"
        );
        input.fill(0.0);
        scratch.columns.clear();
        let columns = Axis::of(self, 0);
        scratch
            .columns
            .extend((0..columns.length).map(|x| columns.sample(x)));
        let rows = Axis::of(self, 1);
        let row_len = pixels.size().width_px as usize * CHANNELS;
        let width = self.size.width_px as usize;
        let plane = width * self.size.height_px as usize;
        for y in 0..rows.length {
            let (above, below, share) = rows.sample(y);
            let row = |at: u32| &pixels.bgr()[at as usize * row_len..][..row_len];
            let (upper, lower) = (row(above), row(below));
            let start = (y + rows.start) as usize * width + columns.start as usize;
            for (x, &(left, right, aside)) in scratch.columns.iter().enumerate() {
                let (left, right) = (left as usize * CHANNELS, right as usize * CHANNELS);
                for channel in 0..CHANNELS {
                    let mixed = |row: &[u8]| {
                        let (a, b) = (
                            f32::from(row[left + channel]),
                            f32::from(row[right + channel]),
                        );
                        a + (b - a) * aside
                    };
                    let (a, b) = (mixed(upper), mixed(lower));
                    let to = match values.order {
                        ChannelOrder::Bgr => channel,
                        ChannelOrder::Rgb => CHANNELS - 1 - channel,
                    };
                    input[to * plane + start + x] = (a + (b - a) * share) * values.scale;
                }
            }
        }
    }
}

/// What filling needs room for.
#[derive(Debug, Default)]
pub struct Scratch {
    columns: Vec<Sample>,
}

/// Two source pixels and the second one's share.
type Sample = (u32, u32, f32);

/// One axis of a crop.
#[derive(Clone, Copy)]
struct Axis {
    source_start: u32,
    source_length: u32,
    start: u32,
    length: u32,
}

impl Axis {
    fn of(crop: &Crop, axis: usize) -> Self {
        Self {
            source_start: crop.source[axis],
            source_length: crop.source[axis + 2],
            start: crop.place[axis],
            length: crop.place[axis + 2],
        }
    }

    fn scale(&self) -> f64 {
        f64::from(self.length) / f64::from(self.source_length)
    }

    fn to_crop(self, position: f64) -> f64 {
        (position + 0.5 - f64::from(self.source_start)) * self.scale() + f64::from(self.start) - 0.5
    }

    fn to_image(self, position: f64) -> f64 {
        (position + 0.5 - f64::from(self.start)) / self.scale() + f64::from(self.source_start) - 0.5
    }

    /// What the crop's pixel number `at` within the box's place is mixed of; beyond the box's own border its last
    /// pixel.
    fn sample(&self, at: u32) -> Sample {
        let last = f64::from(self.source_length - 1);
        let position = ((f64::from(at) + 0.5) / self.scale() - 0.5).clamp(0.0, last);
        let first = position.floor();
        let here = self.source_start + first as u32;
        let next = here.min(self.source_start + self.source_length - 1);
        let next = (next + 1).min(self.source_start + self.source_length - 1);
        (here, next, (position - first) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const IMAGE: ImageSize = ImageSize {
        width_px: 320,
        height_px: 200,
    };

    fn size(width_px: u32, height_px: u32) -> ImageSize {
        ImageSize {
            width_px,
            height_px,
        }
    }

    fn boxed(x: f32, y: f32, width: f32, height: f32) -> BoxPx {
        BoxPx::new(x, y, x + width, y + height).expect("a box")
    }

    fn boxes() -> impl Strategy<Value = BoxPx> {
        (
            -50.0..300.0_f32,
            -50.0..180.0_f32,
            1.0..200.0_f32,
            1.0..200.0_f32,
        )
            .prop_map(|(x, y, width, height)| boxed(x, y, width, height))
    }

    proptest! {
        #[test]
        fn padding_and_place_fill_the_crop_and_nothing_is_stretched(
            box_px in boxes(), width in 1..900_u32, height in 1..900_u32,
        ) {
            let wanted = size(width, height);
            let Some(crop) = Crop::new(&box_px, IMAGE, wanted) else { return Ok(()); };
            let (above, below) = crop.padding_rows();
            let (left, right) = crop.padding_columns();
            prop_assert!(below == above || below == above + 1);
            prop_assert!(right == left || right == left + 1);
            prop_assert!((above + below == 0) || (left + right == 0));
            let [_, _, w, h] = crop.place.map(f64::from);
            let [_, _, source_w, source_h] = crop.source.map(f64::from);
            // The side that fills the crop says the scale; the other is rounded by half a pixel, and at least 1. Where
            // both fill it, either may have said it.
            let by_width = (h - (source_h * w / source_w).max(1.0)).abs();
            let by_height = (w - (source_w * h / source_h).max(1.0)).abs();
            let off = match (left + right, above + below) {
                (0, 0) => by_width.min(by_height),
                (0, _) => by_width,
                _ => by_height,
            };
            prop_assert!(off <= 0.5);
        }

        #[test]
        fn back_from_the_crop_is_where_it_came_from(box_px in boxes(), x in 0.0..320.0_f64, y in 0.0..200.0_f64) {
            let Some(crop) = Crop::new(&box_px, IMAGE, size(192, 192)) else { return Ok(()); };
            let there = crop.to_crop(Pixel::new(x, y));
            prop_assert!((crop.to_image(there) - Pixel::new(x, y)).norm() < 1e-9);
        }

        #[test]
        fn filling_writes_the_box_and_black_beside_it(box_px in boxes()) {
            let wanted = size(64, 48);
            let Some(crop) = Crop::new(&box_px, IMAGE, wanted) else { return Ok(()); };
            let white = Pixels::new(IMAGE, vec![255; 320 * 200 * 3]).expect("pixels");
            let mut input = vec![7.0; Crop::input_len(wanted)];
            let values = Values { order: ChannelOrder::Rgb, scale: 1.0 / 255.0 };
            crop.fill(&white, values, &mut input, &mut Scratch::default());
            let lit = input.iter().filter(|&&value| (value - 1.0).abs() < 1e-6).count();
            let dark = input.iter().filter(|&&value| value == 0.0).count();
            let [_, _, width, height] = crop.place;
            prop_assert_eq!(lit, (3 * width * height) as usize);
            prop_assert_eq!(lit + dark, input.len());
        }
    }

    #[test]
    fn a_wide_box_is_padded_above_and_below_the_odd_row_below() {
        let crop =
            Crop::new(&boxed(10.0, 20.0, 100.0, 51.0), IMAGE, DEFAULT_CROP_SIZE).expect("a crop");
        // SF = 8, H_new = 408.
        assert_eq!(crop.padding_rows(), (196, 196));
        let odd = Crop::new(&boxed(0.0, 0.0, 3.0, 1.0), IMAGE, size(9, 8)).expect("a crop");
        assert_eq!(odd.padding_rows(), (2, 3));
    }

    #[test]
    fn a_tall_box_is_padded_left_and_right() {
        let crop = Crop::new(&boxed(0.0, 0.0, 50.0, 100.0), IMAGE, size(80, 80)).expect("a crop");
        assert_eq!(crop.padding_columns(), (20, 20));
        assert_eq!(crop.padding_rows(), (0, 0));
    }

    #[test]
    fn channels_come_in_the_order_that_is_asked_for() {
        let one = Pixels::new(size(1, 1), vec![10, 20, 30]).expect("a pixel");
        let crop = Crop::new(&boxed(0.0, 0.0, 1.0, 1.0), size(1, 1), size(1, 1)).expect("a crop");
        let filled = |order| {
            let mut input = [0.0; 3];
            crop.fill(
                &one,
                Values { order, scale: 1.0 },
                &mut input,
                &mut Scratch::default(),
            );
            input
        };
        assert_eq!(filled(ChannelOrder::Rgb), [30.0, 20.0, 10.0]);
        assert_eq!(filled(ChannelOrder::Bgr), [10.0, 20.0, 30.0]);
    }

    #[test]
    fn a_box_outside_the_image_has_no_crop() {
        assert_eq!(
            Crop::new(&boxed(400.0, 0.0, 10.0, 10.0), IMAGE, size(8, 8)),
            None
        );
        assert_eq!(
            Crop::new(&boxed(-20.0, 0.0, 10.0, 10.0), IMAGE, size(8, 8)),
            None
        );
        assert_eq!(
            Crop::new(&boxed(5.2, 5.2, 0.2, 0.2), IMAGE, size(8, 8)),
            None
        );
    }
}
