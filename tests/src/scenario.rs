//! What moves where, and who looks at it.

use crate::{
    path::Path,
    random::{Purpose, Random},
};
use roadwatch_core::{ObjectClass, Rig, SizeLwh, Timestamp};
use std::time::Duration;

/// When every scenario begins: any moment will do, as long as its nanoseconds do not fit an `f64`.
const BEGIN: Timestamp = Timestamp::from_nanos(1_700_000_000_123_456_789);

/// A car as the paper's Table 2 has it, which is also what locators assume.
pub const CAR_SIZE: SizeLwh = SizeLwh {
    length_m: 5.1,
    width_m: 1.9,
    height_m: 1.5,
};

/// Something that can be seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Actor {
    /// What it is.
    pub class: ObjectClass,
    /// How large it really is.
    pub size: SizeLwh,
    /// How it moves.
    pub path: Path,
}

impl Actor {
    /// A car of [`CAR_SIZE`].
    #[must_use]
    pub fn car(path: Path) -> Self {
        Self {
            class: ObjectClass::new("car"),
            size: CAR_SIZE,
            path,
        }
    }

    /// A car of another size than locators assume.
    #[must_use]
    pub fn car_of(size: SizeLwh, path: Path) -> Self {
        Self {
            size,
            ..Self::car(path)
        }
    }
}

/// A stretch of time on flat ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The cameras, as everybody believes them to be.
    pub rig: Rig,
    /// The vehicle that carries them.
    pub ego: Path,
    /// Everybody else. Their places here are their numbers.
    pub actors: Vec<Actor>,
    /// Frames of each camera.
    pub frames: u64,
    /// From one frame to the next.
    pub period: Duration,
    /// From one camera of a frame to the next, in order of their ids; all of them fit into a period.
    pub stagger: Duration,
    /// How far each capture is from where it should be, at most, evenly; frames of one camera stay in order.
    pub stamp_jitter: Duration,
}

impl Scenario {
    /// Time since the begin at which a camera captures a frame.
    #[must_use]
    pub fn moment(&self, camera: usize, frame: u64) -> Duration {
        let whole = self.period.as_nanos() as u64 * frame;
        let jitter = self
            .stamp_jitter
            .mul_f64(Random::keyed(0, Purpose::StampJitter, &[camera as u64, frame]).unit());
        Duration::from_nanos(whole + self.stagger.as_nanos() as u64 * camera as u64) + jitter
    }

    /// The stamp of a moment.
    #[must_use]
    pub fn stamp(&self, moment: Duration) -> Timestamp {
        BEGIN.saturating_add(moment)
    }
}
