//! `roadwatch_msgs/ObjectArray`: everything that is known.

use super::{
    pose::{extents, yaw_variance},
    seen::{Seen, SeenTogether},
};
use crate::msg::{
    geometry_msgs::Vector3,
    roadwatch_msgs::{KeyComponent, Object, ObjectArray},
    unique_identifier_msgs::UUID,
};
use nalgebra::{Matrix2, Vector2};
use roadwatch_core::{SeenComponent, Timestamp, TrackId};

/// All objects, in the output's order.
pub(crate) fn objects(seen: &SeenTogether) -> ObjectArray {
    ObjectArray {
        header: seen.header(),
        camera: seen.camera.to_owned(),
        ego_motion: seen.ego.knowledge.as_str().to_owned(),
        ego_pose: (&seen.ego.odom_from_base.isometry).into(),
        objects: seen.objects.iter().map(|one| object(seen, one)).collect(),
    }
}

fn object(together: &SeenTogether, seen: &Seen) -> Object {
    let (track, placed) = (seen.track, &seen.placed);
    let oriented = &track.observed;
    let detection = &oriented.located.detection;
    let location = &oriented.located.location;
    let box_px = &detection.box_px;
    let heading = placed.heading;
    let mut position_covariance = [0.0; 9];
    position_covariance.copy_from_slice(placed.covariance.as_slice());
    let (depth_m, range_m) = seen.depth_range_m;
    Object {
        header: together.header_of(seen),
        seen_at: seen.seen_at.into(),
        track_id: track.id.0,
        class_id: track.class().as_str().to_owned(),
        score: detection.score.get(),
        box_px: [box_px.x_min, box_px.y_min, box_px.x_max, box_px.y_max],
        position: placed.position.into(),
        position_covariance,
        size: extents(track.size()),
        depth_m,
        range_m,
        method: location.method.as_str().to_owned(),
        held: location.held,
        heading_known: heading.is_some(),
        yaw_rad: heading.map_or(0.0, |heading| heading.yaw_rad),
        yaw_variance: yaw_variance(heading),
        flip_probability: heading.map_or(0.5, |heading| heading.flip_probability as f32),
        heading_age: oriented.heading.map_or(0.0, |kept| kept.age.as_secs_f32()),
        components: oriented.components.iter().map(component).collect(),
        seen_by: seen.seen_by.iter().map(|&name| name.to_owned()).collect(),
        ..tracked(seen)
    }
}

/// What only a tracked object has.
fn tracked(seen: &Seen) -> Object {
    let Some((motion, moves)) = seen.track.motion.as_ref().zip(seen.placed.moves) else {
        return Object {
            state: "untracked".to_owned(),
            ..Object::default()
        };
    };
    let flat = |matrix: Matrix2<f64>| [matrix.m11, matrix.m12, matrix.m21, matrix.m22];
    Object {
        uuid: uuid(seen.track.id, motion.first_seen),
        state: motion.phase.as_str().to_owned(),
        predicted: seen.is_predicted(),
        age: seen.stamp.saturating_since(motion.first_seen).as_secs_f32(),
        motion_known: true,
        velocity: over_ground(moves.velocity.0),
        velocity_covariance: flat(moves.velocity.1),
        acceleration: over_ground(moves.acceleration.0),
        acceleration_covariance: flat(moves.acceleration.1),
        turn_rate: motion.turn_rate_rad_s as f32,
        turn_rate_variance: motion.turn_rate_variance as f32,
        ..Object::default()
    }
}

/// A vector of the ground's plane.
pub(crate) fn over_ground(vector: Vector2<f64>) -> Vector3 {
    Vector3 {
        x: vector.x,
        y: vector.y,
        z: 0.0,
    }
}

/// A name that no other object has: a version 8 UUID (RFC 9562) of the moment it was first seen and its number, so that the
/// same input gives the same names.
pub(crate) fn uuid(id: TrackId, first_seen: Timestamp) -> UUID {
    let moment = first_seen.as_nanos() as u64;
    let (high, low) = (
        moment >> 16,
        (moment & 0xFFFF) << 46 | id.0 & ((1 << 46) - 1),
    );
    let mut bytes = [0; 16];
    // 48 bits of the moment, the version, 12 that are free, the variant, 16 bits of the moment, 46 of the number.
    bytes[..6].copy_from_slice(&high.to_be_bytes()[2..]);
    bytes[6] = 0x80;
    bytes[8..].copy_from_slice(&(1 << 63 | low).to_be_bytes());
    UUID { uuid: bytes }
}

fn component(seen: &SeenComponent) -> KeyComponent {
    KeyComponent {
        name: seen.name.to_string(),
        x_px: seen.position_px.x as f32,
        y_px: seen.position_px.y as f32,
        score: seen.score,
    }
}
