//! Objects that turn out to be one.

use super::{association::may_be_one, filter::squared, object::Object};
use nalgebra::Vector2;
use roadwatch_core::{Timestamp, TrackId};
use std::collections::{BTreeMap, BTreeSet};

/// Objects further apart are two, metres: nobody is off by more than this and still taken for anybody.
const NEAR_M: f64 = 8.0;
/// Squared deviations up to which two places, and two velocities, are one.
const MOST_SURPRISE: f64 = 6.0;
/// Rounds in a row in which two must be one before they are.
const ROUNDS: u32 = 3;

/// Two objects, the older first.
type Pair = (TrackId, TrackId);

/// Pairs of objects that may be one.
#[derive(Debug, Default)]
pub(super) struct Duplicates {
    /// Rounds in which they stood at one place.
    one: BTreeMap<Pair, u32>,
    /// Near each other, and seen as two in one frame of one camera.
    two: BTreeSet<Pair>,
}

impl Duplicates {
    /// Takes away objects that stand where an older one stands, when no camera ever showed both at once.
    pub(super) fn merge(&mut self, objects: &mut Vec<Object>, at: Timestamp) {
        let (mut one, mut two) = (BTreeMap::new(), BTreeSet::new());
        let mut gone = BTreeSet::new();
        let places: Vec<Vector2<f64>> = objects.iter().map(Object::last_place).collect();
        for (at_younger, younger) in objects.iter().enumerate() {
            for (at_older, older) in objects[..at_younger].iter().enumerate() {
                let apart = places[at_older] - places[at_younger];
                if apart.norm_squared() > NEAR_M * NEAR_M
                    || !may_be_one(older.class(), younger.class())
                {
                    continue;
                }
                let pair = (older.id, younger.id);
                if self.two.contains(&pair) || were_seen_at_once(older, younger) {
                    two.insert(pair);
                } else if is_one(older, younger, at) {
                    let rounds = self.one.get(&pair).copied().unwrap_or_default() + 1;
                    if rounds >= ROUNDS {
                        gone.insert(younger.id);
                    }
                    one.insert(pair, rounds);
                }
            }
        }
        objects.retain(|object| !gone.contains(&object.id));
        (self.one, self.two) = (one, two);
    }
}

fn were_seen_at_once(older: &Object, younger: &Object) -> bool {
    older.glimpses.iter().any(|one| {
        let mut others = younger.glimpses.iter();
        others.any(|other| other.camera == one.camera && other.at == one.at)
    })
}

fn is_one(older: &Object, younger: &Object, at: Timestamp) -> bool {
    let (one, other) = (older.belief_at(at), younger.belief_at(at));
    let apart = one.position() - other.position();
    let velocities = one.velocity() - other.velocity();
    let spread = one.position_covariance() + other.position_covariance();
    let speed_spread = one.velocity_covariance() + other.velocity_covariance();
    squared(&apart, &spread) < MOST_SURPRISE && squared(&velocities, &speed_spread) < MOST_SURPRISE
}
