//! Cameras, silhouettes and random numbers that the tests of this crate share.

use roadwatch_core::{
    BoxPx, CameraModel, CameraName, Detection, Distortion, ImageSize, Intrinsics, MeasuredFocal,
    Mount, ObjectClass, RigCamera, Score, SizeLwh, space::Point,
};
use roadwatch_locate::{
    CalibrationHash, ExpectedDistance, GroundPose, HullSpec, LocationTable, SilhouetteCamera,
    SizeGroup, TableRow,
    table::{Grid, TableHeader},
};
use std::sync::Arc;

/// A car as Table 2 has it.
pub(crate) const CAR: SizeLwh = SizeLwh {
    length_m: 5.1,
    width_m: 1.9,
    height_m: 1.5,
};

/// A camera 2.18 m above the ground that looks forward, `pitch_deg` downwards, rolled by `roll_deg`.
pub(crate) fn camera(focal_px: f64, pitch_deg: f64, roll_deg: f64) -> RigCamera {
    let mount = Mount {
        pitch_rad: pitch_deg.to_radians(),
        roll_rad: roll_deg.to_radians(),
        ..Mount::ahead([0.85, 0.0, 2.18])
    };
    RigCamera {
        name: CameraName::new("front").expect("a name"),
        model: CameraModel {
            size: ImageSize {
                width_px: 960,
                height_px: 540,
            },
            intrinsics: Intrinsics {
                fx: focal_px,
                fy: focal_px,
                cx: 485.0,
                cy: 241.6,
            },
            distortion: Distortion::None,
        },
        base_from_optical: mount.base_from_optical(),
        measured_focal: Some(MeasuredFocal {
            focal_px,
            image_height_px: 540,
        }),
    }
}

/// The camera over its ground plane.
pub(crate) fn silhouettes(camera: &RigCamera) -> SilhouetteCamera {
    let base_from_ground = camera.base_from_ground(0.0).expect("not vertical");
    SilhouetteCamera::new(
        camera.model,
        camera.base_from_optical.inverse() * base_from_ground,
    )
}

/// Cars.
pub(crate) fn cars() -> SizeGroup {
    SizeGroup {
        classes: vec![ObjectClass::new("car")],
        size: CAR,
    }
}

/// The hull of a car.
pub(crate) fn car_hull() -> HullSpec {
    HullSpec::for_class(&ObjectClass::new("car"))
}

/// A table of these rows, of cars in a level camera.
pub(crate) fn table(rows: Vec<TableRow>) -> Arc<LocationTable> {
    let camera = camera(985.0, 0.0, 0.0);
    let header = TableHeader {
        image_size: camera.model.size,
        calibration: CalibrationHash::of(&camera, 0.0),
        camera: camera.name,
        group: cars(),
        expected: ExpectedDistance::literal(1.5),
        made: "for a test".to_owned(),
        grid: Grid {
            origin_loc_x_m: -50.0,
            origin_loc_y_m: 1.0,
            step_m: 1.0,
            columns: 101,
        },
    };
    Arc::new(LocationTable::new(header, rows).expect("a table"))
}

/// A row of a car at `loc_x_m` and `distance_m` ahead.
pub(crate) fn row(center_x_px: f32, center_y_px: f32, distance_m: f32, loc_x_m: f32) -> TableRow {
    TableRow {
        area_px2: 1.0,
        center_x_px,
        center_y_px,
        distance_m,
        loc_x_m,
        loc_y_m: distance_m,
        loc: 0,
    }
}

/// A detected object of a class.
pub(crate) fn detection(class: &str, box_px: BoxPx) -> Detection {
    Detection {
        class: ObjectClass::new(class),
        score: Score::new(0.9).expect("a score"),
        input_pixel_px: 1.0,
        box_px,
    }
}

/// The box of a car on the optical axis' ground line, end-on.
pub(crate) fn car_ahead(camera: &RigCamera, loc_y_m: f64) -> Detection {
    let pose = GroundPose {
        loc_x_m: 0.3,
        loc_y_m,
        heading_rad: 0.4,
    };
    let seen = silhouettes(camera).silhouette_px(&car_hull().points(CAR), pose);
    detection("car", seen.expect("in front of the camera"))
}

/// A car somewhere in view: where, its depth, and its box.
pub(crate) struct SeenCar {
    pub(crate) pose: GroundPose,
    pub(crate) depth_m: f64,
    pub(crate) box_px: BoxPx,
}

/// `count` cars at 6 to 50 m, anywhere in view with at least nine tenths of their box, of any heading.
pub(crate) fn seen_cars(camera: &RigCamera, random: &mut Random, count: usize) -> Vec<SeenCar> {
    let over_ground = silhouettes(camera);
    let points = car_hull().points(CAR);
    std::iter::repeat_with(|| {
        let range_m = random.between(6.0, 50.0);
        let azimuth_rad = random.between(-1.0, 1.0);
        let pose = GroundPose {
            loc_x_m: range_m * azimuth_rad.sin(),
            loc_y_m: range_m * azimuth_rad.cos(),
            heading_rad: random.between(0.0, std::f64::consts::TAU),
        };
        let whole = over_ground.silhouette_px(&points, pose)?;
        let (box_px, share) = over_ground.clip(whole)?;
        let center = Point::new(pose.loc_y_m, -pose.loc_x_m, CAR.height_m / 2.0);
        (share >= 0.9).then(|| SeenCar {
            pose,
            depth_m: over_ground.depth_m(center),
            box_px,
        })
    })
    .flatten()
    .take(count)
    .collect()
}

/// SplitMix64: the same numbers on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.unit()
    }

    /// Nearly normal: the sum of twelve uniform numbers less six.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}
