//! The clock that all recorded sources of one rig share: when a frame is due, and how often all repeats.

use crate::span::Span;
use roadwatch_core::Timestamp;
use std::{
    sync::{Arc, OnceLock},
    thread,
    time::{Duration, Instant},
};

/// How fast recorded time passes: 1 as recorded, 2 twice as fast. Finite and above zero.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Speed(f64);

impl Speed {
    /// As recorded.
    pub const RECORDED: Self = Self(1.0);

    /// `None` unless `factor` is finite and above zero.
    #[must_use]
    pub fn new(factor: f64) -> Option<Self> {
        (factor.is_finite() && factor > 0.0).then_some(Self(factor))
    }

    /// The factor.
    #[must_use]
    pub fn get(self) -> f64 {
        self.0
    }

    /// How long `recorded` lasts at this speed; `None` beyond what a [`Duration`] holds.
    fn stretch(self, recorded: Duration) -> Option<Duration> {
        Duration::try_from_secs_f64(recorded.as_secs_f64() / self.0).ok()
    }
}

/// When frames are handed out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// At the moments of their stamps, as a live camera would. A reader that is late gets what is due at once.
    Recorded {
        /// How fast recorded time passes.
        speed: Speed,
    },
    /// As soon as somebody asks.
    AsFastAsPossible,
}

/// What follows the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeat {
    /// The end.
    Once,
    /// The first frame again, one lap later in time: stamps keep rising.
    Loop,
}

/// How recordings are played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaybackOptions {
    /// When frames are handed out.
    pub pace: Pace,
    /// What follows the last frame.
    pub repeat: Repeat,
    /// Each camera ends after this many frames, lost ones included; `None` for no limit.
    pub frame_limit: Option<u64>,
}

/// Whether it is a frame's turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// It is.
    Now,
    /// The deadline came first.
    NotYet,
}

/// The shared clock. Recorded time starts at the earliest stamp over all cameras, and real time with the
/// first source that waits, so that opening files does not count.
#[derive(Debug)]
pub struct Playback {
    options: PlaybackOptions,
    epoch: Timestamp,
    lap: Duration,
    started: OnceLock<Instant>,
}

impl Playback {
    /// The clock for recordings of these spans, one per camera. One lap takes as long as the longest of them,
    /// plus one of its intervals, so that the cameras of a looping rig stay in step.
    #[must_use]
    pub fn new(options: PlaybackOptions, spans: &[Span]) -> Arc<Self> {
        Arc::new(Self {
            options,
            epoch: spans
                .iter()
                .map(|span| span.first)
                .min()
                .unwrap_or_default(),
            lap: spans.iter().map(Span::lap).max().unwrap_or_default(),
            started: OnceLock::new(),
        })
    }

    /// How recordings are played.
    #[must_use]
    pub fn options(&self) -> &PlaybackOptions {
        &self.options
    }

    /// Time from a frame to its repetition.
    #[must_use]
    pub fn lap(&self) -> Duration {
        self.lap
    }

    /// Waits until a frame captured at `stamp` is due, but never beyond `deadline`.
    #[must_use]
    pub fn wait_until_due(&self, stamp: Timestamp, deadline: Instant) -> Due {
        let Pace::Recorded { speed } = self.options.pace else {
            return Due::Now;
        };
        let started = *self.started.get_or_init(Instant::now);
        let due = speed
            .stretch(stamp.saturating_since(self.epoch))
            .and_then(|wait| started.checked_add(wait));
        match due {
            Some(due) if due <= deadline => {
                wait_until(due);
                Due::Now
            }
            Some(due) if due <= Instant::now() => Due::Now,
            _ => {
                wait_until(deadline);
                Due::NotYet
            }
        }
    }
}

/// Parks the thread; loops because a parked thread may be woken for no reason.
fn wait_until(moment: Instant) {
    loop {
        let left = moment.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return;
        }
        thread::park_timeout(left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(millis: i64) -> Timestamp {
        Timestamp::from_nanos(1_557_539_956_000_000_000 + millis * 1_000_000)
    }

    fn span(first_millis: i64, last_millis: i64, interval_millis: u64) -> Span {
        Span {
            first: stamp(first_millis),
            last: stamp(last_millis),
            interval: Duration::from_millis(interval_millis),
        }
    }

    fn recorded(speed: f64) -> PlaybackOptions {
        PlaybackOptions {
            pace: Pace::Recorded {
                speed: Speed::new(speed).expect("a speed"),
            },
            repeat: Repeat::Once,
            frame_limit: None,
        }
    }

    #[test]
    fn a_lap_is_the_longest_cameras() {
        let playback = Playback::new(recorded(1.0), &[span(50, 950, 100), span(0, 500, 300)]);
        assert_eq!(playback.lap(), Duration::from_millis(1000));
    }

    #[test]
    fn time_starts_at_the_earliest_stamp_with_the_first_who_waits() {
        let playback = Playback::new(recorded(1.0), &[span(30, 930, 100), span(0, 900, 100)]);
        let asked = Instant::now();
        let deadline = asked + Duration::from_secs(5);
        assert_eq!(playback.wait_until_due(stamp(30), deadline), Due::Now);
        assert!(asked.elapsed() >= Duration::from_millis(30));
        assert_eq!(playback.wait_until_due(stamp(0), asked), Due::Now);
    }

    #[test]
    fn what_is_not_due_waits_until_the_deadline_only() {
        let slowest = recorded(f64::MIN_POSITIVE);
        for options in [recorded(0.01), slowest] {
            let playback = Playback::new(options, &[span(0, 900, 100)]);
            let deadline = Instant::now() + Duration::from_millis(20);
            assert_eq!(playback.wait_until_due(stamp(100), deadline), Due::NotYet);
            assert!(Instant::now() >= deadline);
        }
    }

    #[test]
    fn a_late_reader_gets_what_is_due_whatever_the_deadline() {
        let playback = Playback::new(recorded(1e6), &[span(0, 900, 100)]);
        let past = Instant::now();
        let later = past + Duration::from_secs(5);
        assert_eq!(playback.wait_until_due(stamp(900), later), Due::Now);
        assert_eq!(playback.wait_until_due(stamp(900), past), Due::Now);
    }

    #[test]
    fn a_speed_is_finite_and_above_zero() {
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Speed::new(factor), None, "{factor}");
        }
    }
}
