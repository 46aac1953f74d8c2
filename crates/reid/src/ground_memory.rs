//! The slopes of the ground under the rig, from what boxes in all directions say of it.

use crate::unevenness::Unevenness;
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};
use roadwatch_core::{CameraId, GroundReading, SlopeEvidence, Timestamp, TrackId};
use std::{collections::BTreeMap, time::Duration};

/// What has faded to this share of its weight is forgotten.
const FORGOTTEN_SHARE: f64 = 0.01;
/// For about how long the ground stays as uneven as it was: some hundred metres of one road.
const UNEVENNESS_LASTS: Duration = Duration::from_secs(60);

/// Remembers what each object says of the ground: a plane with one slope ahead and one to the left
/// (docs/method.md, section 3, "the ground").
///
/// An object says the same in every frame, its own size's mistake included, so its readings are averaged over
/// the memory's length and not added up: all readings of one object together weigh as much as one. When it is
/// gone they fade in that time. What objects have in common is unknown as well: all of them, cars that are larger
/// than expected on the whole; those that one camera sees, ground that leaves the plane on that side. So a whole
/// street of cars ahead says no more of the slope than streets are flat, and both sides together tell it from
/// the cars' size.
///
/// How much readings scatter tells how uneven the ground is. Each object counts for one reading, also when it is gone.
#[derive(Debug)]
pub(crate) struct GroundMemory {
    length: Duration,
    objects: BTreeMap<(CameraId, TrackId), Evidence>,
    /// What objects said of the ground's unevenness that are gone, and when.
    gone: (Unevenness, Timestamp),
}

/// What one object says of both slopes, of the mean size, and of its side's own slope; and of how uneven the ground is.
#[derive(Clone, Copy, Debug)]
struct Evidence {
    information: Matrix4<f64>,
    pull: Vector4<f64>,
    unevenness: Unevenness,
    at: Timestamp,
}

impl GroundMemory {
    /// Remembers for about that long; never anything when it is zero.
    pub(crate) fn new(length: Duration) -> Self {
        Self {
            length,
            objects: BTreeMap::new(),
            gone: (Unevenness::NOTHING, Timestamp::from_nanos(0)),
        }
    }

    /// Takes in what an object says.
    pub(crate) fn learn(
        &mut self,
        object: (CameraId, TrackId),
        reading: &GroundReading,
        at: Timestamp,
    ) {
        if self.length.is_zero() {
            return;
        }
        let new = Evidence::of(reading, at);
        let before = self.objects.get(&object);
        let averaged = before.map_or(new, |before| {
            let kept = self.kept(before, at);
            Evidence {
                information: before.information * kept + new.information * (1.0 - kept),
                pull: before.pull * kept + new.pull * (1.0 - kept),
                unevenness: before.unevenness.blend(kept, &new.unevenness, 1.0 - kept),
                at,
            }
        });
        self.objects.insert(object, averaged);
    }

    /// Forgets what has faded by `now`.
    pub(crate) fn forget(&mut self, now: Timestamp) {
        let gone = self.objects.extract_if(.., |_, evidence| {
            share_left(evidence.at, now, self.length) <= FORGOTTEN_SHARE
        });
        for (_, evidence) in gone {
            let (sum, at) = self.gone;
            let left = share_left(at, evidence.at, UNEVENNESS_LASTS);
            let sum = sum.blend(left, &evidence.unevenness, 1.0).of_past();
            self.gone = (sum, evidence.at.max(at));
        }
    }

    /// All objects together, at a moment.
    pub(crate) fn at(&self, now: Timestamp) -> Ground<'_> {
        let mut sides = BTreeMap::new();
        for ((camera, _), evidence) in &self.objects {
            let side = sides.entry(*camera).or_insert_with(Side::default);
            side.add(evidence, self.kept(evidence, now));
        }
        let left = share_left(self.gone.1, now, UNEVENNESS_LASTS);
        let gone = self.gone.0.blend(left, &Unevenness::NOTHING, 0.0);
        let here = self.objects.values();
        Ground {
            memory: self,
            now,
            sides,
            unevenness: here.fold(gone, |sum, one| sum.blend(1.0, &one.unevenness, 1.0)),
        }
    }

    fn kept(&self, evidence: &Evidence, now: Timestamp) -> f64 {
        share_left(evidence.at, now, self.length)
    }
}

impl Evidence {
    fn of(reading: &GroundReading, at: Timestamp) -> Self {
        let by = Vector4::new(
            reading.place.x,
            reading.place.y,
            reading.by_mean_size_m,
            reading.by_side_m,
        );
        let precision = reading.std_dev_m.powi(-2);
        Self {
            information: by * by.transpose() * precision,
            pull: by * (reading.height_m * precision),
            unevenness: Unevenness::of(reading),
            at,
        }
    }
}

/// What is remembered at one moment.
pub(crate) struct Ground<'a> {
    memory: &'a GroundMemory,
    now: Timestamp,
    sides: BTreeMap<CameraId, Side>,
    unevenness: Unevenness,
}

/// What the objects say that one camera sees.
#[derive(Clone, Copy, Default)]
struct Side {
    information: Matrix4<f64>,
    pull: Vector4<f64>,
}

impl Side {
    fn add(&mut self, evidence: &Evidence, weight: f64) {
        self.information += evidence.information * weight;
        self.pull += evidence.pull * weight;
    }

    /// Of slopes and mean size, whatever the side's own slope is; that is expected to be one of its standard
    /// deviations.
    fn without_own_slope(&self) -> (Matrix3<f64>, Vector3<f64>) {
        let own = self.information[(3, 3)] + 1.0;
        let shared = self.information.fixed_view::<3, 1>(0, 3).into_owned();
        let rest = self.information.fixed_view::<3, 3>(0, 0).into_owned();
        (
            rest - shared * shared.transpose() / own,
            self.pull.xyz() - shared * (self.pull.w / own),
        )
    }
}

impl Ground<'_> {
    /// What all objects but this one say of the slopes, whatever the mean size.
    pub(crate) fn without(&self, object: (CameraId, TrackId)) -> SlopeEvidence {
        let (mut information, mut pull) = (Matrix3::zeros(), Vector3::zeros());
        for (camera, side) in &self.sides {
            let mut side = *side;
            if let (true, Some(own)) = (*camera == object.0, self.memory.objects.get(&object)) {
                side.add(own, -self.memory.kept(own, self.now));
            }
            let (more, pulled) = side.without_own_slope();
            information += more;
            pull += pulled;
        }
        // The mean size is expected to be off by one of its standard deviations, and is not asked for.
        let size = information[(2, 2)] + 1.0;
        let shared = information.fixed_view::<2, 1>(0, 2).into_owned();
        let slopes = information.fixed_view::<2, 2>(0, 0).into_owned();
        SlopeEvidence {
            information: slopes - shared * shared.transpose() / size,
            pull: pull.xy() - shared * (pull.z / size),
            unevenness: self.unevenness_without(object),
        }
    }

    /// How uneven all objects but this one say that the ground is.
    fn unevenness_without(&self, object: (CameraId, TrackId)) -> f64 {
        if self.memory.length.is_zero() {
            return 1.0;
        }
        let own = self.memory.objects.get(&object);
        let others = own.map_or(self.unevenness, |own| {
            self.unevenness.blend(1.0, &own.unevenness, -1.0)
        });
        others.expected()
    }
}

/// The share of its weight that evidence of a moment has at a later one.
fn share_left(at: Timestamp, now: Timestamp, length: Duration) -> f64 {
    let age = now.saturating_since(at);
    (-age.as_secs_f64() / length.as_secs_f64()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    const MEMORY: Duration = Duration::from_secs(2);

    fn at(millis: i64) -> Timestamp {
        Timestamp::from_nanos(1_000_000_000 + millis * 1_000_000)
    }

    /// Each seen by a camera of its own.
    fn object(id: u8) -> (CameraId, TrackId) {
        (CameraId(id), TrackId(u64::from(id)))
    }

    /// What an object at a place says of ground with these slopes, all objects larger than expected by so many
    /// deviations of their mean size.
    fn reading((x, y): (f64, f64), slopes: (f64, f64), larger: f64) -> GroundReading {
        let by_mean_size_m = 0.08;
        GroundReading {
            place: Vector2::new(x, y),
            height_m: x * slopes.0 + y * slopes.1 + larger * by_mean_size_m,
            std_dev_m: 0.1,
            by_mean_size_m,
            by_side_m: 0.003 * x.hypot(y),
            by_box_m: 0.1,
            configured_m: 0.014 * x.hypot(y),
        }
    }

    fn slopes(evidence: &SlopeEvidence) -> Vector2<f64> {
        let inverse = evidence.information.try_inverse().expect("known");
        inverse * evidence.pull
    }

    #[test]
    fn objects_around_the_vehicle_tell_its_slopes_whatever_their_mean_size() {
        let mut memory = GroundMemory::new(MEMORY);
        let places = [(20.0, 3.0), (-25.0, -3.0), (4.0, 12.0), (2.0, -15.0)];
        for (id, place) in (1..).zip(places) {
            memory.learn(object(id), &reading(place, (0.01, -0.03), 1.0), at(0));
        }
        let found = slopes(&memory.at(at(0)).without(object(99)));
        assert!(
            (found - Vector2::new(0.01, -0.03)).norm() < 0.006,
            "{found}"
        );
    }

    #[test]
    fn a_street_of_cars_on_one_side_says_no_more_than_streets_are_flat() {
        let mut memory = GroundMemory::new(MEMORY);
        for id in 0..200_u32 {
            let place = (10.0 + f64::from(id) / 10.0, 0.0);
            let object = (CameraId(0), TrackId(u64::from(id)));
            memory.learn(object, &reading(place, (0.01, 0.0), 0.0), at(0));
        }
        let found = memory.at(at(0)).without(object(9));
        let std_dev = found.information[(0, 0)].recip().sqrt();
        assert!((0.003..0.006).contains(&std_dev), "{std_dev}");
    }

    #[test]
    fn an_object_seen_a_hundred_times_weighs_as_much_as_one_seen_once() {
        let (mut once, mut often) = (GroundMemory::new(MEMORY), GroundMemory::new(MEMORY));
        let seen = reading((20.0, 3.0), (0.01, 0.0), 0.0);
        once.learn(object(1), &seen, at(10_000));
        for frame in 0..100 {
            often.learn(object(1), &seen, at(100 + frame * 100));
        }
        let [once, often] = [once, often].map(|memory| memory.at(at(10_000)).without(object(9)));
        assert!((once.information - often.information).norm() < 1e-6 * once.information.norm());
    }

    #[test]
    fn an_object_learns_nothing_of_the_ground_from_itself() {
        let mut memory = GroundMemory::new(MEMORY);
        memory.learn(object(1), &reading((20.0, 3.0), (0.02, 0.0), 0.0), at(0));
        let without = memory.at(at(50)).without(object(1));
        assert!(without.information.norm() < 1e-6);
    }

    #[test]
    fn what_nobody_says_any_more_fades_and_is_forgotten() {
        let mut memory = GroundMemory::new(MEMORY);
        memory.learn(object(1), &reading((20.0, 3.0), (0.02, 0.0), 0.0), at(0));
        let weight = |memory: &GroundMemory, millis| {
            memory.at(at(millis)).without(object(9)).information.norm()
        };
        assert!(weight(&memory, 4_000) < 0.5 * weight(&memory, 0));
        memory.forget(at(20_000));
        assert!(memory.objects.is_empty());
    }

    #[test]
    fn a_memory_of_no_length_learns_nothing() {
        let mut memory = GroundMemory::new(Duration::ZERO);
        memory.learn(object(1), &reading((20.0, 3.0), (0.02, 0.0), 0.0), at(0));
        assert_eq!(
            memory.at(at(0)).without(object(9)),
            SlopeEvidence::default()
        );
    }
}
