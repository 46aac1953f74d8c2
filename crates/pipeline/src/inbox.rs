//! The inbox: one slot per camera, between the camera threads and the detector.
//!
//! With [`Overload::NewestWins`] a new frame replaces the one that waits, and the camera that waited
//! longest for its turn goes first. With [`Overload::Wait`] a camera waits until its slot is free, and
//! frames are taken in order of (capture time, camera).

use crate::{camera_set::CameraSet, options::Overload};
use roadwatch_core::{CameraId, Clock, Frame};
use std::{
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// A camera that delivered nothing for this long is down.
pub const DOWN_AFTER: Duration = Duration::from_secs(1);

/// What became of a frame that was put into its slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Put {
    /// It waits.
    Stored,
    /// It waits, in the place of an older one, which nobody looked at.
    Replaced,
    /// It is gone: nobody takes frames any more.
    Closed,
}

/// One frame on its way to the detector.
#[derive(Debug)]
pub struct Taken {
    /// The frame.
    pub frame: Frame,
    /// The cameras that are alive, as known when the frame was taken: a scene waits for these.
    pub live: CameraSet,
}

/// Frames taken together, with their place in the order of all takes.
#[derive(Debug)]
pub struct Batch {
    /// Counts takes, from 0, without gaps.
    pub ticket: u64,
    /// At least one frame.
    pub taken: Vec<Taken>,
}

struct Slot {
    frame: Option<Frame>,
    open: bool,
    /// Number of the take that served this camera last; the least goes first.
    served_at: u64,
    last_put: Instant,
}

struct State {
    slots: Vec<Slot>,
    served: u64,
    tickets: u64,
    /// Frames taken and not done with.
    in_work: usize,
    receiver_open: bool,
}

struct Shared {
    overload: Overload,
    clock: Arc<dyn Clock>,
    state: Mutex<State>,
    changed: Condvar,
    /// Held while a batch is put together, so that lanes take in turn.
    taking: Mutex<()>,
}

/// One camera's end.
pub struct Sender {
    shared: Arc<Shared>,
    camera: CameraId,
}

/// The detector's end.
pub struct Receiver {
    shared: Arc<Shared>,
}

/// An inbox for cameras `0..cameras`; one sender for each.
#[must_use]
pub fn inbox(cameras: u8, overload: Overload, clock: Arc<dyn Clock>) -> (Vec<Sender>, Receiver) {
    let now = clock.now();
    let slot = |_| Slot {
        frame: None,
        open: true,
        served_at: 0,
        last_put: now,
    };
    let shared = Arc::new(Shared {
        overload,
        clock,
        state: Mutex::new(State {
            slots: (0..cameras).map(slot).collect(),
            served: 0,
            tickets: 0,
            in_work: 0,
            receiver_open: true,
        }),
        changed: Condvar::new(),
        taking: Mutex::new(()),
    });
    let sender = |camera| Sender {
        shared: Arc::clone(&shared),
        camera: CameraId(camera),
    };
    ((0..cameras).map(sender).collect(), Receiver { shared })
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics between two writes to the state.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        self.changed
            .wait(state)
            .unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sender {
    /// The camera this end belongs to.
    #[must_use]
    pub fn camera(&self) -> CameraId {
        self.camera
    }

    /// Puts this camera's next frame into its slot.
    pub fn put(&self, frame: Frame) -> Put {
        let now = self.shared.clock.now();
        let index = self.camera.index();
        let mut state = self.shared.lock();
        if self.shared.overload == Overload::Wait {
            while state.receiver_open && state.slots[index].frame.is_some() {
                state = self.shared.wait(state);
            }
        }
        if !state.receiver_open {
            return Put::Closed;
        }
        state.slots[index].last_put = now;
        let replaced = state.slots[index].frame.replace(frame);
        drop(state);
        self.shared.changed.notify_all();
        if replaced.is_some() {
            Put::Replaced
        } else {
            Put::Stored
        }
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        self.shared.lock().slots[self.camera.index()].open = false;
        self.shared.changed.notify_all();
    }
}

impl Receiver {
    /// Waits for the next frames, at least one and at most `max`; `None` once every camera is closed and
    /// every slot empty.
    ///
    /// With [`Overload::Wait`] a batch is full unless the cameras end, whatever the timing. With
    /// [`Overload::NewestWins`] frames stay in their slots for `hold_off` (asked when it is this call's turn),
    /// where newer ones replace them.
    #[must_use]
    pub fn take(&self, max: usize, hold_off: impl FnOnce() -> Duration) -> Option<Batch> {
        let _turn = self
            .shared
            .taking
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let taken = match self.shared.overload {
            Overload::NewestWins => {
                self.rest(hold_off());
                self.take_waiting(max)
            }
            Overload::Wait => self.take_in_order(max),
        };
        if taken.is_empty() {
            return None;
        }
        self.shared.changed.notify_all();
        let mut state = self.shared.lock();
        state.in_work += taken.len();
        state.tickets += 1;
        Some(Batch {
            ticket: state.tickets - 1,
            taken,
        })
    }

    /// Says that a taken frame has gone on or was dropped.
    pub fn done(&self) {
        let mut state = self.shared.lock();
        state.in_work = state.in_work.saturating_sub(1);
    }

    /// Whether a frame waits or is worked on: then somebody will be heard of soon.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.in_work > 0 || state.slots.iter().any(|slot| slot.frame.is_some())
    }

    /// Waits, not longer than there are cameras that could bring something newer.
    fn rest(&self, hold_off: Duration) {
        let any_open = |state: &mut State| state.slots.iter().any(|slot| slot.open);
        let state = self.shared.lock();
        drop(
            self.shared
                .changed
                .wait_timeout_while(state, hold_off, any_open),
        );
    }

    fn take_waiting(&self, max: usize) -> Vec<Taken> {
        let mut state = self.shared.lock();
        while state.slots.iter().all(|slot| slot.frame.is_none()) {
            if state.slots.iter().all(|slot| !slot.open) {
                return Vec::new();
            }
            state = self.shared.wait(state);
        }
        let live = state.live(self.shared.clock.now());
        let mut taken = Vec::with_capacity(max.min(state.slots.len()));
        while taken.len() < max {
            let waiting = (0..state.slots.len()).filter(|&at| state.slots[at].frame.is_some());
            let Some(next) = waiting.min_by_key(|&at| (state.slots[at].served_at, at)) else {
                break;
            };
            taken.extend(state.serve(next, live));
        }
        taken
    }

    fn take_in_order(&self, max: usize) -> Vec<Taken> {
        let mut taken = Vec::with_capacity(max);
        let mut state = self.shared.lock();
        while taken.len() < max {
            while state
                .slots
                .iter()
                .any(|slot| slot.open && slot.frame.is_none())
            {
                state = self.shared.wait(state);
            }
            let live = state.occupied();
            let order = |at: usize| Some((state.slots[at].frame.as_ref()?.captured_at, at));
            let Some((_, next)) = (0..state.slots.len()).filter_map(order).min() else {
                break;
            };
            taken.extend(state.serve(next, live));
            self.shared.changed.notify_all();
        }
        taken
    }
}

impl Drop for Receiver {
    fn drop(&mut self) {
        self.shared.lock().receiver_open = false;
        self.shared.changed.notify_all();
    }
}

impl State {
    fn serve(&mut self, at: usize, live: CameraSet) -> Option<Taken> {
        self.served += 1;
        let slot = &mut self.slots[at];
        slot.served_at = self.served;
        let frame = slot.frame.take()?;
        Some(Taken { frame, live })
    }

    /// Cameras that deliver: open and not silent for [`DOWN_AFTER`], or with a frame that waits.
    fn live(&self, now: Instant) -> CameraSet {
        let lives = |slot: &Slot| {
            let silent = now.saturating_duration_since(slot.last_put);
            slot.frame.is_some() || (slot.open && silent < DOWN_AFTER)
        };
        self.cameras_where(lives)
    }

    fn occupied(&self) -> CameraSet {
        self.cameras_where(|slot| slot.frame.is_some())
    }

    fn cameras_where(&self, condition: impl Fn(&Slot) -> bool) -> CameraSet {
        let slots = self.slots.iter().enumerate();
        // `inbox` counts cameras in `u8`.
        slots
            .filter(|(_, slot)| condition(slot))
            .map(|(at, _)| CameraId(at as u8))
            .collect()
    }
}
