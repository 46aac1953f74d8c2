//! How high an object should appear whose bottom edge is where it is.

use crate::drive::SeenBox;
use nalgebra::Vector2;
use roadwatch_core::{
    BoxPx, CameraModel, RigCamera,
    space::{CameraGround, Optical, Transform},
};
use roadwatch_locate::{BoxNoise, GroundPose, HullSpec, SilhouetteCamera};
use std::f64::consts::PI;

/// Headings over half a turn: hulls are alike at both ends.
const HEADINGS: u32 = 6;
/// Corrections of the range until the silhouette's bottom edge is where the box's is.
const CORRECTIONS: usize = 2;
/// Spread of lengths and widths among cars, as a share: what a box's width says about the heading.
const PLAN_SPREAD: f64 = 0.1;

/// A camera over its ground plane.
pub(crate) struct SizeModel {
    model: CameraModel,
    silhouettes: SilhouetteCamera,
    ground_from_optical: Transform<CameraGround, Optical>,
    height_m: f64,
}

/// What a box's bottom edge says about its height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Predicted {
    /// Logarithm of the height in pixels, averaged over the headings that the box's shape allows.
    pub(crate) log_height: f64,
    /// How much it differs among those headings.
    pub(crate) heading_std: f64,
    /// The bottom edge below the horizon, pixels.
    pub(crate) below_horizon_px: f64,
}

impl SizeModel {
    /// `None` for a camera that looks straight down, or that is not above the ground.
    pub(crate) fn new(camera: &RigCamera, ground_z_m: f64) -> Option<Self> {
        let base_from_ground = camera.base_from_ground(ground_z_m).ok()?;
        let ground_from_optical = base_from_ground.inverse() * camera.base_from_optical;
        let height_m = camera.base_from_optical.origin().z() - ground_z_m;
        (height_m > 0.0).then(|| Self {
            model: camera.model,
            silhouettes: SilhouetteCamera::new(camera.model, ground_from_optical.inverse()),
            ground_from_optical,
            height_m,
        })
    }

    /// `None` for a box whose bottom edge is not below the horizon, or outside the lens model.
    pub(crate) fn predict(&self, seen: &SeenBox, noise: &BoxNoise) -> Option<Predicted> {
        let contact = self.contact(&seen.box_px)?;
        let hull = HullSpec::for_class(&seen.class);
        let points = hull.points(seen.size.size);
        let extent_m = hull.mean_contact_extent_m(seen.size.size);
        let box_width = f64::from(seen.box_px.width_px());
        let width_std = PLAN_SPREAD.hypot(noise.extent_std_px(&seen.box_px) / box_width);
        let mut sums = [0.0; 3];
        for step in 0..HEADINGS {
            let heading_rad = PI * f64::from(step) / f64::from(HEADINGS);
            let mut range_m = contact.norm() + extent_m;
            let mut outline = None;
            for _ in 0..=CORRECTIONS {
                let place = contact.normalize() * range_m;
                let pose = GroundPose {
                    loc_x_m: -place.y,
                    loc_y_m: place.x,
                    heading_rad,
                };
                let seen_so = self.silhouettes.silhouette_px(&points, pose)?;
                range_m += contact.norm() - self.contact(&seen_so)?.norm();
                outline = Some(seen_so);
            }
            let outline = outline?;
            let off = (box_width / f64::from(outline.width_px())).ln() / width_std;
            let weight = (-off * off / 2.0).exp().max(f64::MIN_POSITIVE);
            let log_height = f64::from(outline.height_px()).ln();
            sums[0] += weight;
            sums[1] += weight * log_height;
            sums[2] += weight * log_height * log_height;
        }
        let mean = sums[1] / sums[0];
        Some(Predicted {
            log_height: mean,
            heading_std: (sums[2] / sums[0] - mean * mean).max(0.0).sqrt(),
            below_horizon_px: self.model.intrinsics.fy * self.height_m / contact.norm(),
        })
    }

    /// Where the ray through the middle of a box's bottom edge meets the ground, ahead and to the left of the
    /// camera's foot, metres.
    fn contact(&self, box_px: &BoxPx) -> Option<Vector2<f64>> {
        let ray = self.model.ray(box_px.bottom_center())?;
        let ray = self.ground_from_optical.rotate(ray);
        (ray.z < 0.0).then(|| ray.xy() * (self.height_m / -ray.z))
    }
}
