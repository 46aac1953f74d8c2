//! When the network will be free: so that a frame is taken just in time, and not a whole run too early.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// Weight of the newest run in the averages: a few runs follow a change of load, one outlier does not.
const NEWEST_SHARE: f64 = 0.2;

/// Preparing is begun this much earlier than its average says: too late leaves the network idle, too early
/// lets a frame grow old, and a call that comes early waits for the network anyway.
const PREPARATION_MARGIN: f64 = 1.2;

/// Follows how long preparing and running take.
#[derive(Debug, Default)]
pub(crate) struct Rhythm(Mutex<Averages>);

#[derive(Debug, Default)]
struct Averages {
    /// `None` before the first call.
    free_at: Option<Instant>,
    preparation: Duration,
    run: Duration,
}

impl Rhythm {
    /// A call begins to prepare its images; the network is its own after the calls before it.
    pub(crate) fn preparing(&self, now: Instant) {
        let mut state = self.lock();
        let ready_at = now + state.preparation;
        let begins_at = state.free_at.map_or(ready_at, |free| free.max(ready_at));
        state.free_at = Some(begins_at + state.run);
    }

    /// The images of a call are ready.
    pub(crate) fn prepared(&self, took: Duration) {
        let mut state = self.lock();
        state.preparation = averaged(state.preparation, took);
    }

    /// The network begins to run.
    pub(crate) fn running(&self, now: Instant) {
        let mut state = self.lock();
        state.free_at = Some(now + state.run);
    }

    /// The network has run.
    pub(crate) fn ran(&self, took: Duration) {
        let mut state = self.lock();
        state.run = averaged(state.run, took);
    }

    /// How long a call can begin later than `now` without the network waiting for it.
    pub(crate) fn hold_off(&self, now: Instant) -> Duration {
        let state = self.lock();
        let Some(free_at) = state.free_at else {
            return Duration::ZERO;
        };
        free_at
            .saturating_duration_since(now)
            .saturating_sub(state.preparation.mul_f64(PREPARATION_MARGIN))
    }

    fn lock(&self) -> MutexGuard<'_, Averages> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn averaged(average: Duration, newest: Duration) -> Duration {
    if average.is_zero() {
        newest
    } else {
        average.mul_f64(1.0 - NEWEST_SHARE) + newest.mul_f64(NEWEST_SHARE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    #[test]
    fn the_first_call_begins_at_once() {
        assert_eq!(Rhythm::default().hold_off(Instant::now()), Duration::ZERO);
    }

    #[test]
    fn a_call_is_held_off_until_just_before_the_running_one_ends() {
        let rhythm = Rhythm::default();
        let began = Instant::now();
        rhythm.prepared(ms(10));
        rhythm.ran(ms(50));
        rhythm.running(began);
        assert_eq!(rhythm.hold_off(began), ms(38));
        assert_eq!(rhythm.hold_off(began + ms(30)), ms(8));
        assert_eq!(rhythm.hold_off(began + ms(40)), Duration::ZERO);
    }

    #[test]
    fn a_call_that_prepares_holds_the_next_one_off_for_its_run_too() {
        let rhythm = Rhythm::default();
        let began = Instant::now();
        rhythm.prepared(ms(10));
        rhythm.ran(ms(50));
        rhythm.running(began);
        rhythm.preparing(began + ms(38));
        assert_eq!(rhythm.hold_off(began + ms(50)), ms(38));
    }
}
