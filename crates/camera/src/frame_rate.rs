//! Frame rates as fractions, so that the stamp of frame 1e6 is as exact as that of frame 1.

use std::time::Duration;

const NANOS_PER_SEC: u128 = 1_000_000_000;
/// The denominator of NTSC rates: 24000/1001, 30000/1001, 60000/1001.
const NTSC_DENOMINATOR: u32 = 1001;
/// A rate told as `f64` is taken for a fraction this close to it, frames per second: the fractions in use
/// differ by at least 3e-5 (29.97 and 30000/1001).
const SAME_RATE_HZ: f64 = 1e-6;
/// Denominator of every other rate: micro-hertz.
const DECIMAL_DENOMINATOR: u32 = 1_000_000;
/// Above any camera; what containers report beyond it is a time base, not a rate.
const MAX_HZ: f64 = 2_000.0;
/// One frame in a quarter of an hour; slower than any recording.
const MIN_HZ: f64 = 0.001;

/// Frames per second, as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRate {
    numerator: u32,
    denominator: u32,
}

impl FrameRate {
    /// The fraction that `hz` frames per second stands for: a whole number, `n/1001`, or millionths.
    /// `None` outside `0.001..=2000` frames per second.
    #[must_use]
    pub fn from_hz(hz: f64) -> Option<Self> {
        if !(MIN_HZ..=MAX_HZ).contains(&hz) {
            return None;
        }
        [1, NTSC_DENOMINATOR]
            .into_iter()
            .map(|denominator| Self::nearest(hz, denominator))
            .find(|rate| (rate.hz() - hz).abs() < SAME_RATE_HZ)
            .or_else(|| Some(Self::nearest(hz, DECIMAL_DENOMINATOR)))
    }

    fn nearest(hz: f64, denominator: u32) -> Self {
        Self {
            // At most 2e9 by the bounds above.
            numerator: (hz * f64::from(denominator)).round() as u32,
            denominator,
        }
    }

    /// Frames per second.
    #[must_use]
    pub fn hz(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }

    /// Time from frame 0 to frame `index`, cut to whole nanoseconds.
    #[must_use]
    pub fn offset(self, index: u64) -> Duration {
        let nanos = u128::from(index) * u128::from(self.denominator) * NANOS_PER_SEC
            / u128::from(self.numerator);
        Duration::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
    }

    /// Time from one frame to the next, cut to whole nanoseconds.
    #[must_use]
    pub fn interval(self) -> Duration {
        self.offset(1)
    }

    /// The frame whose offset is nearest to `offset`.
    #[must_use]
    pub fn nearest_index(self, offset: Duration) -> u64 {
        let frame_nanos = u128::from(self.denominator) * NANOS_PER_SEC;
        let scaled = offset.as_nanos() * u128::from(self.numerator);
        u64::try_from((scaled + frame_nanos / 2) / frame_nanos).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_become_the_fractions_they_stand_for() {
        for (hz, numerator, denominator) in [
            (30.0, 30, 1),
            (30_000.0 / 1001.0, 30_000, 1001),
            (24_000.0 / 1001.0, 24_000, 1001),
            (29.97, 29_970_000, 1_000_000),
            (12.5, 12_500_000, 1_000_000),
            (0.5, 500_000, 1_000_000),
        ] {
            let expected = FrameRate {
                numerator,
                denominator,
            };
            assert_eq!(FrameRate::from_hz(hz), Some(expected), "{hz}");
        }
    }

    #[test]
    fn what_is_no_rate_is_refused() {
        for hz in [0.0, -25.0, f64::NAN, f64::INFINITY, 90_000.0] {
            assert_eq!(FrameRate::from_hz(hz), None, "{hz}");
        }
    }

    #[test]
    fn offsets_do_not_drift_and_find_their_index_again() {
        let rate = FrameRate::from_hz(30_000.0 / 1001.0).expect("a rate");
        assert_eq!(rate.offset(30_000), Duration::from_secs(1001));
        for index in [0, 1, 2, 29, 1_000_003] {
            assert_eq!(rate.nearest_index(rate.offset(index)), index);
        }
    }
}
