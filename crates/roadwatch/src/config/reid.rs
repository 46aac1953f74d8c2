//! `[reid]`: who is who.

use super::reader::Reader;
use roadwatch_core::{Reidentifier, Rig};
use roadwatch_reid::{ByBearing, ByCamera, Rule, Tracker, TrackingOptions};
use std::{sync::Arc, time::Duration};

/// Longer than this nobody is worth remembering, seconds: another has taken the place.
const LONGEST_MEMORY_SECS: f64 = 120.0;
/// Shorter times than this are below any camera's interval, seconds.
const SHORTEST_SECS: f64 = 0.01;
/// More sights than this are never waited for.
const MOST_SIGHTS: u32 = 100;
/// Fewer objects than this would not hold one camera's, more cost more than a frame's time.
const OBJECTS: std::ops::RangeInclusive<u32> = 10..=10_000;

/// How identities are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Identities {
    /// Tracked through time, across cameras.
    #[default]
    Tracks,
    /// Each camera by itself.
    ByCamera(Rule),
    /// From left to right around the rig.
    ByBearing,
}

impl Identities {
    /// Each with its name.
    pub const ALL: [(&str, Self); 4] = [
        ("tracks", Self::Tracks),
        ("left_to_right", Self::ByCamera(Rule::LeftToRight)),
        ("left_to_right_rig", Self::ByBearing),
        ("iou", Self::ByCamera(Rule::Overlap)),
    ];

    /// Its name.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        let mut all = Self::ALL.into_iter();
        all.find(|(_, one)| *one == self)
            .map_or("", |(name, _)| name)
    }
}

/// `[reid]`.
#[derive(Debug, Clone, Default)]
pub struct ReidConfig {
    /// `method`.
    pub identities: Identities,
    /// The others, which are about tracks.
    pub tracking: TrackingOptions,
}

impl ReidConfig {
    /// What gives identities, with what it remembers of the ground.
    #[must_use]
    pub fn reidentifier(&self, rig: &Arc<Rig>, ground_memory: Duration) -> Box<dyn Reidentifier> {
        match self.identities {
            Identities::Tracks => {
                let options = TrackingOptions {
                    ground_memory,
                    ..self.tracking.clone()
                };
                Box::new(Tracker::new(Arc::clone(rig), options))
            }
            Identities::ByCamera(rule) => Box::new(ByCamera::new(rule, ground_memory)),
            Identities::ByBearing => Box::new(ByBearing::new(ground_memory)),
        }
    }
}

pub(super) fn read(reid: &Reader<'_, '_>) -> ReidConfig {
    let defaults = TrackingOptions::default();
    let time = |key, default: Duration| {
        let secs = reid.number(key, SHORTEST_SECS..=LONGEST_MEMORY_SECS);
        secs.map_or(default, Duration::from_secs_f64)
    };
    ReidConfig {
        identities: reid.choice("method", &Identities::ALL).unwrap_or_default(),
        tracking: TrackingOptions {
            confirm_after: reid
                .integer("confirm_after", 1..=MOST_SIGHTS)
                .unwrap_or(defaults.confirm_after),
            coast: time("coast_secs", defaults.coast),
            forget_after: time("forget_after_secs", defaults.forget_after),
            doubt_after: time("doubt_after_secs", defaults.doubt_after),
            remember: time("remember_secs", defaults.remember),
            most_objects: reid
                .integer("most_objects", OBJECTS)
                .map_or(defaults.most_objects, |most| most as usize),
            ..defaults
        },
    }
}
