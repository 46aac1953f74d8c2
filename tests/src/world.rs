//! The world: a scenario as its cameras see it, with what goes wrong.

use crate::{
    imperfections::Imperfections,
    scenario::{CAR_SIZE, Scenario},
    view::{Eye, Seen, View},
};
use nalgebra::{Isometry3, Vector3};
use roadwatch_core::{CameraId, EgoMotion, Locator, Method, ObjectClass, RigCamera};
use roadwatch_locate::{
    CameraLocator, GridSpec, HullSpec, LocationTable, LocatorOptions, SizeGroup, build_table,
};
use std::{sync::Arc, time::Duration};

/// The ground that tables of the world cover: as far as its scenarios go.
pub const GRID: GridSpec = GridSpec {
    step_m: 1.0,
    nearest_m: 1.0,
    farthest_m: 60.0,
    lateral_m: 30.0,
    headings: 8,
    visible_share: 0.9,
};

/// Lower boxes no detector finds, pixels.
const LEAST_HEIGHT_PX: f32 = 8.0;
/// What is hidden more than this no detector finds.
const MOST_HIDDEN: f64 = 0.7;
/// Nor what is more outside the image than this: it is a sliver at the edge.
const MOST_TRUNCATED: f64 = 0.8;

/// Everything that every camera sees.
#[derive(Clone, Debug)]
pub struct World {
    scenario: Scenario,
    imperfections: Imperfections,
    /// By camera and frame.
    views: Vec<Vec<View>>,
}

impl World {
    /// Looks at a scenario.
    #[must_use]
    pub fn new(scenario: Scenario, imperfections: Imperfections) -> Arc<Self> {
        let views = scenario.rig.cameras().iter().enumerate();
        let views = views
            .map(|(at, believed)| {
                let real = imperfections.mount.apply(believed);
                let eye = Eye::new(&real, scenario.rig.ground_z_m);
                let frames = 0..scenario.frames;
                frames.map(|frame| eye.look(&scenario, at, frame)).collect()
            })
            .collect();
        Arc::new(Self {
            scenario,
            imperfections,
            views,
        })
    }

    /// What happens.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// What goes wrong.
    #[must_use]
    pub fn imperfections(&self) -> &Imperfections {
        &self.imperfections
    }

    /// Where the vehicle is, told every twentieth of a second from before the first capture to after the last.
    ///
    /// # Panics
    /// Never: the poses are finite and in order.
    #[must_use]
    pub fn ego_motion(&self) -> EgoMotion {
        const EVERY: Duration = Duration::from_millis(50);
        let motion = EgoMotion::default();
        let end = self.scenario.period * (self.scenario.frames as u32 + 2);
        let mut moment = Duration::ZERO;
        while moment < end {
            let flat = self.scenario.ego.at(moment);
            let place = flat.translation.vector;
            let pose = Isometry3::new(
                Vector3::new(place.x, place.y, 0.0),
                Vector3::z() * flat.rotation.angle(),
            );
            let told = motion.tell(self.scenario.stamp(moment), pose);
            told.expect("a pose");
            moment += EVERY;
        }
        motion
    }

    /// A camera's frames, in order.
    #[must_use]
    pub fn views(&self, camera: CameraId) -> &[View] {
        &self.views[camera.index()]
    }

    /// Every frame with its camera.
    pub fn all_views(&self) -> impl Iterator<Item = (CameraId, &View)> {
        let cameras = self.scenario.rig.ids().zip(&self.views);
        cameras.flat_map(|(camera, views)| views.iter().map(move |view| (camera, view)))
    }

    /// A locator for each camera as it is believed to sit; with [`Method::Table`], from tables made of the
    /// calibration.
    ///
    /// # Panics
    /// When a camera cannot use the method.
    #[must_use]
    pub fn locators(&self, method: Method) -> Vec<Box<dyn Locator>> {
        if method == Method::Table {
            return self.table_locators(&self.tables());
        }
        let cameras = self.scenario.rig.cameras().iter();
        cameras
            .map(|camera| self.locator(camera, method, None))
            .collect()
    }

    /// A locator for each camera from its table, which tests that play more than once make once.
    ///
    /// # Panics
    /// When a table is another camera's.
    #[must_use]
    pub fn table_locators(&self, tables: &[LocationTable]) -> Vec<Box<dyn Locator>> {
        let cameras = self.scenario.rig.cameras().iter().zip(tables);
        cameras
            .map(|(camera, table)| self.locator(camera, Method::Table, Some(table.clone())))
            .collect()
    }

    /// Every camera's table, see [`World::table`].
    #[must_use]
    pub fn tables(&self) -> Vec<LocationTable> {
        let cameras = self.scenario.rig.cameras().iter();
        cameras.map(|camera| self.table(camera)).collect()
    }

    /// A locator for one camera with the table it is given.
    ///
    /// # Panics
    /// When the camera cannot use the method.
    #[must_use]
    pub fn locator(
        &self,
        camera: &RigCamera,
        method: Method,
        table: Option<LocationTable>,
    ) -> Box<dyn Locator> {
        let options = LocatorOptions {
            table: table.map(Arc::new),
            ..LocatorOptions::new(method)
        };
        let locator = CameraLocator::new(camera, self.scenario.rig.ground_z_m, options);
        Box::new(locator.expect("a camera with everything its method needs"))
    }

    /// A camera's table of cars, from its calibration.
    ///
    /// # Panics
    /// When nothing of the ground is in view.
    #[must_use]
    pub fn table(&self, camera: &RigCamera) -> LocationTable {
        let car = ObjectClass::new("car");
        let hull = HullSpec::for_class(&car);
        let group = SizeGroup {
            classes: vec![car],
            size: CAR_SIZE,
        };
        let ground_z_m = self.scenario.rig.ground_z_m;
        build_table(camera, ground_z_m, &GRID, (group, &hull), |_| ()).expect("ground in view")
    }
}

/// Whether a detector without dropouts finds an object: it is not tiny, nor well hidden, nor a sliver.
#[must_use]
pub fn is_noticeable(seen: &Seen) -> bool {
    seen.silhouette_px.height_px() >= LEAST_HEIGHT_PX
        && seen.truth.occluded <= MOST_HIDDEN
        && seen.truth.truncated <= MOST_TRUNCATED
}
