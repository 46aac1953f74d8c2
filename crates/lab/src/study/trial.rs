//! One way of locating, tried on everything that was seen.

use super::scene::{GROUND_Z_M, Shape, StudyScene};
use super::seen::SeenVehicle;
use crate::{
    sample::{Estimator, Sample},
    score::Figures,
};
use roadwatch_core::{Known, Locator as _, Method, ObjectClass, RigCamera, rig::MeasuredFocal};
use roadwatch_locate::{
    CameraLocator, CarCategory, ClassSizes, GridSpec, HullSpec, LocationTable, LocatorError,
    LocatorOptions, SizeGroup, SizeStatistic, build_table, table::TableBuildError,
};
use std::sync::Arc;

/// The class that tables are built for, as the daemon does.
const TABLE_CLASS: &str = "car";
/// Where the paper measures F, metres.
pub(super) const MEASURED_AT_M: f64 = 50.0;
/// The Y path must come so near to that place, metres.
const MEASURED_WITHIN_M: f64 = 2.0;

/// A method that a camera cannot offer.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The locator.
    #[error(transparent)]
    Locator(#[from] LocatorError),
    /// The table.
    #[error(transparent)]
    Table(#[from] TableBuildError),
}

/// F by eq. 1, and what it was measured on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredOn {
    /// F.
    pub focal: MeasuredFocal,
    /// `P`: height of the box, pixels.
    pub height_px: f64,
    /// `D`: true `depth_m`, metres.
    pub depth_m: f64,
    /// `W`: the vehicle's real height, metres.
    pub size_m: f64,
}

/// What is seen, and what every trial needs.
pub(super) struct Bench<'a> {
    pub(super) scenes: &'a [StudyScene],
    pub(super) measured: Option<MeasuredOn>,
}

/// A vehicle in a scene.
pub(super) type SeenIn<'a> = (&'a StudyScene, &'a SeenVehicle);

impl<'a> Bench<'a> {
    pub(super) fn new(scenes: &'a [StudyScene]) -> Self {
        Self {
            scenes,
            measured: measured(scenes),
        }
    }

    /// Everything seen in scenes of a shape.
    pub(super) fn seen(&self, shape: Shape) -> Vec<SeenIn<'a>> {
        let scenes = self.scenes.iter().filter(|scene| scene.shape == shape);
        scenes
            .flat_map(|scene| scene.seen.iter().map(move |seen| (scene, seen)))
            .collect()
    }

    /// Each method on what was seen, with the daemon's defaults. `triangle_measured_f` needs an F.
    pub(super) fn methods(&self, seen: &[SeenIn<'_>]) -> Result<Vec<Sample>, TrialError> {
        let mut samples = Vec::new();
        for method in Method::ALL {
            if method == Method::TriangleMeasuredF && self.measured.is_none() {
                continue;
            }
            let located = per_scene(Estimator::By(method), seen, |scene| {
                self.by_default(&scene.camera, method)
            });
            samples.extend(located?);
        }
        Ok(samples)
    }

    fn by_default(&self, camera: &RigCamera, method: Method) -> Result<CameraLocator, TrialError> {
        let camera = RigCamera {
            measured_focal: self.measured.map(|measured| measured.focal),
            ..camera.clone()
        };
        let options = LocatorOptions::new(method);
        let table = match method {
            Method::Table => Some(default_table(&camera)?),
            _ => None,
        };
        let options = LocatorOptions { table, ..options };
        Ok(CameraLocator::new(&camera, GROUND_Z_M, options)?)
    }
}

/// F as the paper measures it: on the place of the Y path that is nearest to 50 m.
fn measured(scenes: &[StudyScene]) -> Option<MeasuredOn> {
    let along = scenes.iter().filter(|scene| scene.shape == Shape::YPath);
    let seen = along.flat_map(|scene| scene.seen.iter().map(move |seen| (scene, seen)));
    let off_m = |seen: &SeenVehicle| (seen.target.depth_m - MEASURED_AT_M).abs();
    let (scene, nearest) = seen.min_by(|a, b| off_m(a.1).total_cmp(&off_m(b.1)))?;
    let size_m = nearest.target.object.size?.height_m;
    if off_m(nearest) > MEASURED_WITHIN_M {
        return None;
    }
    let height_px = f64::from(nearest.detection.box_px.height_px());
    let depth_m = nearest.target.depth_m;
    let image_height_px = scene.camera.model.size.height_px;
    Some(MeasuredOn {
        focal: MeasuredFocal::from_known_object(height_px, depth_m, size_m, image_height_px),
        height_px,
        depth_m,
        size_m,
    })
}

/// A table of average cars from the camera's calibration, as the daemon builds it at start.
pub(super) fn default_table(camera: &RigCamera) -> Result<Arc<LocationTable>, TrialError> {
    let class = ObjectClass::new(TABLE_CLASS);
    let hull = HullSpec::for_class(&class);
    let group = SizeGroup {
        classes: vec![class],
        size: CarCategory::default().size(SizeStatistic::default()),
    };
    let grid = GridSpec::default();
    let table = build_table(camera, GROUND_Z_M, &grid, (group, &hull), |_| ())?;
    Ok(Arc::new(table))
}

/// Locates everything, with one locator per scene.
pub(super) fn per_scene(
    who: Estimator,
    seen: &[SeenIn<'_>],
    locator: impl Fn(&StudyScene) -> Result<CameraLocator, TrialError>,
) -> Result<Vec<Sample>, TrialError> {
    let mut samples = Vec::with_capacity(seen.len());
    let mut last: Option<(&StudyScene, CameraLocator)> = None;
    for &(scene, vehicle) in seen {
        let current = match last.take() {
            Some((of, locator)) if std::ptr::eq(of, scene) => locator,
            _ => locator(scene)?,
        };
        samples.push(judge(who, vehicle, &current));
        last = Some((scene, current));
    }
    Ok(samples)
}

/// Eq. 2 with a height of its own for each vehicle, and with F where one is given, otherwise `fy`.
pub(super) fn by_height(
    seen: &[SeenIn<'_>],
    focal: Option<MeasuredFocal>,
    height_m: impl Fn(&SeenVehicle) -> Option<f64>,
) -> Result<Vec<Sample>, TrialError> {
    let mut samples = Vec::with_capacity(seen.len());
    for &(scene, vehicle) in seen {
        let Some(height_m) = height_m(vehicle) else {
            continue;
        };
        let method = match focal {
            Some(_) => Method::TriangleMeasuredF,
            None => Method::TriangleFy,
        };
        let camera = RigCamera {
            measured_focal: focal,
            ..scene.camera.clone()
        };
        let options = LocatorOptions {
            sizes: of_height(&vehicle.detection.class, height_m),
            ..LocatorOptions::new(method)
        };
        let locator = CameraLocator::new(&camera, GROUND_Z_M, options)?;
        samples.push(judge(Estimator::By(method), vehicle, &locator));
    }
    Ok(samples)
}

/// The vehicle's real height, metres; `None` where the labels do not say.
pub(super) fn true_height_m(seen: &SeenVehicle) -> Option<f64> {
    seen.target.object.size.map(|size| size.height_m)
}

fn of_height(class: &ObjectClass, height_m: f64) -> ClassSizes {
    let mut sizes = ClassSizes::default();
    if let Some(mut size) = sizes.get(class).copied() {
        size.size.height_m = height_m;
        sizes.set(class.clone(), size);
    }
    sizes
}

fn judge(who: Estimator, seen: &SeenVehicle, locator: &CameraLocator) -> Sample {
    let found = locator.locate(&seen.detection, &Known::default());
    let answer = found.as_ref().map(|location| (location, None));
    Sample::judge(who, &seen.target, answer)
}

/// One method's figures.
pub(super) fn figures_of(samples: &[Sample], method: Method) -> Figures {
    let who = Estimator::By(method);
    Figures::of(samples.iter().filter(|sample| sample.estimator == who))
}
