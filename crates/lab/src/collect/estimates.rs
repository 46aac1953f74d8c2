//! `estimates.jsonl`: what the daemon said of each image, with the keys of `truth.jsonl` where both say the same thing.

use super::trigger::Opinion;
use roadwatch_core::{CameraId, Perceived, Rig, Track};
use serde_json::{Value, json};

/// The line of one image, with its line feed.
pub(super) fn line(
    rig: &Rig,
    frame: u64,
    perceived: &Perceived,
    opinions: &[Vec<Opinion>],
) -> String {
    let camera: CameraId = perceived.tracks.frame.camera;
    let objects = perceived.tracks.items.iter().zip(opinions);
    let objects: Vec<Value> = objects
        .map(|(track, others)| object(track, others))
        .collect();
    let unlocated = perceived.unlocated.iter().map(|detection| {
        json!({"class": detection.class.as_str(), "score": detection.score.get(), "box_px": corners(&detection.box_px)})
    });
    let line = json!({
        "frame": frame,
        "camera": rig.camera(camera).name.as_str(),
        "objects": objects,
        "unlocated": unlocated.collect::<Vec<_>>(),
    });
    format!("{line}\n")
}

fn object(track: &Track, others: &[Opinion]) -> Value {
    let located = &track.observed.located;
    let (position, size) = (track.position(), track.size());
    let covariance: Vec<f64> = track.covariance().matrix.iter().copied().collect();
    let heading = track.heading();
    let others: serde_json::Map<String, Value> = others
        .iter()
        .map(|other| {
            let place = [other.position.x(), other.position.y(), other.position.z()];
            (other.method.as_str().to_owned(), json!(place))
        })
        .collect();
    json!({
        "id": track.id.0.to_string(),
        "class": track.class().as_str(),
        "score": located.detection.score.get(),
        "box_px": corners(&located.detection.box_px),
        "center_base_m": [position.x(), position.y(), position.z()],
        "covariance_base_m2": covariance,
        "size_lwh_m": [size.length_m, size.width_m, size.height_m],
        "yaw_base_rad": heading.map(|heading| heading.yaw_rad),
        "yaw_std_rad": heading.map(|heading| heading.std_dev_rad),
        "flip_probability": heading.map(|heading| heading.flip_probability),
        "parts": track.observed.components.iter().map(|part| &*part.name).collect::<Vec<_>>(),
        "method": located.location.method.as_str(),
        "held": located.location.held,
        "others_base_m": others,
    })
}

fn corners(box_px: &roadwatch_core::BoxPx) -> [f32; 4] {
    [box_px.x_min, box_px.y_min, box_px.x_max, box_px.y_max]
}
