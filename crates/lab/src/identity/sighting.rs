//! From matched images to moments: each camera by itself, and the whole rig.

use super::{IdentityScore, Moment};
use crate::score::share;
use roadwatch_core::{
    BoxPx, CameraId,
    space::{BaseLink, Point},
};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Objects that the detector found less often have no identity to speak of.
pub const MIN_TIMES_FOUND: usize = 5;
/// A found object within this share of the distance of a true one may be it (the paper's *covered*) …
const NEAR_SHARE: f64 = 0.1;
/// … and within this in any case, metres.
const NEAR_M: f64 = 2.0;

/// A labelled object that is scored, in one image.
#[derive(Debug, Clone)]
pub struct SeenTruth {
    /// Its name in the labels.
    pub id: String,
    /// Its box.
    pub box_px: Option<BoxPx>,
    /// Its centre.
    pub center: Point<BaseLink>,
}

/// A published object that stands for a labelled one, in one image.
#[derive(Debug, Clone, Copy)]
pub struct SeenTrack {
    /// Its identity.
    pub id: u64,
    /// Its box.
    pub box_px: BoxPx,
    /// Its centre.
    pub center: Point<BaseLink>,
}

/// One image: what is there, what was found, and which is which.
#[derive(Debug, Clone)]
pub struct Sighting {
    /// The camera.
    pub camera: CameraId,
    /// Number of the frame in the dataset.
    pub number: u64,
    /// What is there.
    pub truths: Vec<SeenTruth>,
    /// What was found.
    pub found: Vec<SeenTrack>,
    /// Places in both lists.
    pub pairs: Vec<(usize, usize)>,
}

/// Identities over the rig, and camera by camera.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct IdentityReport {
    /// All cameras together: one object is one, whoever sees it.
    #[serde(flatten)]
    pub rig: IdentityScore,
    /// The published scenes: each object once, those included that no camera finds at the moment. `None` where no scenes were
    /// published, as of identities that were given afterwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<IdentityScore>,
    /// Share of found objects, one for each round, that were found under more than one identity at once.
    pub duplicate_share: Option<f64>,
    /// Each camera by itself, added up.
    pub per_camera: IdentityScore,
}

impl IdentityReport {
    /// Scores images in any order. Objects that were found less than [`MIN_TIMES_FOUND`] times count neither for nor
    /// against.
    #[must_use]
    pub fn of(sightings: &[Sighting]) -> Self {
        let kept = without_brief(sightings);
        let mut in_order: Vec<&Sighting> = kept.iter().collect();
        in_order.sort_by_key(|sighting| (sighting.camera, sighting.number));
        let mut names = Names::default();
        let per_camera: Vec<Moment> = in_order.iter().map(|one| names.in_camera(one)).collect();
        let mut rounds: BTreeMap<u64, Vec<&Sighting>> = BTreeMap::new();
        for &sighting in &in_order {
            rounds.entry(sighting.number).or_default().push(sighting);
        }
        let rig: Vec<Moment> = rounds.values().map(|round| names.in_rig(round)).collect();
        Self {
            rig: IdentityScore::of(&rig),
            scene: None,
            duplicate_share: duplicates(&rounds),
            per_camera: IdentityScore::of(&per_camera),
        }
    }
}

/// How often each object was found, by its name in the labels.
pub(super) fn times_found(sightings: &[Sighting]) -> BTreeMap<&str, usize> {
    let mut times: BTreeMap<&str, usize> = BTreeMap::new();
    for sighting in sightings {
        for &(truth, _) in &sighting.pairs {
            *times.entry(sighting.truths[truth].id.as_str()).or_default() += 1;
        }
    }
    times
}

/// How alike two places are, 0 to 1, so far apart and at such a distance of the true one.
pub(super) fn alike(off_m: f64, range_m: f64) -> f64 {
    let most = 2.0 * NEAR_M.max(NEAR_SHARE * range_m);
    (1.0 - off_m / most).max(0.0)
}

/// The images without objects that were found too seldom, and without what was found of those.
fn without_brief(sightings: &[Sighting]) -> Vec<Sighting> {
    let times = times_found(sightings);
    let stays = |truth: &SeenTruth| {
        times
            .get(truth.id.as_str())
            .is_some_and(|&n| n >= MIN_TIMES_FOUND)
    };
    let kept = |sighting: &Sighting| {
        let taken: BTreeMap<usize, usize> = sighting.pairs.iter().map(|&(t, f)| (f, t)).collect();
        let truths: Vec<usize> = (0..sighting.truths.len())
            .filter(|&at| stays(&sighting.truths[at]))
            .collect();
        let found: Vec<usize> = (0..sighting.found.len())
            .filter(|at| {
                taken
                    .get(at)
                    .is_none_or(|&truth| stays(&sighting.truths[truth]))
            })
            .collect();
        let place = |list: &[usize], at: usize| list.iter().position(|&one| one == at);
        let pairs = sighting.pairs.iter();
        Sighting {
            pairs: pairs
                .filter_map(|&(t, f)| Some((place(&truths, t)?, place(&found, f)?)))
                .collect(),
            truths: truths
                .iter()
                .map(|&at| sighting.truths[at].clone())
                .collect(),
            found: found.iter().map(|&at| sighting.found[at]).collect(),
            ..*sighting
        }
    };
    sightings.iter().map(kept).collect()
}

/// Numbers for names: of objects, and of identities within a camera.
#[derive(Default)]
struct Names {
    truths: BTreeMap<(Option<CameraId>, String), u64>,
    found: BTreeMap<(CameraId, u64), u64>,
}

impl Names {
    fn truth(&mut self, camera: Option<CameraId>, id: &str) -> u64 {
        let next = self.truths.len() as u64;
        *self.truths.entry((camera, id.to_owned())).or_insert(next)
    }

    /// An image by itself: alike is what overlaps.
    fn in_camera(&mut self, sighting: &Sighting) -> Moment {
        let camera = sighting.camera;
        let overlap = |truth: &SeenTruth, found: &SeenTrack| {
            let iou = truth.box_px.map_or(0.0, |box_px| box_px.iou(&found.box_px));
            f64::from(iou)
        };
        let truths = sighting.truths.iter();
        let similarity = truths.clone().map(|truth| {
            sighting
                .found
                .iter()
                .map(|found| overlap(truth, found))
                .collect()
        });
        let similarity = similarity.collect();
        let found = sighting.found.iter().map(|found| {
            let next = self.found.len() as u64;
            *self.found.entry((camera, found.id)).or_insert(next)
        });
        let found = found.collect();
        Moment {
            truths: truths
                .map(|truth| self.truth(Some(camera), &truth.id))
                .collect(),
            found,
            similarity,
        }
    }

    /// All images of a round: alike is what is near, and what several cameras see is in the middle of what they say.
    fn in_rig(&mut self, round: &[&Sighting]) -> Moment {
        let mut truths: BTreeMap<u64, Vec<Point<BaseLink>>> = BTreeMap::new();
        let mut found: BTreeMap<u64, Vec<Point<BaseLink>>> = BTreeMap::new();
        for sighting in round {
            for truth in &sighting.truths {
                let id = self.truth(None, &truth.id);
                truths.entry(id).or_default().push(truth.center);
            }
            for track in &sighting.found {
                found.entry(track.id).or_default().push(track.center);
            }
        }
        let similarity = truths.values().map(|truth| {
            let (truth, range_m) = middle(truth);
            let row = found.values().map(|found| {
                let (found, _) = middle(found);
                alike((found[0] - truth[0]).hypot(found[1] - truth[1]), range_m)
            });
            row.collect()
        });
        Moment {
            similarity: similarity.collect(),
            truths: truths.keys().copied().collect(),
            found: found.keys().copied().collect(),
        }
    }
}

/// The middle of some points above the ground, and its distance, metres.
fn middle(points: &[Point<BaseLink>]) -> ([f64; 2], f64) {
    let count = points.len() as f64;
    let x = points.iter().map(|point| point.x()).sum::<f64>() / count;
    let y = points.iter().map(|point| point.y()).sum::<f64>() / count;
    ([x, y], x.hypot(y))
}

fn duplicates(rounds: &BTreeMap<u64, Vec<&Sighting>>) -> Option<f64> {
    let (mut found, mut twice) = (0, 0);
    for round in rounds.values() {
        let mut identities: BTreeMap<&str, BTreeSet<u64>> = BTreeMap::new();
        for sighting in round {
            for &(truth, track) in &sighting.pairs {
                let known = identities.entry(sighting.truths[truth].id.as_str());
                known.or_default().insert(sighting.found[track].id);
            }
        }
        found += identities.len();
        twice += identities.values().filter(|ids| ids.len() > 1).count();
    }
    share(twice, found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_px(x: f32) -> BoxPx {
        BoxPx::new(x, 10.0, x + 20.0, 30.0).expect("an area")
    }

    /// One camera's image with one car 20 m ahead, found under `id` if it is.
    fn image(camera: u8, number: u64, id: Option<u64>) -> Sighting {
        let truth = SeenTruth {
            id: "car".to_owned(),
            box_px: Some(box_px(100.0)),
            center: Point::new(20.0, 0.0, 0.8),
        };
        let found: Vec<SeenTrack> = id
            .map(|id| SeenTrack {
                id,
                box_px: box_px(102.0),
                center: Point::new(20.5, 0.5, 0.8),
            })
            .into_iter()
            .collect();
        Sighting {
            camera: CameraId(camera),
            number,
            truths: vec![truth],
            pairs: (0..found.len()).map(|at| (0, at)).collect(),
            found,
        }
    }

    #[test]
    fn one_identity_over_two_cameras_is_right_for_the_rig_and_for_each() {
        let sightings: Vec<_> = (0..6)
            .flat_map(|n| [image(0, n, Some(3)), image(1, n, Some(3))])
            .collect();
        let report = IdentityReport::of(&sightings);
        assert_eq!(
            (report.rig.idf1, report.per_camera.idf1),
            (Some(1.0), Some(1.0))
        );
        assert_eq!(report.duplicate_share, Some(0.0));
        assert_eq!(
            (report.rig.object_frames, report.per_camera.object_frames),
            (6, 12)
        );
    }

    #[test]
    fn two_identities_for_one_object_are_duplicates_of_the_rig_alone() {
        let sightings: Vec<_> = (0..6)
            .flat_map(|n| [image(0, n, Some(3)), image(1, n, Some(4))])
            .collect();
        let report = IdentityReport::of(&sightings);
        assert_eq!(report.per_camera.idf1, Some(1.0));
        assert_eq!(report.duplicate_share, Some(1.0));
        assert!(report.rig.idf1.expect("a share") < 0.7, "{report:?}");
    }

    #[test]
    fn what_is_hardly_ever_found_counts_neither_for_nor_against() {
        let brief: Vec<_> = (0..8).map(|n| image(0, n, (n < 4).then_some(3))).collect();
        let report = IdentityReport::of(&brief);
        assert_eq!(report.rig.object_frames, 0);
        assert_eq!(report, IdentityReport::default());
    }
}
