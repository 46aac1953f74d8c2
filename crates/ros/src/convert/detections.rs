//! `vision_msgs`: boxes in the image and in space.

use super::{
    pose::{UncertainPose, extents},
    seen::SeenTogether,
};
use crate::msg::{
    geometry_msgs::PoseWithCovariance,
    std_msgs::Header,
    vision_msgs::{
        BoundingBox2D, BoundingBox3D, Detection2D, Detection2DArray, Detection3D, Detection3DArray,
        ObjectHypothesis, ObjectHypothesisWithPose, Point2D, Pose2D,
    },
};
use roadwatch_core::{BoxPx, Detection, RigCamera};

/// Boxes as detected, pixels: first those of tracks, each with the object's pose in the optical frame,
/// then those without a place, whose id is empty and whose pose is marked unknown.
pub(crate) fn detections_2d(
    seen: &SeenTogether,
    unlocated: &[Detection],
    camera: &RigCamera,
) -> Detection2DArray {
    let header = Header::new(seen.stamp, camera.name.optical_frame());
    let detection = |found: &Detection, pose, id| Detection2D {
        header: header.clone(),
        results: vec![hypothesis(found, pose)],
        bbox: box_2d(&found.box_px),
        id,
    };
    let tracked = seen.objects.iter().map(|one| {
        let pose = UncertainPose::in_optical(&one.placed, camera.base_from_optical);
        detection(
            &one.track.observed.located.detection,
            (&pose).into(),
            one.track.id.0.to_string(),
        )
    });
    let placeless = unlocated
        .iter()
        .map(|found| detection(found, pose_unknown(), String::new()));
    Detection2DArray {
        detections: tracked.chain(placeless).collect(),
        header: header.clone(),
    }
}

/// Boxes in space, in the base frame. The pose stands twice, in `bbox` and in `results[0]`, because
/// viewers read the one and trackers the other.
pub(crate) fn detections_3d(seen: &SeenTogether) -> Detection3DArray {
    let detections = seen
        .objects
        .iter()
        .map(|one| {
            let located = &one.track.observed.located;
            let pose = UncertainPose::of(&one.placed);
            let mut results = hypothesis(&located.detection, (&pose).into());
            results.hypothesis.class_id = one.track.class().as_str().to_owned();
            Detection3D {
                header: seen.header_of(one),
                results: vec![results],
                bbox: BoundingBox3D {
                    center: (&pose.isometry).into(),
                    size: extents(one.track.size()),
                },
                id: one.track.id.0.to_string(),
            }
        })
        .collect();
    Detection3DArray {
        header: seen.header(),
        detections,
    }
}

fn hypothesis(detection: &Detection, pose: PoseWithCovariance) -> ObjectHypothesisWithPose {
    ObjectHypothesisWithPose {
        hypothesis: ObjectHypothesis {
            class_id: detection.class.as_str().to_owned(),
            score: f64::from(detection.score.get()),
        },
        pose,
    }
}

/// No pose: -1 as the first variance, which is how `sensor_msgs` says that there is none.
fn pose_unknown() -> PoseWithCovariance {
    let mut pose = PoseWithCovariance::default();
    pose.covariance[0][0] = -1.0;
    pose
}

/// Measured by edges, as the box itself is, so that centre and size give back its corners.
fn box_2d(box_px: &BoxPx) -> BoundingBox2D {
    let [x_min, y_min, x_max, y_max] =
        [box_px.x_min, box_px.y_min, box_px.x_max, box_px.y_max].map(f64::from);
    BoundingBox2D {
        center: Pose2D {
            position: Point2D {
                x: (x_min + x_max) / 2.0,
                y: (y_min + y_max) / 2.0,
            },
            theta: 0.0,
        },
        size_x: x_max - x_min,
        size_y: y_max - y_min,
    }
}
