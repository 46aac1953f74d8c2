//! What a reader of the fused scene gets: every object once, those included that no camera finds at the moment.

use super::{
    Moment, Sighting,
    sighting::{MIN_TIMES_FOUND, alike, times_found},
};
use crate::motion::TrueMotion;
use nalgebra::Vector2;
use roadwatch_core::{
    Scene, Timestamp,
    space::{Odom, Point},
};
use std::collections::{BTreeMap, BTreeSet};

/// A scene as it was published.
#[derive(Debug, Clone)]
pub struct PublishedScene {
    /// Its stamp.
    pub stamp: Timestamp,
    /// Where the vehicle was then.
    pub base: Point<Odom>,
    /// Identities and centres.
    pub objects: Vec<(u64, Point<Odom>)>,
}

impl From<&Scene> for PublishedScene {
    fn from(scene: &Scene) -> Self {
        let odom_from_base = scene.ego.odom_from_base;
        let tracks = scene.objects.iter().map(|object| &object.track);
        Self {
            stamp: scene.stamp,
            base: odom_from_base * Point::new(0.0, 0.0, 0.0),
            objects: tracks
                .map(|track| (track.id.0, odom_from_base * track.position()))
                .collect(),
        }
    }
}

/// What scenes are judged by.
pub(crate) struct Judge<'a> {
    /// Where labelled objects are, at any moment.
    pub(crate) motion: &'a TrueMotion,
    /// What was found in images, and of which scored objects.
    pub(crate) sightings: &'a [Sighting],
    /// By frame: labelled objects whose kind is scored, well visible or not.
    pub(crate) labelled: BTreeMap<u64, BTreeSet<&'a str>>,
    /// The frame that a moment belongs to.
    pub(crate) frames: BTreeMap<Timestamp, u64>,
}

impl Judge<'_> {
    /// The scenes as moments. As with images, objects that were found too seldom count neither for nor against, and of
    /// what was published only identities that were found to be a scored object once: other false alarms are counted
    /// where detection is. What stands where a labelled object is that is not scored, a hidden one, counts neither.
    pub(crate) fn moments(&self, scenes: &[PublishedScene]) -> Vec<Moment> {
        let often = self.found_often();
        let mut numbers: BTreeMap<&str, u64> = BTreeMap::new();
        for name in &often {
            let next = numbers.len() as u64;
            numbers.insert(name, next);
        }
        let identities = self.identities(&often);
        let scored = self.scored(&often);
        let judged = scenes.iter().filter_map(|scene| {
            let frame = *self.frames.get(&scene.stamp)?;
            let names = scored.get(&frame).cloned().unwrap_or_default();
            let place = |name: &str| self.motion.place(name, frame, scene.stamp);
            let truths = names.iter();
            let truths: Vec<(&str, Vector2<f64>)> = truths
                .filter_map(|name| Some((*name, place(name)?)))
                .collect();
            let others = self.labelled.get(&frame).into_iter().flatten();
            let others = others.filter(|name| !names.contains(*name));
            let others: Vec<Vector2<f64>> = others.filter_map(|name| place(name)).collect();
            Some(scene.moment(&truths, &others, &identities, &numbers))
        });
        judged.collect()
    }

    /// Scored objects that were found often enough.
    fn found_often(&self) -> BTreeSet<&str> {
        let times = times_found(self.sightings).into_iter();
        times
            .filter_map(|(name, times)| (times >= MIN_TIMES_FOUND).then_some(name))
            .collect()
    }

    /// Identities under which those were found.
    fn identities(&self, often: &BTreeSet<&str>) -> BTreeSet<u64> {
        let pairs = self.sightings.iter().flat_map(|sighting| {
            let pairs = sighting.pairs.iter();
            pairs.map(|&(truth, found)| (&sighting.truths[truth], &sighting.found[found]))
        });
        pairs
            .filter(|(truth, _)| often.contains(truth.id.as_str()))
            .map(|(_, found)| found.id)
            .collect()
    }

    /// Those that are scored, by frame.
    fn scored<'s>(&'s self, often: &BTreeSet<&'s str>) -> BTreeMap<u64, BTreeSet<&'s str>> {
        let mut scored: BTreeMap<u64, BTreeSet<&str>> = BTreeMap::new();
        for sighting in self.sightings {
            let names = sighting.truths.iter().map(|truth| truth.id.as_str());
            let names = names.filter(|name| often.contains(name));
            scored.entry(sighting.number).or_default().extend(names);
        }
        scored
    }
}

impl PublishedScene {
    fn moment(
        &self,
        truths: &[(&str, Vector2<f64>)],
        others: &[Vector2<f64>],
        identities: &BTreeSet<u64>,
        numbers: &BTreeMap<&str, u64>,
    ) -> Moment {
        let base = self.base.coords.coords.xy();
        let likeness = |truth: &Vector2<f64>, found: &Vector2<f64>| {
            alike((truth - found).norm(), (truth - base).norm())
        };
        let is_at = |truth: &Vector2<f64>, found: &Vector2<f64>| {
            likeness(truth, found) >= super::MIN_SIMILARITY
        };
        let found = self.objects.iter();
        let found = found.filter(|(id, _)| identities.contains(id));
        let found = found.map(|(id, center)| (*id, center.coords.coords.xy()));
        let counts = |(_, found): &(u64, Vector2<f64>)| {
            truths.iter().any(|(_, truth)| is_at(truth, found))
                || !others.iter().any(|other| is_at(other, found))
        };
        let found: Vec<(u64, Vector2<f64>)> = found.filter(counts).collect();
        let similarity = truths.iter().map(|(_, truth)| {
            let row = found.iter().map(|(_, found)| likeness(truth, found));
            row.collect()
        });
        Moment {
            similarity: similarity.collect(),
            truths: truths.iter().map(|(name, _)| numbers[name]).collect(),
            found: found.iter().map(|(id, _)| *id).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::IdentityScore;

    /// One scene of a vehicle at the origin, with the objects that are there by the labels: scored ones and others.
    fn moment(found: &[(u64, f64)], truths: &[(&str, f64)], others: &[f64]) -> Moment {
        let scene = PublishedScene {
            stamp: Timestamp::from_nanos(0),
            base: Point::new(0.0, 0.0, 0.0),
            objects: found
                .iter()
                .map(|&(id, x)| (id, Point::new(x, 0.0, 0.8)))
                .collect(),
        };
        let place = |x: f64| Vector2::new(x, 0.0);
        let truths: Vec<_> = truths.iter().map(|&(name, x)| (name, place(x))).collect();
        let others: Vec<_> = others.iter().map(|&x| place(x)).collect();
        let numbers = BTreeMap::from([("car", 0), ("van", 1)]);
        scene.moment(&truths, &others, &BTreeSet::from([3, 4]), &numbers)
    }

    fn mota(moment: Moment) -> Option<f64> {
        IdentityScore::of(&[moment]).mota
    }

    #[test]
    fn an_object_that_stands_where_it_is_said_to_be_is_found() {
        assert_eq!(mota(moment(&[(3, 11.0)], &[("car", 10.0)], &[])), Some(1.0));
    }

    #[test]
    fn one_that_coasts_where_nothing_is_counts_against_it() {
        let ghost = moment(&[(3, 10.0), (4, 30.0)], &[("car", 10.0)], &[]);
        assert_eq!(mota(ghost), Some(0.0));
    }

    #[test]
    fn one_that_stands_where_a_hidden_object_is_counts_neither_way() {
        let hidden = moment(&[(3, 10.0), (4, 30.0)], &[("car", 10.0)], &[29.0]);
        assert_eq!(mota(hidden), Some(1.0));
    }

    #[test]
    fn identities_that_never_were_a_scored_object_are_detections_affair() {
        let stranger = moment(&[(3, 10.0), (9, 30.0)], &[("car", 10.0)], &[]);
        assert_eq!(mota(stranger), Some(1.0));
    }
}
