//! The paper's baseline: the n-th object from the left keeps the n-th identity.

use crate::ground_memory::GroundMemory;
use roadwatch_core::{
    BoxPx, CameraId, Detection, Frame, Heading, KeptHeading, Known, Location, ObjectClass,
    Oriented, PerFrame, Prior, Reidentifier, Timestamp, Track, TrackId,
};
use std::{collections::BTreeMap, time::Duration};

/// Identities of one camera; no frame has more objects. In tens, so that people can read an identity.
const PLACES: u64 = 10_000;
/// How fast an object may turn against the vehicle while nobody looks, radians per second: both may take a corner,
/// at some twenty degrees per second.
const TURN_STD_RAD_S: f64 = 0.5;

/// Sorts each camera's objects from left to right and gives the n-th the n-th identity (section E of the
/// paper, Fig. 8).
///
/// An identity is `camera * 10000 + place`, both counted from 0 (camera 2's fourth from the left is 20003):
/// the same in every run, and never the same for two cameras. It says nothing about who somebody is: when a car enters at the left, everybody
/// moves on by one. Objects side by side keep the order in which they come.
///
/// Remembered are the objects of each camera's last frame, no more. Places are counted among all
/// detections, also those that got no location.
#[derive(Debug)]
pub struct LeftToRight {
    /// By camera and place.
    rows: BTreeMap<CameraId, BTreeMap<usize, Remembered>>,
    ground: GroundMemory,
}

/// One place of a row.
#[derive(Clone, Debug)]
struct Remembered {
    class: ObjectClass,
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

impl LeftToRight {
    /// About how long the slopes of the ground are remembered by default: a grade lasts a few car lengths, and
    /// so do two seconds of city traffic.
    pub const DEFAULT_GROUND_MEMORY: Duration = Duration::from_secs(2);

    /// Remembers nobody yet. What objects say of the ground is remembered for about `ground_memory`, not at all
    /// when that is zero.
    #[must_use]
    pub fn new(ground_memory: Duration) -> Self {
        Self {
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
        let one = self.rows.get(&camera)?.get(&place)?;
        (one.class == *class).then_some(one)
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
            class: class.clone(),
            location: measured,
            heading: match seen.heading {
                Some(KeptHeading { heading, age }) if age.is_zero() => Some((heading, at)),
                _ => before.and_then(|before| before.heading),
            },
        }
    }
}

impl Reidentifier for LeftToRight {
    /// The n-th detection from the left gets what the n-th object of the camera's last frame left behind;
    /// `None` when there was none, when it was of another class, or when it never had a location.
    fn recall(&self, seen: &PerFrame<Detection>) -> Vec<Known> {
        let Frame {
            camera,
            captured_at,
            ..
        } = seen.frame;
        let order = places(seen.items.iter().map(|detection| &detection.box_px));
        let ground = self.ground.at(captured_at);
        let prior = |class: &ObjectClass, place: usize| {
            let before = self.remembered(camera, place, class)?;
            let measured = before.location.as_ref()?;
            Some(Prior {
                location: measured.location.clone(),
                heading: before
                    .heading
                    .map(|(heading, at)| kept(heading, captured_at.saturating_since(at))),
                age: captured_at.saturating_since(measured.at),
            })
        };
        let known = |(detection, place): (&Detection, usize)| Known {
            object: prior(&detection.class, place),
            slopes: ground.without((camera, identity(camera, place))),
        };
        seen.items.iter().zip(order).map(known).collect()
    }

    /// Items come back in the order they were given in.
    fn commit(&mut self, seen: PerFrame<Oriented>, unlocated: &[Detection]) -> PerFrame<Track> {
        let camera = seen.frame.camera;
        let located = seen.items.iter().map(|one| &one.located.detection.box_px);
        let others = unlocated.iter().map(|detection| &detection.box_px);
        // Of the places of all, those of the located come first.
        let order = places(located.chain(others));
        let remember = |(one, &place): (&Oriented, &usize)| {
            (
                place,
                self.remember(one, camera, place, seen.frame.captured_at),
            )
        };
        let row = seen.items.iter().zip(&order).map(remember).collect();
        self.rows.insert(camera, row);
        let at = seen.frame.captured_at;
        self.ground.forget(at);
        for (one, &place) in seen.items.iter().zip(&order) {
            if let Some(reading) = &one.located.location.ground {
                self.ground
                    .learn((camera, identity(camera, place)), reading, at);
            }
        }
        let track = |(observed, place)| Track {
            id: identity(camera, place),
            observed,
        };
        PerFrame {
            items: seen.items.into_iter().zip(order).map(track).collect(),
            frame: seen.frame,
        }
    }
}

/// A heading after some time, in which the object may have turned, or another one has its place.
fn kept(heading: Heading, age: Duration) -> KeptHeading {
    let turned_rad = TURN_STD_RAD_S * age.as_secs_f64();
    KeptHeading {
        heading: Heading {
            std_dev_rad: heading.std_dev_rad.hypot(turned_rad),
            ..heading
        },
        age,
    }
}

/// The identity of a place in a camera's row.
fn identity(camera: CameraId, place: usize) -> TrackId {
    TrackId(u64::from(camera.0) * PLACES + place as u64)
}

/// Each box's place from the left, by its middle; equal middles keep their order.
fn places<'a>(boxes: impl Iterator<Item = &'a BoxPx>) -> Vec<usize> {
    let middles: Vec<f64> = boxes.map(|box_px| box_px.center().x).collect();
    let mut from_left: Vec<usize> = (0..middles.len()).collect();
    from_left.sort_by(|&a, &b| middles[a].total_cmp(&middles[b]));
    let mut places = vec![0; from_left.len()];
    for (place, item) in from_left.into_iter().enumerate() {
        places[item] = place;
    }
    places
}
