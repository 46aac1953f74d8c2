//! How a camera sees: its lens, from keys of its own or from a `camera_info`, and its measured focal value.

use super::{camera_info, reader::Reader};
use roadwatch_core::{CameraModel, Distortion, ImageSize, Intrinsics, MeasuredFocal};

/// What a `camera_info` says instead.
const LENS_KEYS: [&str; 6] = ["fx", "fy", "cx", "cy", "distortion_model", "distortion"];
const LARGEST_SIDE_PX: u32 = 16_384;
/// Beyond this a focal length is a slip of units, pixels.
const LONGEST_FOCAL_PX: f64 = 1e6;

/// From `camera_info`, or from keys of its own; `None` when there is a mistake, which is noted.
pub(super) fn read(table: &Reader<'_, '_>) -> Option<CameraModel> {
    if !table.has(camera_info::KEY) {
        return read_lens(table);
    }
    let side = |key| table.integer(key, 1..=LARGEST_SIDE_PX);
    let given = side("width").zip(side("height"));
    let expected = given.map(|(width_px, height_px)| ImageSize {
        width_px,
        height_px,
    });
    for key in LENS_KEYS.into_iter().filter(|key| table.has(key)) {
        table.note(key, "is in the camera_info already: name the lens once");
        table.mark_read(key);
    }
    camera_info::read(table, expected)
}

fn read_lens(table: &Reader<'_, '_>) -> Option<CameraModel> {
    let width_px = table.required_integer("width", 1..=LARGEST_SIDE_PX);
    let height_px = table.required_integer("height", 1..=LARGEST_SIDE_PX);
    let focal = |key| table.required_number(key, 1.0..=LONGEST_FOCAL_PX);
    let center = |key| table.required_number(key, -LONGEST_FOCAL_PX..=LONGEST_FOCAL_PX);
    let (fx, fy, cx, cy) = (focal("fx"), focal("fy"), center("cx"), center("cy"));
    let coefficients = table.number_list("distortion").unwrap_or_default();
    if table.has("distortion") && !table.has("distortion_model") {
        table.note(
            "distortion",
            "needs a distortion_model, such as \"plumb_bob\"",
        );
    }
    let lens = Distortion::from_ros(
        table.text("distortion_model").unwrap_or("none"),
        &coefficients,
    );
    let distortion = lens
        .map_err(|error| table.note("distortion_model", error.to_string()))
        .ok();
    Some(CameraModel {
        size: ImageSize {
            width_px: width_px?,
            height_px: height_px?,
        },
        intrinsics: Intrinsics {
            fx: fx?,
            fy: fy?,
            cx: cx?,
            cy: cy?,
        },
        distortion: distortion?,
    })
}

/// The focal value of eq. 1; without an image height of its own it belongs to the camera's.
pub(super) fn read_measured_focal(
    table: &Reader<'_, '_>,
    camera_height_px: u32,
) -> Option<MeasuredFocal> {
    let focal = table.number("measured_focal_px", 1.0..=LONGEST_FOCAL_PX);
    let height = table.integer("measured_focal_image_height_px", 1..=LARGEST_SIDE_PX);
    if height.is_some() && !table.has("measured_focal_px") {
        table.note("measured_focal_image_height_px", "needs measured_focal_px");
    }
    Some(MeasuredFocal {
        focal_px: focal?,
        image_height_px: height.unwrap_or(camera_height_px),
    })
}
