//! The ground under the rig as a fit sees it: a plane of two slopes, each object's own deviation from it, and
//! what a box says of its height.

use nalgebra::{Matrix2, Vector2};
use roadwatch_core::{GroundReading, SlopeEvidence};

/// The mean size of the cars of a region differs from the expected one by this share: labelled ones are from 4 %
/// lower (KITTI) to 9 % higher (nuScenes).
const MEAN_SIZE_SHARE: f64 = 0.05;
/// Share of the variance of local slopes that objects on one side of the rig have in common: a street's crown,
/// the next street's grade. Nobody measured it.
const SIDE_SHARE: f64 = 0.5;
/// A box that tells less than this share of what was known of the ground already has told nothing.
const LEAST_GAIN: f64 = 0.002;
/// Ground this many standard deviations from where it is configured to be is no ground: something hides the foot, or
/// the object is of another size. Of less uneven ground, what is that many deviations off counts for that much less.
const MOST_STD_DEVS: f64 = 3.0;

/// What is known of the ground before a box comes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    /// Its height under base_link's origin, metres of base_link.
    z_m: f64,
    /// Of its height anywhere, metres.
    height_std_m: f64,
    /// Of the slope to an object as it is configured, the plane's and its own, rise per metre.
    configured_std: f64,
    /// Of the slope to an object beside the plane's, rise per metre.
    local_std: f64,
    /// The plane's rise per metre ahead and to the left of base_link.
    pub(super) slopes: Vector2<f64>,
    /// Of the slopes.
    covariance: Matrix2<f64>,
}

impl Ground {
    /// Level ground whose height, whose slopes together and whose slope to single objects deviate by so much,
    /// metres and metres per metre.
    pub(super) fn level(z_m: f64, height_std_m: f64, (slope_std, local_std): (f64, f64)) -> Self {
        let local_std = local_std.min(slope_std);
        let plane_variance = (slope_std * slope_std - local_std * local_std).max(f64::MIN_POSITIVE);
        Self {
            z_m,
            height_std_m,
            configured_std: slope_std,
            local_std,
            slopes: Vector2::zeros(),
            covariance: Matrix2::identity() * plane_variance,
        }
    }

    /// With what others say of the slopes; of level ground.
    pub(super) fn learnt(&self, evidence: &SlopeEvidence) -> Self {
        let expected = self.covariance * evidence.unevenness.powi(2);
        let precision = expected.try_inverse().unwrap_or_default();
        let learnt = (precision + evidence.information).try_inverse();
        let covariance = learnt.unwrap_or(expected);
        Self {
            local_std: self.local_std * evidence.unevenness,
            slopes: covariance * evidence.pull,
            covariance,
            ..*self
        }
    }

    /// At a place of base_link, metres of base_link.
    #[inline(always)]
    pub(super) fn height_m(&self, place: Vector2<f64>) -> f64 {
        self.z_m + self.slopes.dot(&place)
    }

    /// Of the height there, at `distance_m` from the camera, metres.
    #[inline(always)]
    pub(super) fn std_m(&self, place: Vector2<f64>, distance_m: f64) -> f64 {
        let own = self.own_variance(distance_m);
        (own + place.dot(&(self.covariance * place))).sqrt()
    }

    /// Of the height beside the plane's.
    #[inline(always)]
    fn own_variance(&self, distance_m: f64) -> f64 {
        let local_m = self.local_std * distance_m;
        self.height_std_m * self.height_std_m + local_m * local_m
    }

    /// What a box says of the plane at a place, by what it left of the ground's height there: mean and variance,
    /// in the standard deviations that were expected. `None` when that is nothing, or not to be believed.
    pub(super) fn reading(
        &self,
        (place, distance_m): (Vector2<f64>, f64),
        eye_height_m: f64,
        (mean, variance): (f64, f64),
    ) -> Option<GroundReading> {
        let gain = variance.recip() - 1.0;
        if !(gain >= LEAST_GAIN && gain.is_finite()) {
            return None;
        }
        let expected_std_m = self.std_m(place, distance_m);
        let by_box_m = expected_std_m / gain.sqrt();
        // By itself: the expected height divided out again.
        let off_m = expected_std_m * (mean / variance / gain);
        let configured_m = self.configured_std * distance_m;
        let height_m = self.slopes.dot(&place) + off_m;
        let std_devs = |height_m: f64, ground_m: f64| height_m.abs() / ground_m.hypot(by_box_m);
        if std_devs(height_m, configured_m.hypot(self.height_std_m)) > MOST_STD_DEVS {
            return None;
        }
        let local_m2 = self.own_variance(distance_m);
        let std_dev_m = by_box_m.hypot(((1.0 - SIDE_SHARE) * local_m2).sqrt());
        Some(GroundReading {
            place,
            height_m,
            std_dev_m: std_dev_m * (std_devs(off_m, expected_std_m) / MOST_STD_DEVS).max(1.0),
            // All objects higher by a share seem nearer by it, where the same ray is higher above the ground.
            by_mean_size_m: MEAN_SIZE_SHARE * eye_height_m,
            by_side_m: (SIDE_SHARE * local_m2).sqrt(),
            by_box_m: by_box_m.hypot(self.height_std_m),
            configured_m,
        })
    }
}
