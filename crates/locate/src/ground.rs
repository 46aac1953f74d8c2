//! Location from the bottom edge of the box on the ground plane.

use crate::{
    box_noise::BoxNoise,
    estimate::{Estimate, aside_of_middle, covariance_of_shifts},
    hull::HullSpec,
    sizes::ClassSize,
};
use nalgebra::{Vector2, Vector3};
use roadwatch_core::{
    BoxPx, RigCamera,
    camera_model::Pixel,
    space::{Covariance, Point},
};

/// How well it is known how the camera stands over the ground right now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountNoise {
    /// Standard deviation of the camera's pitch against the ground, radians.
    pub pitch_rad: f64,
    /// Standard deviation of the ground's height under the object, metres.
    pub ground_m: f64,
    /// The part of `pitch_rad` that is an object's own: what is left when the slopes under the rig are known,
    /// radians. Not more than `pitch_rad`. For [`Method::Fused`](roadwatch_core::Method::Fused).
    pub local_slope_rad: f64,
}

impl Default for MountNoise {
    /// 0.8 degrees: springs let a car pitch by a third of a degree in ordinary driving, and the road's grade
    /// under the object differs from that under the wheels by a percent or so. 5 cm is a road's camber. Half
    /// of the 0.8 degrees is taken to be local: kerbs, crowns, the next street's grade.
    fn default() -> Self {
        Self {
            pitch_rad: 0.8_f64.to_radians(),
            ground_m: 0.05,
            local_slope_rad: 0.4_f64.to_radians(),
        }
    }
}

/// Step of the numeric slopes, standard deviations: so small that a place within the greatest range stays
/// on the plane, whose far end is a fraction of a degree below the horizon.
const SLOPE_STEP_STD_DEVS: f64 = 0.01;

/// The ground plane under one camera, and how far it can be trusted.
#[derive(Clone, Debug)]
pub struct GroundPlane {
    /// Its height in base_link, metres.
    pub z_m: f64,
    /// Beyond this distance from the foot nothing is placed, metres.
    pub max_range_m: f64,
    /// How the camera stands over it.
    pub mount_noise: MountNoise,
}

/// What one evaluation of the method depends on.
#[derive(Clone, Copy)]
struct Inputs {
    contact: Pixel,
    pitch_rad: f64,
    ground_z_m: f64,
    extent_m: f64,
}

impl GroundPlane {
    /// Places a box where the ray through the middle of its bottom edge meets the ground, and beyond by
    /// half the object's length on the ground, averaged over headings (see
    /// [`HullSpec::mean_contact_extent_m`]); the centre is half the object's height above the ground.
    ///
    /// The covariance follows from the noise of the bottom edge and of the column, the camera's pitch, the
    /// ground's height, and the unknown heading, which moves both the outline and the middle of the box.
    /// Each counts by its slope at the place, so that uncertainty grows with the square of the distance and
    /// does not know where the plane is cut off; none counts for more than `max_range_m`, because nothing is
    /// placed beyond. `None` above the horizon, beyond `max_range_m`, or where the lens model has no ray.
    #[must_use]
    pub fn locate(
        &self,
        camera: &RigCamera,
        class: &ClassSize,
        hull: &HullSpec,
        (box_px, noise): (&BoxPx, &BoxNoise),
    ) -> Option<Estimate> {
        let inputs = Inputs {
            contact: box_px.bottom_center(),
            pitch_rad: 0.0,
            ground_z_m: self.z_m,
            extent_m: hull.mean_contact_extent_m(class.size),
        };
        let place = place(camera, &inputs).filter(|place| self.reaches(camera, *place))?;
        let moved = self.moved(inputs, noise, box_px, hull.contact_extent_std_m(class.size));
        let flat: Option<Vec<_>> = moved
            .iter()
            .map(|pair| self.shift(camera, place, pair))
            .collect();
        let upright = Vector3::z()
            * self
                .mount_noise
                .ground_m
                .hypot(class.std_dev.height_m / 2.0);
        let aside = aside_of_middle(camera, place, class);
        let shifts = flat?.into_iter().chain([aside]);
        let shifts = shifts.map(|by| Vector3::new(by.x, by.y, 0.0));
        Some(Estimate {
            position: Point::new(place.x, place.y, self.z_m + class.size.height_m / 2.0),
            covariance: Covariance::new(covariance_of_shifts(shifts.chain([upright]))),
        })
    }

    /// The inputs with each cause a step of the slope down and up.
    fn moved(
        &self,
        at: Inputs,
        noise: &BoxNoise,
        box_px: &BoxPx,
        extent_std_m: f64,
    ) -> [[Inputs; 2]; 5] {
        let row = Vector2::y() * noise.edge_std_px(box_px);
        let column = Vector2::x() * noise.center_std_px(box_px);
        let mount = self.mount_noise;
        let causes: [&dyn Fn(f64) -> Inputs; 5] = [
            &|std_devs| Inputs {
                contact: at.contact + row * std_devs,
                ..at
            },
            &|std_devs| Inputs {
                contact: at.contact + column * std_devs,
                ..at
            },
            &|std_devs| Inputs {
                pitch_rad: mount.pitch_rad * std_devs,
                ..at
            },
            &|std_devs| Inputs {
                ground_z_m: at.ground_z_m + mount.ground_m * std_devs,
                ..at
            },
            &|std_devs| Inputs {
                extent_m: at.extent_m + extent_std_m * std_devs,
                ..at
            },
        ];
        causes.map(|cause| [cause(-SLOPE_STEP_STD_DEVS), cause(SLOPE_STEP_STD_DEVS)])
    }

    /// What one standard deviation of a cause does to the place `at`, metres; from one side where the lens
    /// model or the plane ends on the other, `None` where it ends on both.
    fn shift(
        &self,
        camera: &RigCamera,
        at: Vector2<f64>,
        [down, up]: &[Inputs; 2],
    ) -> Option<Vector2<f64>> {
        let step = match (place(camera, down), place(camera, up)) {
            (Some(down), Some(up)) => (up - down) / 2.0,
            (Some(down), None) => at - down,
            (None, Some(up)) => up - at,
            (None, None) => return None,
        };
        Some((step / SLOPE_STEP_STD_DEVS).cap_magnitude(self.max_range_m))
    }

    fn reaches(&self, camera: &RigCamera, place: Vector2<f64>) -> bool {
        (place - foot(camera)).norm() <= self.max_range_m
    }
}

fn foot(camera: &RigCamera) -> Vector2<f64> {
    camera.base_from_optical.origin().coords.xy().coords
}

/// The object's middle on the ground, in base_link, however far; `None` above the horizon or without a ray.
fn place(camera: &RigCamera, inputs: &Inputs) -> Option<Vector2<f64>> {
    let ray = camera
        .base_from_optical
        .rotate(camera.model.ray(inputs.contact)?);
    let level = ray.xy();
    let direction = level.try_normalize(f64::EPSILON)?;
    let elevation_rad = ray.z.atan2(level.norm()) + inputs.pitch_rad;
    let below_eye_m = inputs.ground_z_m - camera.base_from_optical.origin().z();
    let to_contact_m = below_eye_m / elevation_rad.tan();
    let meets_ground = elevation_rad < 0.0 && to_contact_m > 0.0;
    meets_ground.then(|| foot(camera) + direction * (to_contact_m + inputs.extent_m))
}
