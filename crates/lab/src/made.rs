//! Samples made by hand, for tests.

use crate::{
    sample::{Estimator, Sample, Target},
    sample_table::SampleTable,
    truth::TruthObject,
};
use nalgebra::Matrix3;
use roadwatch_core::{
    BoxPx, CameraModel, CameraName, Distortion, HeadingCandidates, ImageSize, Intrinsics, Location,
    Method, Mount, RigCamera, SizeLwh,
    space::{BaseLink, Covariance, Point},
};
use std::{
    f64::consts::PI,
    sync::{Arc, LazyLock},
};

/// Smaller than any car, so that assumed and true sizes can be told apart where they matter.
const SIZE: SizeLwh = SizeLwh {
    length_m: 4.0,
    width_m: 2.0,
    height_m: 1.4,
};

/// A car 20 m ahead that comes towards the camera.
pub(crate) static CAR_TRUTH: LazyLock<TruthObject> = LazyLock::new(|| TruthObject {
    id: "a".to_owned(),
    class: "car".to_owned(),
    label: None,
    box_px: BoxPx::new(400.0, 250.0, 500.0, 310.0),
    silhouette_px: None,
    visible_px: None,
    truncated: 0.0,
    occluded: 0.0,
    center: Point::new(20.0, 0.0, 0.7),
    size: Some(SIZE),
    yaw_rad: Some(PI),
});

/// A camera over base_link's origin that looks ahead.
pub(crate) fn camera() -> RigCamera {
    RigCamera {
        name: CameraName::new("front").expect("a name"),
        model: CameraModel {
            size: ImageSize {
                width_px: 960,
                height_px: 540,
            },
            intrinsics: Intrinsics {
                fx: 900.0,
                fy: 900.0,
                cx: 480.0,
                cy: 260.0,
            },
            distortion: Distortion::None,
        },
        base_from_optical: Mount::ahead([0.0, 0.0, 1.6]).base_from_optical(),
        measured_focal: None,
    }
}

/// An answer with one square metre of variance and without headings.
pub(crate) fn location(position: Point<BaseLink>) -> Location {
    Location {
        position,
        covariance: Covariance::new(Matrix3::identity()),
        depth_m: position.x(),
        range_m: position.x().hypot(position.y()),
        size: SIZE,
        method: Method::TriangleFy,
        headings: HeadingCandidates::default(),
        ground: None,
        held: false,
    }
}

/// A car straight ahead, `range_m` away and found at `found_m` with its true heading, by what is published.
pub(crate) fn sample(found_m: f64, range_m: f64) -> Sample {
    sample_of("a", found_m, range_m)
}

/// The same of another car.
pub(crate) fn sample_of(id: &str, found_m: f64, range_m: f64) -> Sample {
    let heading = roadwatch_core::Heading {
        yaw_rad: PI,
        std_dev_rad: 0.1,
        flip_probability: 0.0,
    };
    let found = location(Point::new(found_m, 0.0, 0.7));
    Sample::judge(
        Estimator::Published,
        &target(id, range_m),
        Some((&found, Some(heading))),
    )
}

/// The same without an answer.
pub(crate) fn without_place(range_m: f64) -> Sample {
    Sample::judge(Estimator::Published, &target("a", range_m), None)
}

/// A table of these samples and their objects.
pub(crate) fn table(samples: Vec<Sample>) -> SampleTable {
    let targets = samples.iter().map(|sample| Arc::clone(&sample.target));
    SampleTable {
        targets: targets.collect(),
        samples,
    }
}

fn target(id: &str, range_m: f64) -> Arc<Target> {
    let object = TruthObject {
        id: id.to_owned(),
        center: Point::new(range_m, 0.0, 0.7),
        ..CAR_TRUTH.clone()
    };
    Arc::new(Target::new(&object, &camera(), true))
}
