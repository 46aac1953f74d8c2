//! What one camera saw, with the 3D boxes that were published for it.

use crate::{
    canvas::{Canvas, DrawError},
    cuboid::Cuboid,
    palette::{self, Colour},
};
use roadwatch_core::{Detection, Oriented, Perceived, RigCamera, Track};

/// Letters' height for an image 540 pixels high; they grow with the image.
const LETTER_SHARE: f64 = 11.0 / 540.0;
/// Boxes lower than this share of the image get thin lines, so that the object stays visible.
const THIN_BELOW: f64 = 0.1;
/// Sizes below this are not readable, pixels.
const MIN_LETTER_PX: f64 = 8.0;

/// The camera's image with each object's 3D box, its class, distance and identity; detections without a place
/// are thin 2D boxes.
///
/// # Errors
/// When the image cannot be decoded.
pub fn camera_view(camera: &RigCamera, perceived: &Perceived) -> Result<Canvas, DrawError> {
    let image = perceived
        .tracks
        .frame
        .image
        .pixels()
        .map_err(Clone::clone)?;
    let mut canvas = Canvas::of_image(image)?;
    for detection in &perceived.unlocated {
        outline_2d(&mut canvas, detection)?;
    }
    // The nearest last, over those behind it.
    let mut tracks: Vec<_> = perceived.tracks.items.iter().collect();
    tracks.sort_by(|a, b| range_m(b).total_cmp(&range_m(a)));
    for track in tracks {
        draw_object(&mut canvas, camera, track)?;
    }
    Ok(canvas)
}

fn range_m(track: &Track) -> f64 {
    track.observed.located.location.range_m
}

fn draw_object(canvas: &mut Canvas, camera: &RigCamera, track: &Track) -> Result<(), DrawError> {
    let object = &track.observed;
    let colour = palette::of_identity(track.id);
    let share = f64::from(object.located.detection.box_px.height_px())
        / f64::from(camera.model.size.height_px);
    let width = if share < THIN_BELOW { 1 } else { 2 };
    for [a, b] in Cuboid::of(track).edges_px(camera) {
        canvas.line(a, b, colour, width)?;
    }
    label(canvas, object, track, colour)
}

fn outline_2d(canvas: &mut Canvas, detection: &Detection) -> Result<(), DrawError> {
    let corners = corners_px(detection);
    canvas.outline(&corners, palette::of_class(detection.class.as_str()), 1)
}

/// The corners of the detected box as pixel positions (edges lie half a pixel outside pixel centres).
fn corners_px(detection: &Detection) -> [(f64, f64); 4] {
    let b = &detection.box_px;
    let [left, top, right, bottom] =
        [b.x_min, b.y_min, b.x_max, b.y_max].map(|edge| f64::from(edge) - 0.5);
    [(left, top), (right, top), (right, bottom), (left, bottom)]
}

fn label(
    canvas: &mut Canvas,
    object: &Oriented,
    track: &Track,
    colour: Colour,
) -> Result<(), DrawError> {
    let letter_px = (f64::from(canvas.size().height_px) * LETTER_SHARE).max(MIN_LETTER_PX);
    let text = format!(
        "{} {} {:.0} m",
        object.located.detection.class, track.id.0, object.located.location.range_m
    );
    let [(left, top), ..] = corners_px(&object.located.detection);
    let width = Canvas::text_width(&text, letter_px)?;
    let (bottom, pad) = ((top - 2.0).max(letter_px + 4.0), 2.0);
    let plate = [
        (left, bottom - letter_px - 2.0 * pad),
        (left + width + 2.0 * pad, bottom - letter_px - 2.0 * pad),
        (left + width + 2.0 * pad, bottom),
        (left, bottom),
    ];
    canvas.fill(&plate, palette::PAPER)?;
    canvas.text(&text, (left + pad, bottom - pad), letter_px, colour)
}
