//! Identities of each camera by itself, without motion: the paper's order from left to right, and overlap.

use crate::{ground_memory::GroundMemory, rule::Rule};
use nalgebra::Matrix2;
use roadwatch_core::{
    BoxPx, CameraId, Detection, Ego, Frame, Heading, KeptHeading, Known, Location, ObjectClass,
    Oriented, PerFrame, Prior, Reidentifier, Timestamp, Track, TrackId,
};
use std::{collections::BTreeMap, time::Duration};

/// How fast an object may move against the vehicle, metres per second: a difference of two speeds in city traffic.
const SPEED_STD_M_S: f64 = 5.0;
/// Share of an estimate's variance that is new in the next frame: box noise, not the object's unknown size.
const SHARE_THAT_CHANGES: f64 = 0.25;
/// Estimates of one object jump by this much whatever their covariances say, metres.
const LEAST_APART_M: f64 = 0.3;
/// Beyond this many standard deviations it is another object.
const MOST_APART_STD_DEVS: f64 = 3.0;
/// How fast an object may turn against the vehicle while nobody looks, radians per second: both may take a corner,
/// at some twenty degrees per second.
const TURN_STD_RAD_S: f64 = 0.5;

/// Gives each camera's objects their places in a row by a [`Rule`], and remembers what stood there.
///
/// An identity is a number of the camera's plus the place (camera 2's fourth from the left is 20003): the same in every
/// run, and never the same for two cameras. Places are counted among all detections, also those that got no location.
#[derive(Debug)]
pub struct ByCamera {
    rule: Rule,
    rows: BTreeMap<CameraId, Row>,
    ground: GroundMemory,
}

/// What is remembered of one camera.
#[derive(Debug, Default)]
struct Row {
    places: BTreeMap<usize, Remembered>,
    /// The first place that nobody ever had.
    next: usize,
}

/// One place of a row.
#[derive(Clone, Debug)]
struct Remembered {
    seen_at: Timestamp,
    class: ObjectClass,
    box_px: BoxPx,
    /// Measured, never held.
    location: Option<Measured>,
    /// As it was found, and when.
    heading: Option<(Heading, Timestamp)>,
}

#[derive(Clone, Debug)]
struct Measured {
    location: Location,
    at: Timestamp,
}

impl ByCamera {
    /// The place of each object, in the order given.
    fn places(
        &self,
        camera: CameraId,
        objects: &[(&BoxPx, &ObjectClass)],
        at: Timestamp,
    ) -> Vec<usize> {
        let Some(row) = self.rows.get(&camera) else {
            return self.rule.places(objects, &[], 0);
        };
        // A recording that begins anew takes time back: what is still to come is no memory.
        let is_known = |one: &Remembered| {
            one.seen_at <= at && at.saturating_since(one.seen_at) <= self.rule.lasts()
        };
        let known = row.places.iter().filter(|(_, one)| is_known(one));
        let known: Vec<_> = known
            .map(|(&place, one)| (place, &one.box_px, &one.class))
            .collect();
        self.rule.places(objects, &known, row.next)
    }

    /// What stands for an object of one camera everywhere.
    fn identity(&self, camera: CameraId, place: usize) -> TrackId {
        TrackId(u64::from(camera.0) * self.rule.most_places() + place as u64)
    }

    /// About how long the slopes of the ground are remembered by default: a grade lasts a few car lengths, and
    /// so do two seconds of city traffic.
    pub const DEFAULT_GROUND_MEMORY: Duration = Duration::from_secs(2);

    /// Remembers nobody yet. What objects say of the ground is remembered for about `ground_memory`, not at all
    /// when that is zero.
    #[must_use]
    pub fn new(rule: Rule, ground_memory: Duration) -> Self {
        Self {
            rule,
            rows: BTreeMap::new(),
            ground: GroundMemory::new(ground_memory),
        }
    }

    fn remembered(
        &self,
        camera: CameraId,
        place: usize,
        class: &ObjectClass,
    ) -> Option<&Remembered> {
        let one = self.rows.get(&camera)?.places.get(&place)?;
        (one.class == *class).then_some(one)
    }

    /// Takes a kept heading away from an object that stands somewhere else than the one it was kept for: when the
    /// row moves on, a place has another object.
    fn drop_foreign_heading(
        &self,
        seen: &mut Oriented,
        (camera, place): (CameraId, usize),
        at: Timestamp,
    ) {
        let is_kept = seen.heading.is_some_and(|kept| !kept.age.is_zero());
        let before = self.remembered(camera, place, &seen.located.detection.class);
        let measured = before.and_then(|before| before.location.as_ref());
        let foreign = measured.is_none_or(|measured| {
            let age = at.saturating_since(measured.at);
            !is_near(&seen.located.location, &measured.location, age)
        });
        if is_kept && foreign {
            seen.heading = None;
        }
    }

    /// What is known after a frame about the object at a place: a held location is the one measured
    /// earlier, and keeps the stamp it was measured at.
    fn remember(
        &self,
        seen: &Oriented,
        camera: CameraId,
        place: usize,
        at: Timestamp,
    ) -> Remembered {
        let class = &seen.located.detection.class;
        let before = self.remembered(camera, place, class);
        let location = &seen.located.location;
        let measured = if location.held {
            before.and_then(|before| before.location.clone())
        } else {
            Some(Measured {
                location: location.clone(),
                at,
            })
        };
        Remembered {
            seen_at: at,
            class: class.clone(),
            box_px: seen.located.detection.box_px,
            location: measured,
            heading: match seen.heading {
                Some(KeptHeading { heading, age }) if age.is_zero() => Some((heading, at)),
                // Kept for the object that is there, or taken away.
                Some(_) => before.and_then(|before| before.heading),
                None => None,
            },
        }
    }
}

impl Reidentifier for ByCamera {
    /// Each detection gets what the object at its place left behind; `None` when there was none, when it was of another
    /// class, or when it never had a location.
    fn recall(&self, seen: &PerFrame<Detection>, _: &Ego) -> Vec<Known> {
        let Frame {
            camera,
            captured_at,
            ..
        } = seen.frame;
        let objects: Vec<_> = seen
            .items
            .iter()
            .map(|one| (&one.box_px, &one.class))
            .collect();
        let order = self.places(camera, &objects, captured_at);
        let ground = self.ground.at(captured_at);
        let prior = |detection: &Detection, place: usize| {
            let before = self.remembered(camera, place, &detection.class)?;
            let measured = before
                .location
                .as_ref()
                .filter(|known| known.at <= captured_at)?;
            // From frame to frame an object's boxes overlap; where they do not, the row has moved on.
            let is_there = before.box_px.iou(&detection.box_px) > 0.0;
            let heading = before.heading.filter(|_| is_there);
            Some(Prior {
                location: measured.location.clone(),
                heading: heading
                    .map(|(heading, at)| kept(heading, captured_at.saturating_since(at))),
                age: captured_at.saturating_since(measured.at),
            })
        };
        let known = |(detection, place): (&Detection, usize)| Known {
            object: prior(detection, place),
            slopes: ground.without((camera, self.identity(camera, place))),
        };
        seen.items.iter().zip(order).map(known).collect()
    }

    /// Items come back in the order they were given in.
    fn commit(
        &mut self,
        mut seen: PerFrame<Oriented>,
        unlocated: &[Detection],
        _: &Ego,
    ) -> PerFrame<Track> {
        let (camera, at) = (seen.frame.camera, seen.frame.captured_at);
        let located = seen.items.iter().map(|one| &one.located.detection);
        let objects: Vec<_> = located
            .chain(unlocated)
            .map(|one| (&one.box_px, &one.class))
            .collect();
        // Of the places of all, those of the located come first.
        let order = self.places(camera, &objects, at);
        for (one, &place) in seen.items.iter_mut().zip(&order) {
            self.drop_foreign_heading(one, (camera, place), seen.frame.captured_at);
        }
        let remember = |(one, &place): (&Oriented, &usize)| {
            (
                place,
                self.remember(one, camera, place, seen.frame.captured_at),
            )
        };
        let remembered: Vec<_> = seen.items.iter().zip(&order).map(remember).collect();
        let row = self.rows.entry(camera).or_default();
        let lasts = self.rule.lasts();
        row.places
            .retain(|_, one| one.seen_at < at && at.saturating_since(one.seen_at) <= lasts);
        row.places.extend(remembered);
        row.next = row
            .next
            .max(order.iter().max().map_or(0, |place| place + 1));
        self.ground.forget(at);
        for (one, &place) in seen.items.iter().zip(&order) {
            if let Some(reading) = &one.located.location.ground {
                let who = (camera, self.identity(camera, place));
                self.ground.learn(who, reading, at);
            }
        }
        let track = |(observed, place)| Track {
            id: self.identity(camera, place),
            observed,
            motion: None,
        };
        PerFrame {
            items: seen.items.into_iter().zip(order).map(track).collect(),
            frame: seen.frame,
        }
    }
}

/// A heading after some time, in which the object may have turned, or another one has its place.
pub(crate) fn kept(heading: Heading, age: Duration) -> KeptHeading {
    let turned_rad = TURN_STD_RAD_S * age.as_secs_f64();
    KeptHeading {
        heading: Heading {
            std_dev_rad: heading.std_dev_rad.hypot(turned_rad),
            ..heading
        },
        age,
    }
}

/// Whether two locations, one some time after the other, may be one object's: no further apart than their own
/// deviations and its motion against the vehicle explain.
fn is_near(here: &Location, before: &Location, age: Duration) -> bool {
    let apart = (here.position.coords - before.position.coords).xy();
    let moved_m = SPEED_STD_M_S * age.as_secs_f64();
    let flat = |location: &Location| {
        let flat = location.covariance.matrix.fixed_view::<2, 2>(0, 0);
        flat.into_owned()
    };
    // Most of an estimate's error is its own in every frame: the same object's estimates differ by less.
    let spread = (flat(here) + flat(before)) * SHARE_THAT_CHANGES
        + Matrix2::identity() * (moved_m * moved_m + LEAST_APART_M * LEAST_APART_M);
    let inverse = spread.try_inverse().unwrap_or_else(Matrix2::zeros);
    apart.dot(&(inverse * apart)) < MOST_APART_STD_DEVS * MOST_APART_STD_DEVS
}
