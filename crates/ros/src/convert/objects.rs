//! `roadwatch_msgs/ObjectArray`: everything that is known.

use super::{
    pose::{extents, yaw_variance},
    seen::{Seen, SeenTogether},
};
use crate::msg::roadwatch_msgs::{KeyComponent, Object, ObjectArray};
use roadwatch_core::SeenComponent;

/// All objects, in the output's order.
pub(crate) fn objects(seen: &SeenTogether) -> ObjectArray {
    ObjectArray {
        header: seen.header(),
        camera: seen.camera.to_owned(),
        objects: seen.objects.iter().map(|one| object(seen, one)).collect(),
    }
}

fn object(together: &SeenTogether, seen: &Seen) -> Object {
    let oriented = &seen.track.observed;
    let detection = &oriented.located.detection;
    let location = &oriented.located.location;
    let box_px = &detection.box_px;
    let heading = oriented.heading.map(|kept| kept.heading);
    let mut position_covariance = [0.0; 9];
    position_covariance.copy_from_slice(location.covariance.matrix.as_slice());
    Object {
        header: together.header_of(seen),
        track_id: seen.track.id.0,
        class_id: detection.class.as_str().to_owned(),
        score: detection.score.get(),
        box_px: [box_px.x_min, box_px.y_min, box_px.x_max, box_px.y_max],
        position: location.position.coords.into(),
        position_covariance,
        size: extents(location.size),
        depth_m: location.depth_m,
        range_m: location.range_m,
        method: location.method.as_str().to_owned(),
        held: location.held,
        heading_known: oriented.heading.is_some(),
        yaw_rad: heading.map_or(0.0, |heading| heading.yaw_rad),
        yaw_variance: yaw_variance(oriented.heading),
        flip_probability: heading.map_or(0.5, |heading| heading.flip_probability as f32),
        heading_age: oriented.heading.map_or(0.0, |kept| kept.age.as_secs_f32()),
        components: oriented.components.iter().map(component).collect(),
        seen_by: seen.seen_by.iter().map(|&name| name.to_owned()).collect(),
    }
}

fn component(seen: &SeenComponent) -> KeyComponent {
    KeyComponent {
        name: seen.name.to_string(),
        x_px: seen.position_px.x as f32,
        y_px: seen.position_px.y as f32,
        score: seen.score,
    }
}
