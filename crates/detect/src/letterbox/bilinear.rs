//! The 11-bit fixed-point bilinear resize of OpenCV's `INTER_LINEAR`, bit by bit, one output row at a time.
//!
//! Pixels are first fetched side by side, four lanes each; what is then done to them runs over whole
//! registers, and on x86-64 with AVX2 over registers of 256 bits.

use multiversion::multiversion;

pub(super) const CHANNELS: usize = 3;
/// Fixed-point weights sum to this, as in OpenCV (`INTER_RESIZE_COEF_SCALE`).
const WEIGHT_ONE: f64 = 2048.0;
/// Blue, green, red and one without meaning: four to a pixel fill registers evenly.
const LANES: usize = 4;
/// Bytes of a pixel and of its successor, as they are read into lanes.
const PAIR: usize = CHANNELS + LANES;

/// Resized, not yet mixed with the row below: weighted by 128.
type Resized = [i16; LANES];

/// Two neighbouring source positions and their fixed-point weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tap {
    pub(super) near: usize,
    pub(super) far: usize,
    pub(super) near_weight: i16,
    pub(super) far_weight: i16,
}

/// For each of `resized` positions the two of `source` it lies between, pixel centres aligned. The far one
/// is the near one's successor, also at the end, where all weight is on it.
pub(super) fn taps(source: usize, resized: usize) -> Vec<Tap> {
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
                near_weight: ((1.0 - far_share) * WEIGHT_ONE).round_ties_even() as i16,
                far_weight: (far_share * WEIGHT_ONE).round_ties_even() as i16,
            }
        })
        .collect()
}

/// Where each output column reads, and its weights once per lane.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    taps: Vec<Tap>,
    near_weights: Vec<[i16; LANES]>,
    far_weights: Vec<[i16; LANES]>,
}

impl Columns {
    pub(super) fn new(source: usize, resized: usize) -> Self {
        let taps = taps(source, resized);
        let lanes = |weight: fn(&Tap) -> i16| taps.iter().map(|tap| [weight(tap); LANES]).collect();
        Self {
            near_weights: lanes(|tap| tap.near_weight),
            far_weights: lanes(|tap| tap.far_weight),
            taps,
        }
    }

    /// Number of output columns.
    pub(super) fn len(&self) -> usize {
        self.taps.len()
    }
}

/// One source row resized to the output's columns, kept because the next output row often needs it again.
#[derive(Debug, Default)]
pub(super) struct Row {
    number: Option<usize>,
    near: Vec<[u8; LANES]>,
    far: Vec<[u8; LANES]>,
    resized: Vec<Resized>,
}

impl Row {
    /// Whether this is that row of the source.
    pub(super) fn is(&self, number: usize) -> bool {
        self.number == Some(number)
    }

    /// Another image comes.
    pub(super) fn forget(&mut self) {
        self.number = None;
    }

    /// Resizes row `number`; `source` is interleaved blue, green, red from that row's start to the image's end.
    pub(super) fn resize(&mut self, number: usize, source: &[u8], columns: &Columns) {
        self.number = Some(number);
        self.near.resize(columns.len(), Default::default());
        self.far.resize(columns.len(), Default::default());
        self.resized.resize(columns.len(), Default::default());
        self.fetch(source, &columns.taps);
        mix(
            self.near.as_flattened(),
            self.far.as_flattened(),
            columns.near_weights.as_flattened(),
            columns.far_weights.as_flattened(),
            self.resized.as_flattened_mut(),
        );
    }

    fn fetch(&mut self, source: &[u8], taps: &[Tap]) {
        for ((tap, near), far) in taps.iter().zip(&mut self.near).zip(&mut self.far) {
            let start = tap.near * CHANNELS;
            if let Some(pair) = source.get(start..start + PAIR) {
                near.copy_from_slice(&pair[..LANES]);
                far.copy_from_slice(&pair[CHANNELS..]);
            } else {
                // Nothing follows the image's last pixel.
                near[..CHANNELS].copy_from_slice(&source[start..][..CHANNELS]);
                far[..CHANNELS].copy_from_slice(&source[tap.far * CHANNELS..][..CHANNELS]);
            }
        }
    }
}

/// Horizontally: OpenCV drops the four low bits of its weight of 2048 before it goes on, after which 16 bits
/// are enough.
#[multiversion(targets("x86_64+avx2"))]
fn mix(near: &[u8], far: &[u8], near_weights: &[i16], far_weights: &[i16], out: &mut [i16]) {
    let near = near.iter().zip(near_weights);
    let far = far.iter().zip(far_weights);
    let product = |(&value, &weight): (&u8, &i16)| i32::from(i16::from(value)) * i32::from(weight);
    for (out, (near, far)) in out.iter_mut().zip(near.zip(far)) {
        *out = ((product(near) + product(far)) >> 4) as i16;
    }
}

/// Two rows mixed vertically, with OpenCV's shifts, which set the rounding: the high halves of 16-bit
/// products are one instruction for many of them, so everything before the floats stays in 16 bits.
/// The planes are blue, green, red.
pub(super) fn blend(near: &Row, far: &Row, tap: Tap, scale: f32, planes: [&mut [f32]; CHANNELS]) {
    let weights = (tap.near_weight, tap.far_weight);
    blend_lanes(&near.resized, &far.resized, weights, scale, planes);
}

#[multiversion(targets("x86_64+avx2"))]
fn blend_lanes(
    near: &[Resized],
    far: &[Resized],
    weights: (i16, i16),
    scale: f32,
    [blue, green, red]: [&mut [f32]; CHANNELS],
) {
    let high = |weight: i16, value: i16| ((i32::from(weight) * i32::from(value)) >> 16) as i16;
    let planes = blue.iter_mut().zip(green).zip(red);
    for ((near, far), ((blue, green), red)) in near.iter().zip(far).zip(planes) {
        let mixed: Resized = std::array::from_fn(|lane| {
            (high(weights.0, near[lane]) + high(weights.1, far[lane]) + 2) >> 2
        });
        *blue = f32::from(mixed[0]) * scale;
        *green = f32::from(mixed[1]) * scale;
        *red = f32::from(mixed[2]) * scale;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same arithmetic, value by value.
    fn expected(source: &[u8], width: usize, across: Tap, down: Tap, channel: usize) -> f32 {
        let value = |row: usize, column: usize| {
            i32::from(source[(row * width + column) * CHANNELS + channel])
        };
        let row = |row: usize| {
            let near = value(row, across.near) * i32::from(across.near_weight);
            (near + value(row, across.far) * i32::from(across.far_weight)) >> 4
        };
        let high = |weight: i16, value: i32| (i32::from(weight) * value) >> 16;
        let mixed = high(down.near_weight, row(down.near)) + high(down.far_weight, row(down.far));
        ((mixed + 2) >> 2) as f32
    }

    proptest! {
        #[test]
        fn every_value_is_the_fixed_point_one(
            (width, height) in (1_usize..40, 1_usize..12),
            (to_width, to_height) in (1_usize..50, 1_usize..12),
            bytes in proptest::collection::vec(any::<u8>(), 40 * 12 * CHANNELS),
        ) {
            let source = &bytes[..width * height * CHANNELS];
            let columns = Columns::new(width, to_width);
            let (mut near, mut far) = (Row::default(), Row::default());
            for down in taps(height, to_height) {
                let from_row = |row: usize| &source[row * width * CHANNELS..];
                near.resize(down.near, from_row(down.near), &columns);
                far.resize(down.far, from_row(down.far), &columns);
                let mut planes = vec![0.0; CHANNELS * to_width];
                let (blue, rest) = planes.split_at_mut(to_width);
                let (green, red) = rest.split_at_mut(to_width);
                blend(&near, &far, down, 1.0, [blue, green, red]);
                for (at, across) in taps(width, to_width).into_iter().enumerate() {
                    for channel in 0..CHANNELS {
                        let value = expected(source, width, across, down, channel);
                        prop_assert_eq!(planes[channel * to_width + at], value);
                    }
                }
            }
        }
    }
}
