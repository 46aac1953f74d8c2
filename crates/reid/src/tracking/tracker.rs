//! Tracks: one identity for one object, through time and across cameras, while the vehicle moves.

use super::{
    association::{Candidates, Outlook, by_image, fix, outlook},
    duplicates::Duplicates,
    filter::Fix,
    found::Found,
    heading::Look,
    object::{Evidence, Object, Sight},
    options::TrackingOptions,
    view::View,
};
use crate::{by_camera::kept, ground_memory::GroundMemory};
use roadwatch_core::{
    CameraId, Detection, Ego, EgoKnowledge, KeptHeading, Known, Oriented, PerFrame, Phase, Prior,
    Reidentifier, Rig, Round, SceneObject, Timestamp, Track, TrackId,
};
use std::{collections::BTreeMap, sync::Arc, time::Duration};

/// A frame that is older than the newest by more than this begins a recording anew.
const BEGINS_ANEW: Duration = Duration::from_secs(2);
/// Between two frames of a camera at most so much time counts as having looked in vain.
const MOST_INTERVAL: Duration = Duration::from_millis(500);

/// Tracks objects in the steady frame with a Kalman filter each (docs/method.md, section 7).
pub struct Tracker {
    pub(super) rig: Arc<Rig>,
    options: TrackingOptions,
    objects: Vec<Object>,
    duplicates: Duplicates,
    ground: GroundMemory,
    next: u64,
    newest: Option<Timestamp>,
    last_frames: BTreeMap<CameraId, Timestamp>,
    late: u64,
}

impl Tracker {
    /// Knows nobody yet.
    #[must_use]
    pub fn new(rig: Arc<Rig>, options: TrackingOptions) -> Self {
        Self {
            rig,
            ground: GroundMemory::new(options.ground_memory),
            options,
            objects: Vec::new(),
            duplicates: Duplicates::default(),
            next: 1,
            newest: None,
            last_frames: BTreeMap::new(),
            late: 0,
        }
    }

    /// Objects in memory, those included that nobody sees.
    #[must_use]
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// Whether nobody is in memory.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// Sights that came too late to say anything of motion.
    #[must_use]
    pub fn late(&self) -> u64 {
        self.late
    }

    pub(super) fn object(&self, id: TrackId) -> Option<&Object> {
        // Identities rise, so the objects are in their order.
        let place = self.objects.binary_search_by_key(&id, |object| object.id);
        place.ok().map(|place| &self.objects[place])
    }

    /// Whether a recording begins anew: it knows nothing of what is still to come.
    fn begins_anew(&self, at: Timestamp) -> bool {
        let anew = |newest: Timestamp| newest.saturating_since(at) > BEGINS_ANEW;
        self.newest.is_some_and(anew)
    }

    fn begin(&mut self, at: Timestamp) {
        if self.begins_anew(at) {
            // Only numbers go on, so that nobody is mistaken for somebody of before.
            *self = Self {
                next: self.next,
                late: self.late,
                ..Self::new(Arc::clone(&self.rig), self.options.clone())
            };
        }
        self.newest = self.newest.max(Some(at));
    }

    /// What is known of an object before a frame shows it.
    fn prior(&self, object: &Object, (camera, at): (CameraId, Timestamp), ego: &Ego) -> Prior {
        let motion = self.motion(object, at, ego);
        let age = at.saturating_since(object.seen_at);
        let looked = object.heading_at.map(|looked| at.saturating_since(looked));
        // A heading of this very moment is another frame's all the same.
        let heading_age = looked.unwrap_or(age).max(Duration::from_nanos(1));
        Prior {
            heading: motion.heading.map(|heading| KeptHeading {
                age: heading_age,
                ..kept(heading, age)
            }),
            location: self.location(object, &motion, camera),
            age,
        }
    }

    /// Who was to be seen and was not: nothing nearer hides it.
    fn miss(&mut self, view: (CameraId, Timestamp), outlook: &[Outlook], found: &Found<'_>) {
        let (camera, at) = view;
        let last = self.last_frames.insert(camera, at);
        let interval = last.map_or(Duration::ZERO, |last| {
            at.saturating_since(last).min(MOST_INTERVAL)
        });
        for (index, object) in self.objects.iter_mut().enumerate() {
            let Some(expected) = outlook.get(index).and_then(|one| one.expected) else {
                continue;
            };
            if expected.in_view && !found.is_hidden(&expected, index) && object.seen_at < at {
                object.missed += interval;
            }
        }
    }

    /// Forgets who is gone.
    fn forget(&mut self, at: Timestamp) {
        let options = &self.options;
        self.objects.retain(|object| {
            let unseen = at.saturating_since(object.seen_at);
            let confirmed = object.hits >= options.confirm_after;
            match confirmed {
                true => object.missed <= options.forget_after && unseen <= options.remember,
                false => object.missed <= options.doubt_after && unseen <= options.forget_after,
            }
        });
        let most = options.most_objects;
        if self.objects.len() > most {
            // Those unseen for the longest go first; the order of the others stays.
            let mut seen: Vec<Timestamp> = self.objects.iter().map(|o| o.seen_at).collect();
            seen.sort_unstable();
            let least = seen[self.objects.len() - most];
            self.objects.retain(|object| object.seen_at >= least);
            self.objects.truncate(most);
        }
    }

    pub(super) fn phase(&self, object: &Object, at: Timestamp) -> Phase {
        match object.hits >= self.options.confirm_after {
            false => Phase::Tentative,
            true if object.seen_at >= at => Phase::Confirmed,
            true => Phase::Coasting,
        }
    }
}

/// What a frame shows of an object's heading: only what it shows itself.
fn look(observed: &Oriented, view: &View<'_>, ego_yaw_rad: f64) -> Option<Look> {
    let kept = observed.heading?;
    kept.age.is_zero().then_some(Look {
        heading_rad: kept.heading.yaw_rad + ego_yaw_rad,
        std_dev_rad: kept.heading.std_dev_rad,
        flip_probability: kept.heading.flip_probability,
        doubt: view.doubt(&observed.located),
    })
}

impl Reidentifier for Tracker {
    /// By overlap in the image with where each tracked object is expected: also one that only another camera ever saw.
    fn recall(&self, seen: &PerFrame<Detection>, ego: &Ego) -> Vec<Known> {
        let (camera, at) = (seen.frame.camera, seen.frame.captured_at);
        let known_then: &[Object] = if self.begins_anew(at) {
            &[]
        } else {
            &self.objects
        };
        let view = View::new(camera, at, self.rig.camera(camera), ego);
        let outlook = outlook(known_then, &view);
        let taken = by_image(known_then, &outlook, &seen.items);
        let ground = self.ground.at(at);
        let known = |taken: Option<usize>| {
            let object = taken.map(|index| &self.objects[index]);
            // Nobody yet stands for an object that is not known: no evidence is its own.
            let id = object.map_or(TrackId(0), |object| object.id);
            Known {
                object: object.map(|object| self.prior(object, (camera, at), ego)),
                slopes: ground.without((camera, id)),
            }
        };
        taken.into_iter().map(known).collect()
    }

    /// Items come back in the order they were given in.
    fn commit(&mut self, seen: PerFrame<Oriented>, _: &[Detection], ego: &Ego) -> PerFrame<Track> {
        let (camera, at) = (seen.frame.camera, seen.frame.captured_at);
        self.begin(at);
        let rig = Arc::clone(&self.rig);
        let view = View::new(camera, at, rig.camera(camera), ego);
        let outlook = outlook(&self.objects, &view);
        let fix = |one: &Oriented| fix(&one.located, &view, ego).unzip();
        let (fixes, heights_m): (Vec<_>, Vec<_>) = seen.items.iter().map(fix).unzip();
        let candidates = Candidates {
            objects: &self.objects,
            outlook: &outlook,
            view: &view,
        };
        let taken = candidates.assign(&seen.items, &fixes);
        let depth = |one: &Oriented| one.located.location.depth_m;
        let found = Found {
            boxes: seen
                .items
                .iter()
                .zip(&taken)
                .map(|(one, taken)| {
                    let box_px = &one.located.detection.box_px;
                    (box_px, taken.map(|index| (index, depth(one))))
                })
                .collect(),
        };
        self.miss((camera, at), &outlook, &found);
        let sights = seen.items.iter().zip(fixes.into_iter().zip(heights_m));
        let ids = self.take_in(&view, ego, sights, &taken);
        self.ground.forget(at);
        for (one, &id) in seen.items.iter().zip(&ids) {
            if let Some(reading) = &one.located.location.ground {
                self.ground.learn((camera, id), reading, at);
            }
        }
        let tracks = seen.items.into_iter().zip(&ids);
        let items = tracks
            .map(|(observed, &id)| self.track(id, observed, at, ego))
            .collect();
        self.forget(self.newest.unwrap_or(at));
        PerFrame {
            items,
            frame: seen.frame,
        }
    }

    /// Every object once, those included that coast.
    fn scene(&mut self, round: &Round, ego: &Ego) -> Vec<SceneObject> {
        self.duplicates.merge(&mut self.objects, round.stamp);
        let mut seen_by: BTreeMap<TrackId, Vec<CameraId>> = BTreeMap::new();
        for perceived in &round.perceived {
            for track in &perceived.tracks.items {
                seen_by
                    .entry(track.id)
                    .or_default()
                    .push(perceived.tracks.frame.camera);
            }
        }
        for object in &mut self.objects {
            object.leave_trail(round.stamp);
        }
        let objects = self.objects.iter().filter_map(|object| {
            let seen = seen_by.get(&object.id);
            let coasts = object.hits >= self.options.confirm_after
                && round.stamp.saturating_since(object.seen_at) <= self.options.coast;
            (seen.is_some() || coasts).then(|| self.scene_object(object, seen, round.stamp, ego))
        });
        objects.collect()
    }
}

impl Tracker {
    /// Corrects those that were seen, and begins those that are new. Gives the identity of each.
    fn take_in<'o>(
        &mut self,
        view: &View<'_>,
        ego: &Ego,
        seen: impl Iterator<Item = (&'o Oriented, (Option<Fix>, Option<f64>))>,
        taken: &[Option<usize>],
    ) -> Vec<TrackId> {
        let yaw_rad = ego.steady_from_base.yaw_rad();
        let over_ground = ego.knowledge != EgoKnowledge::None;
        let mut ids = Vec::with_capacity(taken.len());
        for ((observed, (fix, height_m)), &taken) in seen.zip(taken) {
            let known_m = taken.map(|index| self.objects[index].height_m());
            let sight = Sight {
                view,
                observed,
                evidence: Evidence {
                    fix,
                    look: look(observed, view, yaw_rad),
                    over_ground,
                },
                height_m: height_m.or(known_m).unwrap_or_default(),
            };
            let id = match taken {
                Some(index) => {
                    let in_time = self.objects[index].see(&sight);
                    self.late += u64::from(!in_time);
                    self.objects[index].id
                }
                None => self.meet(&sight),
            };
            ids.push(id);
        }
        ids
    }

    /// A new object. One whose place nobody knows gets a number all the same, and is met anew when it is seen again.
    fn meet(&mut self, sight: &Sight<'_>) -> TrackId {
        let id = TrackId(self.next);
        self.next += 1;
        self.objects.extend(Object::new(id, sight));
        id
    }
}
