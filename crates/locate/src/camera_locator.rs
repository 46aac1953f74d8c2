//! The locator of one camera: the configured method, its fallbacks, and held locations.

use crate::{
    box_noise::BoxNoise,
    estimate::Estimate,
    fused::{FusedEstimate, FusedLocator, HiddenShares},
    ground::{GroundPlane, MountNoise},
    hold::HoldOptions,
    hull::HullSpec,
    sizes::{ClassSize, ClassSizes, Standing},
    table::LocationTable,
    table_locator::{TableLocator, TableMismatch, TableOptions},
    triangle::locate_by_triangle,
};
use roadwatch_core::{
    BoxPx, CameraName, Detection, Heading, HeadingCandidates, Known, Location, Locator, Method,
    RigCamera, SizeLwh, SlopeEvidence,
};
use std::sync::Arc;

/// How one camera locates.
#[derive(Clone, Debug)]
pub struct LocatorOptions {
    /// The method.
    pub method: Method,
    /// Real sizes.
    pub sizes: ClassSizes,
    /// How far box edges stray.
    pub box_noise: BoxNoise,
    /// How far the mount strays, for [`Method::Ground`] and [`Method::Fused`].
    pub mount_noise: MountNoise,
    /// How often objects are hidden in part, for [`Method::Fused`].
    pub hidden: HiddenShares,
    /// Beyond this `range_m` nothing is located, metres.
    pub max_range_m: f64,
    /// The table, for [`Method::Table`].
    pub table: Option<Arc<LocationTable>>,
    /// How the table is asked.
    pub table_options: TableOptions,
    /// For how long an object's last location is kept.
    pub hold: HoldOptions,
}

impl LocatorOptions {
    /// Farther than any object that a box of a few pixels says something about, metres.
    pub const DEFAULT_MAX_RANGE_M: f64 = 150.0;

    /// A method with defaults for everything else, and without a table.
    #[must_use]
    pub fn new(method: Method) -> Self {
        Self {
            method,
            sizes: ClassSizes::default(),
            box_noise: BoxNoise::default(),
            mount_noise: MountNoise::default(),
            hidden: HiddenShares::default(),
            max_range_m: Self::DEFAULT_MAX_RANGE_M,
            table: None,
            table_options: TableOptions::default(),
            hold: HoldOptions::default(),
        }
    }
}

/// A method that a camera cannot offer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LocatorError {
    /// Eq. 1 was never measured for this camera.
    #[error(
        "camera `{0}` has no measured focal value, which method `triangle_measured_f` needs: \
         measure one (F = P * D / W) and set measured_focal_px, or use `triangle_fy`"
    )]
    NoMeasuredFocal(CameraName),
    /// Method `table` without a table.
    #[error(
        "camera `{0}` has no table, which method `table` needs: build one (`roadwatch table build`)"
    )]
    NoTable(CameraName),
    /// The table is not this camera's as it is mounted now, or of objects of another size.
    #[error(transparent)]
    Table(#[from] TableMismatch),
    /// A range that is no positive number of metres.
    #[error("the greatest range must be a positive number of metres, not {0}")]
    MaxRange(f64),
}

/// How the configured method works, with what it needs.
#[derive(Debug)]
enum Strategy {
    MeasuredFocal { focal_px: f64 },
    Fy,
    Table(Box<TableLocator>),
    Ground,
    Fused(Box<FusedLocator>),
}

/// Locates the objects of one camera.
///
/// Two kinds of object are out of reach of some methods and are located by `triangle_fy` instead, which
/// [`Location::method`] then says: classes outside the table's size group, and raised objects (traffic
/// lights, signs), about which neither the ground nor a table of things on the ground says anything.
#[derive(Debug)]
pub struct CameraLocator {
    camera: RigCamera,
    plane: GroundPlane,
    sizes: ClassSizes,
    box_noise: BoxNoise,
    hold: HoldOptions,
    strategy: Strategy,
}

impl CameraLocator {
    /// The locator of a camera over the ground plane at `ground_z_m` of base_link.
    ///
    /// # Errors
    /// When the method needs what the camera does not have.
    pub fn new(
        camera: &RigCamera,
        ground_z_m: f64,
        options: LocatorOptions,
    ) -> Result<Self, LocatorError> {
        if !(options.max_range_m.is_finite() && options.max_range_m > 0.0) {
            return Err(LocatorError::MaxRange(options.max_range_m));
        }
        let plane = GroundPlane {
            z_m: ground_z_m,
            max_range_m: options.max_range_m,
            mount_noise: options.mount_noise,
        };
        let strategy = strategy(camera, &plane, &options)?;
        Ok(Self {
            camera: camera.clone(),
            plane,
            sizes: options.sizes,
            box_noise: options.box_noise,
            hold: options.hold,
            strategy,
        })
    }

    /// The location that this box alone gives; `None` for a class of unknown size, a box that is not a
    /// box, and wherever the method has no answer within the greatest range.
    #[must_use]
    pub fn measure(
        &self,
        detection: &Detection,
        heading: Option<&Heading>,
        slopes: &SlopeEvidence,
    ) -> Option<Location> {
        let BoxPx {
            x_min,
            y_min,
            x_max,
            y_max,
        } = detection.box_px;
        let box_px = BoxPx::new(x_min, y_min, x_max, y_max)?;
        let class = self.sizes.get(&detection.class)?;
        let on_ground = class.standing == Standing::OnGround;
        let noise = self.box_noise.seen_through(detection.input_pixel_px);
        let boxed = (&box_px, &noise);
        if let (Strategy::Fused(fused), true) = (&self.strategy, on_ground) {
            let found = fused.locate(&self.camera, &detection.class, boxed, (heading, slopes))?;
            return self.fused(found);
        }
        let fy = self.camera.model.intrinsics.fy;
        let (method, size, estimate) = match &self.strategy {
            Strategy::MeasuredFocal { focal_px } => (
                Method::TriangleMeasuredF,
                class.size,
                self.triangle(*focal_px, class, boxed),
            ),
            Strategy::Table(table) if on_ground && table.table().covers(&detection.class) => (
                Method::Table,
                table.table().header().group.size,
                table.locate(class, &box_px, &noise),
            ),
            Strategy::Ground if on_ground => {
                let hull = HullSpec::for_class(&detection.class);
                let estimate = self.plane.locate(&self.camera, class, &hull, boxed);
                (Method::Ground, class.size, estimate)
            }
            Strategy::Fy | Strategy::Table(_) | Strategy::Ground | Strategy::Fused(_) => (
                Method::TriangleFy,
                class.size,
                self.triangle(fy, class, boxed),
            ),
        };
        self.location(estimate?, size, method)
    }

    fn fused(&self, found: FusedEstimate) -> Option<Location> {
        let location = self.location(found.estimate, found.size, Method::Fused)?;
        Some(Location {
            headings: found.headings,
            ground: found.ground,
            ..location
        })
    }

    fn triangle(
        &self,
        focal_px: f64,
        class: &ClassSize,
        (box_px, noise): (&BoxPx, &BoxNoise),
    ) -> Option<Estimate> {
        locate_by_triangle(&self.camera, focal_px, class, box_px, noise)
    }

    /// `None` for what lies behind the camera, too far away, or is not a number.
    fn location(&self, estimate: Estimate, size: SizeLwh, method: Method) -> Option<Location> {
        let depth_m = self.camera.depth_m(estimate.position);
        let range_m = self.camera.range_m(estimate.position);
        let finite = estimate
            .covariance
            .matrix
            .iter()
            .all(|number| number.is_finite())
            && estimate.position.z().is_finite();
        let within_reach = depth_m > 0.0 && range_m <= self.plane.max_range_m;
        (finite && within_reach).then_some(Location {
            position: estimate.position,
            covariance: estimate.covariance,
            depth_m,
            range_m,
            size,
            method,
            headings: HeadingCandidates::default(),
            ground: None,
            held: false,
        })
    }
}

impl Locator for CameraLocator {
    fn locate(&self, detection: &Detection, known: &Known) -> Option<Location> {
        let prior = known.object.as_ref();
        // What is too old to be held is too old to be believed.
        let recent = prior.filter(|prior| prior.age < self.hold.max_age);
        let heading = recent.and_then(|prior| prior.heading);
        let heading = heading.as_ref().map(|kept| &kept.heading);
        let measured = self.measure(detection, heading, &known.slopes);
        measured.or_else(|| self.hold.keep(prior?))
    }
}

fn strategy(
    camera: &RigCamera,
    plane: &GroundPlane,
    options: &LocatorOptions,
) -> Result<Strategy, LocatorError> {
    let name = || camera.name.clone();
    match options.method {
        Method::TriangleMeasuredF => {
            let focal = camera
                .measured_focal
                .ok_or_else(|| LocatorError::NoMeasuredFocal(name()))?;
            Ok(Strategy::MeasuredFocal {
                focal_px: focal.for_size(camera.model.size),
            })
        }
        Method::TriangleFy => Ok(Strategy::Fy),
        Method::Ground => Ok(Strategy::Ground),
        Method::Fused => {
            let fused = FusedLocator::new(camera, plane, &options.sizes, options.hidden);
            Ok(Strategy::Fused(Box::new(fused)))
        }
        Method::Table => {
            let table = options
                .table
                .clone()
                .ok_or_else(|| LocatorError::NoTable(name()))?;
            let sized = table.check_sizes(&options.sizes);
            sized.map_err(TableMismatch::from)?;
            let table = TableLocator::new(camera, plane.z_m, table, options.table_options)?;
            Ok(Strategy::Table(Box::new(table)))
        }
    }
}
