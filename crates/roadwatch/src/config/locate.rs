//! `[locate]`: from boxes to places.

use super::{cameras::CameraConfig, reader::Reader};
use roadwatch_core::{Locator, Method, ObjectClass, Rig, RigCamera, SizeLwh};
use roadwatch_locate::{
    BoxNoise, CameraLocator, CarCategory, ClassSize, ClassSizes, GridSpec, HiddenShares,
    HoldOptions, HullSpec, LocationTable, LocatorError, LocatorOptions, MountNoise, QueryDistance,
    SizeGroup, SizeStatistic, SplitMode, Standing, TableOptions, Weight, build_table,
};
use roadwatch_reid::ByCamera;
use std::{sync::Arc, time::Duration};

/// The class that look-up tables are built for: the one whose size is known best.
pub const TABLE_CLASS: &str = "car";
/// Larger than any road user, metres.
const LARGEST_SIZE_M: f64 = 100.0;
/// Smaller than anything worth detecting, metres.
const SMALLEST_SIZE_M: f64 = 0.01;
/// Spread of a size when the configuration gives none, as a share: that of cars' heights.
const DEFAULT_SPREAD: f64 = 0.13;

/// How objects are located.
#[derive(Debug, Clone)]
pub struct LocateConfig {
    /// The method of cameras that name none.
    pub method: Method,
    /// Everything but the method and the table.
    pub options: LocatorOptions,
    /// The ground that tables built at start cover.
    pub grid: GridSpec,
    /// About how long the ground's slopes are remembered; zero learns nothing of them.
    pub ground_memory: Duration,
}

impl LocateConfig {
    /// A camera's locator by one method. A camera without a table file gets a table from its calibration.
    ///
    /// # Errors
    /// The camera's key that is to blame, and what is wrong.
    pub fn locator(
        &self,
        rig: &Rig,
        camera: &RigCamera,
        config: &CameraConfig,
        method: Method,
    ) -> Result<Box<dyn Locator>, (&'static str, String)> {
        let table = match (method, &config.table) {
            (Method::Table, Some(file)) => {
                let table =
                    LocationTable::read(file).map_err(|error| ("table", error.to_string()))?;
                Some(table)
            }
            (Method::Table, None) => {
                let group = self
                    .table_group()
                    .ok_or(("table", "cars have no size".to_owned()))?;
                let hull = HullSpec::for_class(&ObjectClass::new(TABLE_CLASS));
                let built = build_table(camera, rig.ground_z_m, &self.grid, (group, &hull), |_| ());
                Some(built.map_err(|error| ("table", error.to_string()))?)
            }
            _ => None,
        };
        let options = LocatorOptions {
            method,
            table: table.map(Arc::new),
            ..self.options.clone()
        };
        let locator = CameraLocator::new(camera, rig.ground_z_m, options);
        let locator = locator.map_err(|error| (locator_key(&error), error.to_string()))?;
        Ok(Box::new(locator))
    }

    /// The objects a table is built for; `None` when cars have no size.
    #[must_use]
    pub fn table_group(&self) -> Option<SizeGroup> {
        let class = ObjectClass::new(TABLE_CLASS);
        let size = self.options.sizes.get(&class)?.size;
        Some(SizeGroup {
            classes: vec![class],
            size,
        })
    }
}

fn locator_key(error: &LocatorError) -> &'static str {
    match error {
        LocatorError::NoMeasuredFocal(_) => "measured_focal_px",
        LocatorError::NoTable(_) | LocatorError::Table(_) => "table",
        LocatorError::MaxRange(_) => "max_range_m",
    }
}

pub(super) fn read_method(table: &Reader<'_, '_>) -> Option<Method> {
    table.choice(
        "method",
        &Method::ALL.map(|method| (method.as_str(), method)),
    )
}

pub(super) fn read(locate: &Reader<'_, '_>) -> LocateConfig {
    let mut options = LocatorOptions::new(Method::Fused);
    options.sizes = sizes(locate);
    options.max_range_m = locate
        .number("max_range_m", 1.0..=10_000.0)
        .unwrap_or(LocatorOptions::DEFAULT_MAX_RANGE_M);
    options.hold =
        locate
            .number("hold_secs", 0.0..=60.0)
            .map_or_else(HoldOptions::default, |secs| HoldOptions {
                max_age: Duration::from_secs_f64(secs),
            });
    let noise = locate.table("box_noise");
    options.box_noise = box_noise(&noise);
    noise.finish();
    let ground = locate.table("ground");
    options.mount_noise = mount_noise(&ground);
    let ground_memory = ground.number("memory_secs", 0.0..=600.0);
    ground.finish();
    let hidden = locate.table("hidden");
    options.hidden = hidden_shares(&hidden);
    hidden.finish();
    let table = locate.table("table");
    options.table_options = table_options(&table);
    let grid = grid(&table);
    table.finish();
    LocateConfig {
        method: read_method(locate).unwrap_or(Method::Fused),
        options,
        grid,
        ground_memory: ground_memory
            .map_or(ByCamera::DEFAULT_GROUND_MEMORY, Duration::from_secs_f64),
    }
}

fn sizes(locate: &Reader<'_, '_>) -> ClassSizes {
    let statistics = [
        ("maximum", SizeStatistic::Maximum),
        ("average", SizeStatistic::Average),
    ];
    let statistic = locate
        .choice("size_statistic", &statistics)
        .unwrap_or_default();
    let category = locate
        .choice("car_category", &CarCategory::ALL)
        .unwrap_or_default();
    let mut sizes = ClassSizes::new(category, statistic);
    let tables = locate.table("sizes");
    for class in tables.keys() {
        let table = tables.table(class);
        let class = ObjectClass::new(class);
        if let Some(size) = class_size(&table, sizes.get(&class).copied()) {
            sizes.set(class, size);
        }
        table.finish();
    }
    tables.finish();
    sizes
}

/// A class's size: what the table says over what was known; a class nobody knew must be said whole.
fn class_size(table: &Reader<'_, '_>, known: Option<ClassSize>) -> Option<ClassSize> {
    let metres = |key: &str, known: Option<f64>| {
        let said = table.number(key, SMALLEST_SIZE_M..=LARGEST_SIZE_M);
        if said.or(known).is_none() && !table.has(key) {
            table.note(key, "missing: this class has no built-in size");
        }
        said.or(known)
    };
    let size = known.map(|known| known.size);
    let length_m = metres("length_m", size.map(|size| size.length_m));
    let width_m = metres("width_m", size.map(|size| size.width_m));
    let height_m = metres("height_m", size.map(|size| size.height_m));
    let spread_m = table.number("height_std_dev_m", 0.0..=LARGEST_SIZE_M);
    let on_ground = table.flag("on_ground");
    let size = SizeLwh {
        length_m: length_m?,
        width_m: width_m?,
        height_m: height_m?,
    };
    let mut std_dev = known.map_or_else(|| spread_of(size), |known| known.std_dev);
    std_dev.height_m = spread_m.unwrap_or(std_dev.height_m);
    let standing = match on_ground {
        Some(true) => Standing::OnGround,
        Some(false) => Standing::Raised,
        None => known.map_or(Standing::OnGround, |known| known.standing),
    };
    Some(ClassSize {
        size,
        std_dev,
        standing,
    })
}

fn spread_of(size: SizeLwh) -> SizeLwh {
    SizeLwh {
        length_m: size.length_m * DEFAULT_SPREAD,
        width_m: size.width_m * DEFAULT_SPREAD,
        height_m: size.height_m * DEFAULT_SPREAD,
    }
}

fn box_noise(table: &Reader<'_, '_>) -> BoxNoise {
    let defaults = BoxNoise::default();
    BoxNoise {
        edge_px: table
            .number("edge_px", 0.0..=1000.0)
            .unwrap_or(defaults.edge_px),
        edge_share_of_height: table
            .number("edge_share_of_height", 0.0..=1.0)
            .unwrap_or(defaults.edge_share_of_height),
    }
}

fn mount_noise(table: &Reader<'_, '_>) -> MountNoise {
    let defaults = MountNoise::default();
    MountNoise {
        pitch_rad: table
            .number("slope_std_dev_deg", 0.0..=45.0)
            .map_or(defaults.pitch_rad, f64::to_radians),
        ground_m: table
            .number("height_std_dev_m", 0.0..=10.0)
            .unwrap_or(defaults.ground_m),
        local_slope_rad: table
            .number("local_slope_std_dev_deg", 0.0..=45.0)
            .map_or(defaults.local_slope_rad, f64::to_radians),
    }
}

fn hidden_shares(table: &Reader<'_, '_>) -> HiddenShares {
    let defaults = HiddenShares::default();
    // Twice the one and the other leave at least a tenth of the objects whole.
    let share = |key, default| table.number(key, 0.0..=0.3).unwrap_or(default);
    HiddenShares {
        side: share("side_share", defaults.side),
        foot: share("foot_share", defaults.foot),
    }
}

fn table_options(table: &Reader<'_, '_>) -> TableOptions {
    let defaults = TableOptions::default();
    let splits = [("axis", SplitMode::Axis), ("literal", SplitMode::Literal)];
    let distances = [
        ("fitted", QueryDistance::Fitted),
        ("literal", QueryDistance::Literal),
    ];
    TableOptions {
        split: table.choice("split", &splits).unwrap_or(defaults.split),
        weight: weight(table).unwrap_or(defaults.weight),
        distance: table
            .choice("distance", &distances)
            .unwrap_or(defaults.distance),
        score_limit_px: table
            .number("score_limit_px", 0.0..=1e6)
            .map_or(defaults.score_limit_px, |limit| limit as f32),
    }
}

/// `weight = 20.0` with `weight_at_image_width_px`, or `weight = "box_width"`.
fn weight(table: &Reader<'_, '_>) -> Option<Weight> {
    let at_width = table.integer("weight_at_image_width_px", 1..=16_384);
    if at_width.is_some() && (table.is_text("weight") || !table.has("weight")) {
        table.note(
            "weight_at_image_width_px",
            "needs a weight in pixels per metre",
        );
    }
    if table.is_text("weight") {
        return table.choice("weight", &[("box_width", Weight::BoxWidth)]);
    }
    let value = table.number("weight", 0.0..=1e6)? as f32;
    Some(Weight::PxPerMetre {
        value,
        at_image_width_px: at_width.unwrap_or(roadwatch_locate::table::DEFAULT_WEIGHT_WIDTH_PX),
    })
}

fn grid(table: &Reader<'_, '_>) -> GridSpec {
    let defaults = GridSpec::default();
    let metres = |key, default| table.number(key, 0.01..=1000.0).unwrap_or(default);
    GridSpec {
        step_m: metres("step_m", defaults.step_m),
        nearest_m: metres("nearest_m", defaults.nearest_m),
        farthest_m: metres("farthest_m", defaults.farthest_m),
        lateral_m: metres("lateral_m", defaults.lateral_m),
        headings: table
            .integer("headings", 1..=360)
            .unwrap_or(defaults.headings),
        visible_share: defaults.visible_share,
    }
}
