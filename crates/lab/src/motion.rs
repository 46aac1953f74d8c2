//! How well speeds are known: velocities of tracked objects against those that their labels move at.

use crate::{score::quantile, truth::Truth};
use nalgebra::{Rotation2, Vector2};
use roadwatch_camera::RigDataset;
use roadwatch_core::{EgoMotion, Phase, Timestamp, Track};
use serde::Serialize;
use std::collections::BTreeMap;

/// Faster than this, an object moves, metres per second: labels of standing ones jitter by less.
const MOVING_M_S: f64 = 1.0;

/// Errors of velocities; shares and quantiles `None` where there is nothing to count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct VelocityScore {
    /// Sights of objects whose velocity was published and is known.
    pub n: usize,
    /// Half of the errors are below this, metres per second.
    pub p50_m_s: Option<f64>,
    /// Nine of ten are.
    pub p90_m_s: Option<f64>,
    /// Mean squared error in deviations, over two dimensions: 1 for who knows how good it is.
    pub nees: Option<f64>,
}

/// Velocities of what moves and of what stands, of confirmed objects.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct MotionReport {
    /// Objects faster than 1 m/s over ground.
    pub moving: VelocityScore,
    /// The others.
    pub standing: VelocityScore,
}

/// What moves how, by the labels.
pub(crate) struct TrueMotion {
    /// By object and frame: where and when, in odom.
    places: BTreeMap<(String, u64), (Timestamp, Vector2<f64>)>,
    ego: EgoMotion,
}

/// One velocity against its truth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VelocityError {
    moving: bool,
    error_m_s: f64,
    squared: f64,
}

impl TrueMotion {
    /// Of a dataset; of one that does not say where the vehicle was, against the vehicle.
    pub(crate) fn of(dataset: &RigDataset, truth: &Truth) -> Self {
        let ego = dataset.ego_motion();
        let mut places = BTreeMap::new();
        for frame in dataset.frames() {
            for (camera, stamp) in dataset.cameras().iter().zip(&frame.stamps) {
                let Some(at) = *stamp else {
                    continue;
                };
                let odom_from_base = ego.at(at).odom_from_base;
                for object in truth.objects(frame.number, camera.name.as_str()) {
                    let place = (odom_from_base * object.center).coords.coords.xy();
                    places.insert((object.id.clone(), frame.number), (at, place));
                }
            }
        }
        Self { places, ego }
    }

    /// Where an object of a frame is at a moment near it, in odom; `None` of one that is not labelled then.
    pub(crate) fn place(&self, id: &str, frame: u64, at: Timestamp) -> Option<Vector2<f64>> {
        let (labelled_at, place) = self.places.get(&(id.to_owned(), frame))?;
        let seconds = (at.as_nanos() - labelled_at.as_nanos()) as f64 / 1e9;
        let velocity = self.velocity(id, frame).unwrap_or_default();
        Some(place + velocity * seconds)
    }

    /// The velocity of an object in a frame, in odom: between the frames before and after.
    fn velocity(&self, id: &str, frame: u64) -> Option<Vector2<f64>> {
        let place = |frame: u64| self.places.get(&(id.to_owned(), frame));
        let (before, after) = (place(frame.checked_sub(1)?)?, place(frame + 1)?);
        let seconds = after.0.saturating_since(before.0).as_secs_f64();
        (seconds > 0.0).then(|| (after.1 - before.1) / seconds)
    }

    /// How far a track's velocity is off; `None` where it has none, or the labels do not say.
    pub(crate) fn judge(
        &self,
        (id, frame): (&str, u64),
        track: &Track,
        at: Timestamp,
    ) -> Option<VelocityError> {
        if self.ego.counts().taken == 0 {
            // Over ground is what it is measured against.
            return None;
        }
        let motion = track.motion.as_ref()?;
        if motion.phase == Phase::Tentative {
            // Two sights say nothing of a velocity, as its covariance says.
            return None;
        }
        let velocity = self.velocity(id, frame)?;
        let turn = Rotation2::new(-self.ego.at(at).odom_from_base.yaw_rad());
        let error = motion.velocity_m_s - turn * velocity;
        let inverse = motion.velocity_covariance.try_inverse()?;
        Some(VelocityError {
            moving: velocity.norm() > MOVING_M_S,
            error_m_s: error.norm(),
            squared: error.dot(&(inverse * error)),
        })
    }
}

impl MotionReport {
    pub(crate) fn of(errors: &[VelocityError]) -> Self {
        let score =
            |moving: bool| VelocityScore::of(errors.iter().filter(|one| one.moving == moving));
        Self {
            moving: score(true),
            standing: score(false),
        }
    }
}

impl VelocityScore {
    fn of<'a>(errors: impl Iterator<Item = &'a VelocityError>) -> Self {
        let (sizes, squares): (Vec<f64>, Vec<f64>) =
            errors.map(|one| (one.error_m_s, one.squared)).unzip();
        let n = sizes.len();
        Self {
            n,
            p50_m_s: quantile(sizes.iter().copied(), 0.5),
            p90_m_s: quantile(sizes.iter().copied(), 0.9),
            nees: (n > 0).then(|| squares.iter().sum::<f64>() / (2.0 * n as f64)),
        }
    }
}
