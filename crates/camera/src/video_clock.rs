//! When each frame of a video was captured, from what its container says and its nominal rate.

use crate::frame_rate::FrameRate;
use std::time::Duration;

/// Matroska rounds times to whole milliseconds; a time this close to the nominal one is the nominal one.
const CONTAINER_ROUNDING: Duration = Duration::from_millis(1);
const MILLIS_PER_SEC: f64 = 1000.0;

/// Gives rising offsets from the first frame.
///
/// Presentation times are believed, because a frame that the decoder skips, or a variable rate, must not shift
/// every later stamp. A time within a millisecond of a whole number of nominal intervals is replaced by that
/// exact multiple; one that is missing or does not rise, by the next whole interval.
#[derive(Debug)]
pub(crate) struct VideoClock {
    rate: FrameRate,
    origin_msec: Option<f64>,
    last: Option<Duration>,
}

impl VideoClock {
    pub(crate) fn new(rate: FrameRate) -> Self {
        Self {
            rate,
            origin_msec: None,
            last: None,
        }
    }

    /// The offset of the next frame, whose presentation time the container gives as `position_msec`.
    pub(crate) fn advance(&mut self, position_msec: f64) -> Duration {
        let origin_msec = *self.origin_msec.get_or_insert(position_msec);
        let secs = (position_msec - origin_msec) / MILLIS_PER_SEC;
        let told = Duration::try_from_secs_f64(secs).ok();
        let offset = told
            .map(|offset| self.snap(offset))
            .filter(|&offset| self.last.is_none_or(|last| offset > last))
            .unwrap_or_else(|| self.next_interval());
        self.last = Some(offset);
        offset
    }

    fn snap(&self, offset: Duration) -> Duration {
        let nominal = self.rate.offset(self.rate.nearest_index(offset));
        if nominal.abs_diff(offset) <= CONTAINER_ROUNDING {
            nominal
        } else {
            offset
        }
    }

    fn next_interval(&self) -> Duration {
        let Some(last) = self.last else {
            return Duration::ZERO;
        };
        let nearest = self.rate.nearest_index(last);
        let nominal = self.rate.offset(nearest);
        if nominal > last {
            nominal
        } else {
            self.rate.offset(nearest + 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offsets(hz: f64, positions_msec: &[f64]) -> Vec<u128> {
        let mut clock = VideoClock::new(FrameRate::from_hz(hz).expect("a rate"));
        let offsets = positions_msec
            .iter()
            .map(|&at| clock.advance(at).as_nanos());
        offsets.collect()
    }

    #[test]
    fn times_rounded_to_milliseconds_become_exact() {
        assert_eq!(
            offsets(30.0, &[0.0, 33.0, 67.0, 100.0]),
            [0, 33_333_333, 66_666_666, 100_000_000]
        );
    }

    #[test]
    fn a_skipped_frame_leaves_a_gap_and_shifts_nothing() {
        assert_eq!(
            offsets(25.0, &[80.0, 120.0, 200.0]),
            [0, 40_000_000, 120_000_000]
        );
    }

    #[test]
    fn a_variable_rate_is_believed() {
        assert_eq!(
            offsets(25.0, &[0.0, 55.0, 92.0]),
            [0, 55_000_000, 92_000_000]
        );
    }

    #[test]
    fn without_times_the_nominal_rate_counts() {
        assert_eq!(
            offsets(25.0, &[0.0, 0.0, f64::NAN, -40.0]),
            [0, 40_000_000, 80_000_000, 120_000_000]
        );
    }
}
