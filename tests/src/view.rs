//! What one camera has before it at one moment.

use crate::scenario::{Actor, Scenario};
use nalgebra::{Isometry2, Vector3};
use roadwatch_core::{
    BoxPx, RigCamera, SizeLwh, Timestamp,
    space::{BaseLink, CameraGround, Point, Transform},
};
use roadwatch_lab::TruthObject;
use roadwatch_locate::{GroundPose, HullSpec, SilhouetteCamera};

/// Points per side of the raster that measures how much of a box is hidden.
const RASTER: u32 = 16;

/// One frame of one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The frame's number, which is also the camera's own count.
    pub frame: u64,
    /// When it was captured.
    pub captured_at: Timestamp,
    /// What is in the image, the nearest first.
    pub objects: Vec<Seen>,
}

/// An actor in an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Its place in [`Scenario::actors`].
    pub actor: usize,
    /// Its box when it turns its silhouette to the camera, as a perfect detector would draw it, pixels.
    pub silhouette_px: BoxPx,
    /// Its label.
    pub truth: TruthObject,
}

/// A camera as it really sits over the ground.
pub(crate) struct Eye {
    camera: SilhouetteCamera,
    ground_from_base: Transform<CameraGround, BaseLink>,
    foot: Point<BaseLink>,
}

impl Eye {
    /// # Panics
    /// When the camera looks straight up or down.
    pub(crate) fn new(camera: &RigCamera, ground_z_m: f64) -> Self {
        let base_from_ground = camera
            .base_from_ground(ground_z_m)
            .expect("cameras of the world look at a horizon");
        let optical_from_ground = camera.base_from_optical.inverse() * base_from_ground;
        Self {
            camera: SilhouetteCamera::new(camera.model, optical_from_ground),
            ground_from_base: base_from_ground.inverse(),
            foot: base_from_ground.origin(),
        }
    }

    /// The frame that a scenario's camera of this number captures.
    pub(crate) fn look(&self, scenario: &Scenario, camera: usize, frame: u64) -> View {
        let moment = scenario.moment(camera, frame);
        let world_from_base = scenario.ego.at(moment);
        let seen = scenario
            .actors
            .iter()
            .enumerate()
            .filter_map(|(at, actor)| {
                let base_from_actor = world_from_base.inv_mul(&actor.path.at(moment));
                self.see(at, actor, base_from_actor, scenario.rig.ground_z_m)
            });
        let mut objects: Vec<Seen> = seen.collect();
        let from_foot = |seen: &Seen| (seen.truth.center.coords - self.foot.coords).norm();
        objects.sort_by(|a, b| from_foot(a).total_cmp(&from_foot(b)));
        for at in 1..objects.len() {
            let (nearer, rest) = objects.split_at_mut(at);
            rest[0].truth.occluded = hidden_share(&rest[0].silhouette_px, nearer);
        }
        View {
            frame,
            captured_at: scenario.stamp(moment),
            objects,
        }
    }

    /// `None` when nothing of the actor is in the image, or a part of it behind the lens.
    fn see(
        &self,
        at: usize,
        actor: &Actor,
        base_from_actor: Isometry2<f64>,
        ground_z_m: f64,
    ) -> Option<Seen> {
        let place = base_from_actor.translation.vector;
        let pose = self.ground_pose(base_from_actor, ground_z_m);
        let hull = HullSpec::for_class(&actor.class).points(actor.size);
        let (silhouette_px, _) = self.cast(&hull, pose)?;
        let (box_px, inside) = self.cast(&cuboid(actor.size), pose)?;
        let center_z_m = ground_z_m + actor.size.height_m / 2.0;
        Some(Seen {
            actor: at,
            silhouette_px,
            truth: TruthObject {
                id: format!("actor {at}"),
                class: actor.class.to_string(),
                label: None,
                box_px: Some(box_px),
                silhouette_px: Some(silhouette_px),
                visible_px: None,
                truncated: f64::from(1.0 - inside).max(0.0),
                occluded: 0.0,
                center: Point::new(place.x, place.y, center_z_m),
                size: Some(actor.size),
                yaw_rad: Some(base_from_actor.rotation.angle()),
            },
        })
    }

    fn cast(&self, points: &[Vector3<f64>], pose: GroundPose) -> Option<(BoxPx, f32)> {
        self.camera.clip(self.camera.silhouette_px(points, pose)?)
    }

    fn ground_pose(&self, base_from_actor: Isometry2<f64>, ground_z_m: f64) -> GroundPose {
        let place = base_from_actor.translation.vector;
        let (sin, cos) = base_from_actor.rotation.angle().sin_cos();
        let place = self.ground_from_base * Point::new(place.x, place.y, ground_z_m);
        let heading = self.ground_from_base.rotate(Vector3::new(cos, sin, 0.0));
        GroundPose {
            loc_x_m: -place.y(),
            loc_y_m: place.x(),
            heading_rad: heading.y.atan2(heading.x),
        }
    }
}

/// The corners of a cuboid about the middle of its footprint, as labels have them.
fn cuboid(size: SizeLwh) -> Vec<Vector3<f64>> {
    let corner = |at: u8| {
        let half = |bit: u8| if at & bit == 0 { -0.5 } else { 0.5 };
        let up = if at & 4 == 0 { 0.0 } else { size.height_m };
        Vector3::new(half(1) * size.length_m, half(2) * size.width_m, up)
    };
    (0..8).map(corner).collect()
}

/// How much of a box lies behind the boxes of others, 0 to 1.
fn hidden_share(box_px: &BoxPx, nearer: &[Seen]) -> f64 {
    let place = |at: u32| (at as f32 + 0.5) / RASTER as f32;
    let covered = |across: u32, down: u32| {
        let x = box_px.x_min + place(across) * box_px.width_px();
        let y = box_px.y_min + place(down) * box_px.height_px();
        nearer.iter().any(|other| {
            let by = other.silhouette_px;
            (by.x_min..by.x_max).contains(&x) && (by.y_min..by.y_max).contains(&y)
        })
    };
    let raster = (0..RASTER).flat_map(|down| (0..RASTER).map(move |across| (across, down)));
    let hidden = raster.filter(|&(across, down)| covered(across, down));
    hidden.count() as f64 / f64::from(RASTER * RASTER)
}
