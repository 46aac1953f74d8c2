//! All views of a rig on one sheet, as they lie around the vehicle.

use crate::{
    canvas::{Canvas, DrawError},
    palette,
};
use nalgebra::Vector3;
use roadwatch_core::{ImageSize, Rig, RigCamera};
use std::f64::consts::TAU;

/// Width of one view on the sheet, pixels: three beside each other fill a full-HD screen.
const VIEW_WIDTH_PX: u32 = 640;
const GAP_PX: u32 = 6;
const CAPTION_HEIGHT_PX: u32 = 22;
const LETTER_PX: f64 = 12.0;

/// Views of the front half in the upper row from left to right, those of the rear half below, as one sees them
/// standing behind the vehicle with the left side on the left. `None` leaves a view empty.
///
/// # Errors
/// When OpenCV refuses.
pub fn contact_sheet(rig: &Rig, views: &[Option<Canvas>]) -> Result<Canvas, DrawError> {
    let rows = rows(rig);
    let columns = rows.iter().map(Vec::len).max().unwrap_or(1) as u32;
    let row_height_px =
        rig.cameras().iter().map(view_height_px).max().unwrap_or(1) + CAPTION_HEIGHT_PX;
    let rows_used: Vec<_> = rows.iter().filter(|row| !row.is_empty()).collect();
    let size = ImageSize {
        width_px: columns * (VIEW_WIDTH_PX + GAP_PX) + GAP_PX,
        height_px: rows_used.len() as u32 * (row_height_px + GAP_PX) + GAP_PX,
    };
    let mut sheet = Canvas::new(size, palette::PAPER)?;
    for (row, cameras) in (0_u32..).zip(rows_used) {
        for (column, &at) in (0_u32..).zip(cameras) {
            let left = (GAP_PX + column * (VIEW_WIDTH_PX + GAP_PX)) as i32;
            let top = (GAP_PX + row * (row_height_px + GAP_PX)) as i32;
            let camera = &rig.cameras()[at];
            caption(&mut sheet, camera, (left, top))?;
            if let Some(view) = &views[at] {
                let size = ImageSize {
                    width_px: VIEW_WIDTH_PX,
                    height_px: view_height_px(camera),
                };
                sheet.paste(view, (left, top + CAPTION_HEIGHT_PX as i32), size)?;
            }
        }
    }
    Ok(sheet)
}

fn caption(
    sheet: &mut Canvas,
    camera: &RigCamera,
    (left, top): (i32, i32),
) -> Result<(), DrawError> {
    let at = (f64::from(left) + 2.0, f64::from(top) + LETTER_PX + 3.0);
    sheet.text(camera.name.as_str(), at, LETTER_PX, palette::TEXT)
}

fn view_height_px(camera: &RigCamera) -> u32 {
    let size = camera.model.size;
    (VIEW_WIDTH_PX * size.height_px).div_ceil(size.width_px)
}

/// Which way a camera looks, counter-clockwise from ahead, 0 to 2 pi.
fn azimuth_rad(camera: &RigCamera) -> f64 {
    let axis = camera.base_from_optical.rotate(Vector3::z());
    axis.y.atan2(axis.x).rem_euclid(TAU)
}

/// Indices of the cameras of the two rows.
fn rows(rig: &Rig) -> [Vec<usize>; 2] {
    let azimuth = |&at: &usize| azimuth_rad(&rig.cameras()[at]);
    // From straight ahead, 0 to pi on either side.
    let aside = |at: &usize| azimuth(at).min(TAU - azimuth(at));
    let mut all: Vec<usize> = (0..rig.cameras().len()).collect();
    all.sort_by(|a, b| aside(a).total_cmp(&aside(b)));
    let mut rear = all.split_off(all.len().div_ceil(2));
    let from_left = |at: &usize| (azimuth(at) + TAU / 2.0).rem_euclid(TAU);
    all.sort_by(|a, b| from_left(b).total_cmp(&from_left(a)));
    rear.sort_by(|a, b| azimuth(a).total_cmp(&azimuth(b)));
    [all, rear]
}
