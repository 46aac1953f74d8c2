//! `autoware_perception_msgs`: the scene as Autoware's own detectors and trackers would give it.

use super::{
    objects::{over_ground, uuid},
    pose::{UncertainPose, extents},
    seen::{Seen, SeenTogether},
};
use crate::msg::{
    autoware_perception_msgs::{
        DetectedObject, DetectedObjectKinematics, DetectedObjects, ObjectClassification, Shape,
        TrackedObject, TrackedObjectKinematics, TrackedObjects,
    },
    geometry_msgs::{Accel, AccelWithCovariance, Twist, TwistWithCovariance, Vector3},
};
use nalgebra::{Matrix2, Rotation2, Vector2};
use roadwatch_core::{EgoKnowledge, Heading, Phase};

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

/// Slower than this an object stands, as far as a camera can tell, metres per second.
const STANDS_M_S: f64 = 0.5;
/// An object is there with at least this certainty once it is confirmed: three frames agree.
const CONFIRMED_PROBABILITY: f32 = 0.9;

pub(crate) fn detected_objects(seen: &SeenTogether) -> DetectedObjects {
    let here = seen.objects.iter().filter(|one| !one.is_predicted());
    DetectedObjects {
        header: seen.header(),
        objects: here.map(|one| detected(seen, one)).collect(),
    }
}

/// Only objects that are tracked: nothing without tracking.
pub(crate) fn tracked_objects(seen: &SeenTogether) -> TrackedObjects {
    let objects = seen.objects.iter();
    TrackedObjects {
        header: seen.header(),
        objects: objects.filter_map(|one| tracked(seen, one)).collect(),
    }
}

fn detected(together: &SeenTogether, seen: &Seen) -> DetectedObject {
    let twist = velocity_over_ground(together, seen);
    DetectedObject {
        existence_probability: seen.track.observed.located.detection.score.get(),
        classification: classification(seen),
        kinematics: DetectedObjectKinematics {
            pose_with_covariance: (&UncertainPose::of(&seen.placed)).into(),
            has_position_covariance: true,
            orientation_availability: availability(seen.placed.heading),
            twist_with_covariance: twist.unwrap_or_default(),
            has_twist: twist.is_some(),
            has_twist_covariance: twist.is_some(),
        },
        shape: shape(seen),
    }
}

fn tracked(together: &SeenTogether, seen: &Seen) -> Option<TrackedObject> {
    let motion = seen.track.motion.as_ref()?;
    let score = seen.track.observed.located.detection.score.get();
    let moves = seen.placed.moves?;
    let (accel, covariance) = along_own_axes(seen, moves.acceleration);
    Some(TrackedObject {
        object_id: uuid(seen.track.id, motion.first_seen),
        existence_probability: match motion.phase {
            Phase::Tentative => score,
            Phase::Confirmed => score.max(CONFIRMED_PROBABILITY),
            Phase::Coasting => score.min(CONFIRMED_PROBABILITY),
        },
        classification: classification(seen),
        kinematics: TrackedObjectKinematics {
            pose_with_covariance: (&UncertainPose::of(&seen.placed)).into(),
            orientation_availability: availability(seen.placed.heading),
            twist_with_covariance: velocity_over_ground(together, seen).unwrap_or_default(),
            acceleration_with_covariance: AccelWithCovariance {
                accel: Accel {
                    linear: over_ground(accel),
                    ..Accel::default()
                },
                covariance: flat_covariance(&covariance, 0.0),
            },
            is_stationary: motion.speed_m_s() < STANDS_M_S
                && together.ego.knowledge != EgoKnowledge::None,
        },
        shape: shape(seen),
    })
}

/// Autoware's velocities are over ground, along the object's own axes; `None` where the vehicle's motion is unknown.
fn velocity_over_ground(together: &SeenTogether, seen: &Seen) -> Option<TwistWithCovariance> {
    let (motion, moves) = seen.track.motion.as_ref().zip(seen.placed.moves)?;
    if together.ego.knowledge == EgoKnowledge::None {
        return None;
    }
    let (velocity, covariance) = along_own_axes(seen, moves.velocity);
    Some(TwistWithCovariance {
        twist: Twist {
            linear: over_ground(velocity),
            angular: Vector3 {
                z: motion.turn_rate_rad_s,
                ..Vector3::default()
            },
        },
        covariance: flat_covariance(&covariance, motion.turn_rate_variance),
    })
}

/// Along the axes of the published pose, which stays unturned when the heading is unknown.
fn along_own_axes(
    seen: &Seen,
    (vector, matrix): (Vector2<f64>, Matrix2<f64>),
) -> (Vector2<f64>, Matrix2<f64>) {
    let yaw_rad = seen.placed.heading.map_or(0.0, |heading| heading.yaw_rad);
    let turn = Rotation2::new(-yaw_rad);
    (
        turn * vector,
        turn.matrix() * matrix * turn.matrix().transpose(),
    )
}

fn flat_covariance(matrix: &Matrix2<f64>, about_z: f64) -> [[f64; 6]; 6] {
    let mut covariance = [[0.0; 6]; 6];
    for row in 0..2 {
        for column in 0..2 {
            covariance[row][column] = matrix[(row, column)];
        }
    }
    covariance[5][5] = about_z;
    covariance
}

fn label(seen: &Seen) -> u8 {
    let class = seen.track.class().as_str();
    let label = LABELS.iter().find(|(name, _)| *name == class);
    label.map_or(ObjectClassification::UNKNOWN, |&(_, label)| label)
}

fn classification(seen: &Seen) -> Vec<ObjectClassification> {
    vec![ObjectClassification {
        label: label(seen),
        probability: 1.0,
    }]
}

fn shape(seen: &Seen) -> Shape {
    Shape {
        // People have no front that a box would show.
        kind: match label(seen) {
            PEDESTRIAN => Shape::CYLINDER,
            _ => Shape::BOUNDING_BOX,
        },
        dimensions: extents(seen.track.size()),
        ..Shape::default()
    }
}

fn availability(heading: Option<Heading>) -> u8 {
    match heading {
        None => DetectedObjectKinematics::UNAVAILABLE,
        Some(heading) if heading.flip_probability > SURE_OF_FRONT => {
            DetectedObjectKinematics::SIGN_UNKNOWN
        }
        Some(_) => DetectedObjectKinematics::AVAILABLE,
    }
}
