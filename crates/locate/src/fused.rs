//! The fused estimate: everything a box tells, weighed by how well it is known.
//!
//! The paper's table asks which place looks like this box. So does this, without a grid: for each of a few
//! headings the class's hull ([`HullSpec`]) is moved over the ground until its outline meets the box's four
//! edges (Gauss-Newton). Length, width and height of the object, its exact heading and the height of the
//! ground under it are unknown by their spreads; they are marginalised, so that an edge counts by what it is
//! worth: the lower one much on near flat ground and little far away, the height by the spread of heights.
//! Each heading is explained four ways, with nothing hidden or with something in front of one end or of the
//! foot; the answer is the mean of all explanations by their evidence, its covariance theirs and their
//! disagreement.

mod cut;
mod edges;
mod fit;
mod level;
mod mixture;
mod normal;
mod solid;

use crate::{
    box_noise::BoxNoise,
    estimate::Estimate,
    ground::GroundPlane,
    hull::HullSpec,
    sizes::{ClassSize, ClassSizes},
};
use arrayvec::ArrayVec;
use edges::SeenBox;
pub use fit::HiddenShares;
use fit::{Explanation, Shape, View};
use level::Ground;
use mixture::{HEADINGS, MOST_EXPLANATIONS, Mixture, wrapped, yaw_of};
use multiversion::multiversion;
use nalgebra::{Matrix3, Vector2};
use roadwatch_core::{
    BoxPx, GroundReading, Heading, HeadingCandidates, ObjectClass, RigCamera, SizeLwh,
    SlopeEvidence,
    space::{Covariance, Point},
};
use solid::Solid;
use std::{collections::BTreeMap, f64::consts::PI};

/// A prior heading is wrong altogether this often: another object, or one that turned.
const PRIOR_FAILS: f64 = 0.1;

/// Places boxes by all four edges. One per camera.
#[derive(Clone, Debug)]
pub struct FusedLocator {
    view: View,
    max_range_m: f64,
    shapes: BTreeMap<ObjectClass, (Shape, SizeLwh)>,
}

/// A place, and the headings that the box allows.
#[derive(Clone, Debug, PartialEq)]
pub struct FusedEstimate {
    /// Centre of the object's box with its covariance.
    pub estimate: Estimate,
    /// At most four, likeliest first.
    pub headings: HeadingCandidates,
    /// What the box says of the ground, if it does.
    pub ground: Option<GroundReading>,
    /// The expected size of the class.
    pub size: SizeLwh,
}

impl FusedLocator {
    /// The locator of a camera over a ground plane, for every class whose size is known.
    #[must_use]
    pub fn new(
        camera: &RigCamera,
        plane: &GroundPlane,
        sizes: &ClassSizes,
        hidden: HiddenShares,
    ) -> Self {
        let isometry = camera.base_from_optical.isometry.inverse();
        let noise = plane.mount_noise;
        let slopes = (noise.pitch_rad.tan(), noise.local_slope_rad.tan());
        let view = View {
            eye: camera.base_from_optical.origin().coords.coords,
            optical_from_base: *isometry.rotation.to_rotation_matrix().matrix(),
            ground: Ground::level(plane.z_m, noise.ground_m, slopes),
            hidden,
        };
        let shapes = sizes.expected().map(|(class, size)| {
            let shape = shape(&HullSpec::for_class(class), size, &view.optical_from_base);
            (class.clone(), (shape, size.size))
        });
        Self {
            shapes: shapes.collect(),
            max_range_m: plane.max_range_m,
            view,
        }
    }

    /// Places a box; `None` for a class of unknown size, and where no heading puts the object in front of
    /// the camera. Given are the heading this object had, with its deviation now, and what others say of the
    /// ground.
    #[must_use]
    pub fn locate(
        &self,
        camera: &RigCamera,
        class: &ObjectClass,
        (box_px, noise): (&BoxPx, &BoxNoise),
        (heading, slopes): (Option<&Heading>, &SlopeEvidence),
    ) -> Option<FusedEstimate> {
        let view = View {
            ground: self.view.ground.learnt(slopes),
            ..self.view
        };
        let (shape, size) = self.shapes.get(class)?;
        let seen = SeenBox::new(&camera.model, box_px, noise)?;
        let start = self.start(camera, box_px, &seen, *size)?;
        let explanations = explanations(&view, shape, &seen, start, heading);
        let mixture = Mixture::new(&explanations)?;
        let (place, flat) = mixture.place();
        let away = place - view.eye.xy();
        let ground_std_m = view.ground.std_m(place, away.norm());
        let upright_m = ground_std_m.hypot(shape.std_dev.height_m / 2.0);
        let mut covariance = Matrix3::zeros();
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&flat);
        covariance[(2, 2)] = upright_m * upright_m;
        Some(FusedEstimate {
            estimate: Estimate {
                position: Point::new(
                    place.x,
                    place.y,
                    view.ground.height_m(place) + size.height_m / 2.0,
                ),
                covariance: Covariance::new(covariance),
            },
            headings: mixture.headings(away.y.atan2(away.x)),
            ground: mixture.best().and_then(|best| view.ground_reading(best)),
            size: *size,
        })
    }

    /// Along the ray through the box's middle, as far as its height and its width say; a cut box looks too
    /// small, so the nearer of the two.
    fn start(
        &self,
        camera: &RigCamera,
        box_px: &BoxPx,
        seen: &SeenBox,
        size: SizeLwh,
    ) -> Option<Vector2<f64>> {
        let ray = camera
            .base_from_optical
            .rotate(camera.model.ray(box_px.center())?);
        let by_height = size.height_m / seen.height();
        let by_width = size.length_m.max(size.width_m) / seen.width();
        let level = ray.xy();
        let least_m = size.length_m / 2.0 + 1.0;
        let said_m = by_height.min(by_width) * level.norm();
        let distance_m = said_m.min(self.max_range_m).max(least_m);
        Some(self.view.eye.xy() + level.try_normalize(f64::EPSILON)? * distance_m)
    }
}

/// Every heading explained every way.
#[multiversion(targets("x86_64+avx2+fma"))]
fn explanations(
    view: &View,
    shape: &Shape,
    seen: &SeenBox,
    start: Vector2<f64>,
    prior: Option<&Heading>,
) -> ArrayVec<Explanation, MOST_EXPLANATIONS> {
    let mut explanations = ArrayVec::new();
    let mut place = None;
    for heading in 0..HEADINGS {
        // Headings next to each other have places next to each other.
        let from = place.or_else(|| view.approach(shape, heading, seen, start));
        let fit = from.and_then(|from| view.fit(shape, heading, seen, (from, start)));
        let Some(fit) = fit else {
            continue;
        };
        place = Some(fit.best);
        for found in fit.explanations(seen) {
            explanations.push(expected(found, prior));
        }
    }
    explanations
}

/// An explanation by how well it agrees with the heading the object had.
fn expected(found: Explanation, prior: Option<&Heading>) -> Explanation {
    let Some(prior) = prior else {
        return found;
    };
    let yaw_rad = yaw_of(found.heading) + found.turn_rad;
    let apart = wrapped(yaw_rad - prior.yaw_rad, PI);
    let std_rad = prior
        .std_dev_rad
        .hypot(found.turn_std_rad)
        .max(f64::EPSILON);
    let likelihood = (-0.5 * (apart / std_rad).powi(2)).exp() * PI / ((2.0 * PI).sqrt() * std_rad);
    Explanation {
        scale: found.scale * ((1.0 - PRIOR_FAILS) * likelihood + PRIOR_FAILS),
        ..found
    }
}

fn shape(spec: &HullSpec, size: &ClassSize, optical_from_base: &Matrix3<f64>) -> Shape {
    let solid = Solid::new(spec, size.size);
    let turn = |heading: usize| {
        let yaw = yaw_of(heading).sin_cos();
        (yaw, solid.turn(yaw, optical_from_base))
    };
    Shape {
        turned: (0..HEADINGS).map(turn).collect(),
        std_dev: size.std_dev,
        // Anywhere in the bin, which is this wide.
        heading_std_rad: PI / HEADINGS as f64 / 12.0_f64.sqrt(),
        solid,
    }
}
