//! `autoware_perception_msgs/DetectedObjects`: the scene as Autoware's own detectors would give it.

use super::{
    pose::{UncertainPose, extents},
    seen::SeenTogether,
};
use crate::msg::autoware_perception_msgs::{
    DetectedObject, DetectedObjectKinematics, DetectedObjects, ObjectClassification, Shape,
};
use roadwatch_core::{KeptHeading, Oriented};

/// A chance above this that front and back are mistaken is too much to call the orientation known.
const SURE_OF_FRONT: f64 = 0.1;

/// Our classes by Autoware's numbers; others are unknown to it.
const LABELS: [(&str, u8); 8] = [
    ("car", ObjectClassification::CAR),
    ("van", ObjectClassification::CAR),
    ("truck", ObjectClassification::TRUCK),
    ("bus", ObjectClassification::BUS),
    ("motorcycle", ObjectClassification::MOTORCYCLE),
    ("bicycle", ObjectClassification::BICYCLE),
    ("cyclist", ObjectClassification::BICYCLE),
    ("person", ObjectClassification::PEDESTRIAN),
];
const PEDESTRIAN: u8 = ObjectClassification::PEDESTRIAN;

pub(crate) fn detected_objects(seen: &SeenTogether) -> DetectedObjects {
    let objects = seen.objects.iter();
    DetectedObjects {
        header: seen.header(),
        objects: objects.map(|one| detected(&one.track.observed)).collect(),
    }
}

fn detected(object: &Oriented) -> DetectedObject {
    let located = &object.located;
    let class = located.detection.class.as_str();
    let label = LABELS.iter().find(|(name, _)| *name == class);
    let label = label.map_or(ObjectClassification::UNKNOWN, |&(_, label)| label);
    let score = located.detection.score.get();
    DetectedObject {
        existence_probability: score,
        classification: vec![ObjectClassification {
            label,
            probability: 1.0,
        }],
        kinematics: DetectedObjectKinematics {
            pose_with_covariance: (&UncertainPose::in_base(object)).into(),
            has_position_covariance: true,
            orientation_availability: availability(object.heading),
            // One image says nothing of velocities.
            ..DetectedObjectKinematics::default()
        },
        shape: Shape {
            // People have no front that a box would show.
            kind: match label {
                PEDESTRIAN => Shape::CYLINDER,
                _ => Shape::BOUNDING_BOX,
            },
            dimensions: extents(located.location.size),
            ..Shape::default()
        },
    }
}

fn availability(heading: Option<KeptHeading>) -> u8 {
    match heading {
        None => DetectedObjectKinematics::UNAVAILABLE,
        Some(kept) if kept.heading.flip_probability > SURE_OF_FRONT => {
            DetectedObjectKinematics::SIGN_UNKNOWN
        }
        Some(_) => DetectedObjectKinematics::AVAILABLE,
    }
}
