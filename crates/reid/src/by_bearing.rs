//! The paper's order from left to right, taken around the whole rig: a baseline.

use crate::{by_camera::ByCamera, rule::Rule};
use roadwatch_core::{
    CameraId, Detection, Ego, Known, Oriented, PerFrame, Reidentifier, Track, TrackId,
};
use std::{collections::BTreeMap, time::Duration};

/// What two cameras see in directions nearer than this is taken for one object, radians: a car's width at 50 m.
const ONE_DIRECTION_RAD: f64 = 0.04;

/// Numbers the rig's objects by their bearing from base_link, from behind over the left to behind on the right: the n-th
/// keeps the n-th identity (the paper's section E, for more than one camera). Each camera's objects count as its last
/// frame showed them.
///
/// All else is remembered camera by camera, as [`ByCamera`] does.
#[derive(Debug)]
pub struct ByBearing {
    by_camera: ByCamera,
    bearings: BTreeMap<CameraId, Vec<f64>>,
}

impl ByBearing {
    /// Remembers nobody yet. `ground_memory` as of [`ByCamera::new`].
    #[must_use]
    pub fn new(ground_memory: Duration) -> Self {
        Self {
            by_camera: ByCamera::new(Rule::LeftToRight, ground_memory),
            bearings: BTreeMap::new(),
        }
    }

    /// The directions that are taken around the rig, each once, from the left.
    fn row(&self) -> Vec<f64> {
        let mut all: Vec<(f64, CameraId)> = Vec::new();
        for (&camera, bearings) in &self.bearings {
            all.extend(bearings.iter().map(|&bearing| (bearing, camera)));
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Of what two cameras see in one direction the first counts.
        all.dedup_by(|next, before| next.1 != before.1 && before.0 - next.0 < ONE_DIRECTION_RAD);
        all.into_iter().map(|(bearing, _)| bearing).collect()
    }
}

impl Reidentifier for ByBearing {
    fn recall(&self, seen: &PerFrame<Detection>, ego: &Ego) -> Vec<Known> {
        self.by_camera.recall(seen, ego)
    }

    fn commit(
        &mut self,
        seen: PerFrame<Oriented>,
        unlocated: &[Detection],
        ego: &Ego,
    ) -> PerFrame<Track> {
        let mut tracks = self.by_camera.commit(seen, unlocated, ego);
        let camera = tracks.frame.camera;
        let bearing = |track: &Track| {
            let place = track.observed.located.location.position;
            place.y().atan2(place.x())
        };
        let bearings: Vec<f64> = tracks.items.iter().map(bearing).collect();
        self.bearings.insert(camera, bearings.clone());
        let row = self.row();
        for (track, bearing) in tracks.items.iter_mut().zip(bearings) {
            let nearest = (0..row.len()).min_by(|&a, &b| {
                (row[a] - bearing)
                    .abs()
                    .total_cmp(&(row[b] - bearing).abs())
            });
            track.id = TrackId(nearest.unwrap_or_default() as u64);
        }
        tracks
    }
}
