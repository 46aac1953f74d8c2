//! What a calibration found, over an image: so that an eye can say whether it is so.

use crate::{
    canvas::{At, Canvas, DrawError},
    palette::{self, Colour},
};
use nalgebra::Vector3;
use roadwatch_core::{
    BoxPx, ImageSize, Pixels, RigCamera,
    camera_model::Pixel,
    space::{BaseLink, Point},
};
use std::f64::consts::TAU;

/// Lines on the ground are this far apart, metres.
const GRID_M: i32 = 5;
/// The ground is drawn up to here, metres.
const GRID_END_M: i32 = 60;
/// Lines are drawn in pieces of this length, for lenses bend them, metres.
const PIECE_M: f64 = 0.5;
/// Pieces of the horizon around the camera.
const HORIZON_PIECES: u32 = 1440;
/// Share of the image's height that letters take.
const LETTER_SHARE: f64 = 14.0 / 540.0;
const BEFORE: &str = "before";
const AFTER: &str = "after";
/// How many times a residual is drawn, so that fractions of a pixel are seen.
const RESIDUAL_SCALE: f64 = 50.0;

/// Where a mark is seen, and where the calibration puts it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenAndPut {
    /// Where it is seen.
    pub seen: Pixel,
    /// Where it should be.
    pub put: Pixel,
}

/// What a mount was found from.
#[derive(Clone, Debug, Default)]
pub struct MountEvidence {
    /// Points of known place.
    pub points: Vec<SeenAndPut>,
    /// Lines along the vehicle.
    pub segments: Vec<[Pixel; 2]>,
    /// Boxes of objects.
    pub boxes: Vec<BoxPx>,
}

/// The horizon and a 5 m grid on the ground, drawn over the image: above by the mount as it was, below by the
/// mount that was found.
///
/// # Errors
/// When OpenCV refuses.
pub fn mount_view(
    image: &Pixels,
    [before, after]: [&RigCamera; 2],
    ground_z_m: f64,
    evidence: &MountEvidence,
) -> Result<Canvas, DrawError> {
    let size = image.size();
    let both = ImageSize {
        height_px: size.height_px * 2,
        ..size
    };
    let mut sheet = Canvas::new(both, palette::PAPER)?;
    for (row, camera, title) in [(0, before, BEFORE), (1, after, AFTER)] {
        let mut view = Canvas::of_image(image)?;
        draw_ground(&mut view, camera, ground_z_m)?;
        draw_horizon(&mut view, camera)?;
        draw_evidence(&mut view, evidence)?;
        if title == AFTER {
            draw_put(&mut view, evidence)?;
        }
        let text = format!("{title}: horizon, and the ground every {GRID_M} m");
        caption(&mut view, &text)?;
        sheet.paste(&view, (0, row * size.height_px as i32), size)?;
    }
    Ok(sheet)
}

/// A known object's box with the numbers of eq. 1.
///
/// # Errors
/// When OpenCV refuses.
pub fn focal_view(image: &Pixels, box_px: &BoxPx, text: &str) -> Result<Canvas, DrawError> {
    let mut view = Canvas::of_image(image)?;
    outline(&mut view, box_px, palette::MARK)?;
    let middle = box_px.bottom_center().x;
    let (top, bottom) = (f64::from(box_px.y_min) - 0.5, f64::from(box_px.y_max) - 0.5);
    view.line((middle, top), (middle, bottom), palette::MARK, 1)?;
    caption(&mut view, text)?;
    Ok(view)
}

/// Every corner of every picture that a camera was calibrated from, and how far it is from where the
/// calibration puts it, fifty times enlarged, over one of the pictures.
///
/// # Errors
/// When OpenCV refuses.
pub fn corners_view(
    image: &Pixels,
    corners: &[SeenAndPut],
    text: &str,
) -> Result<Canvas, DrawError> {
    let mut view = Canvas::of_image(image)?;
    for corner in corners {
        let tip = corner.seen + (corner.put - corner.seen) * RESIDUAL_SCALE;
        view.circle(at(corner.seen), 2.0, palette::of_class("car"))?;
        view.line(at(corner.seen), at(tip), palette::MARK, 1)?;
    }
    caption(
        &mut view,
        &format!("{text}; residuals {RESIDUAL_SCALE:.0} times enlarged"),
    )?;
    Ok(view)
}

fn draw_ground(view: &mut Canvas, camera: &RigCamera, ground_z_m: f64) -> Result<(), DrawError> {
    let foot = camera.base_from_optical.origin();
    let colour = palette::of_class("car");
    let pieces = (f64::from(2 * GRID_END_M) / PIECE_M) as i32;
    for line in -(GRID_END_M / GRID_M)..=(GRID_END_M / GRID_M) {
        let across = f64::from(line * GRID_M);
        for along_x in [true, false] {
            let place = |step: i32| {
                let along = f64::from(step) * PIECE_M - f64::from(GRID_END_M);
                let (x, y) = if along_x {
                    (along, across)
                } else {
                    (across, along)
                };
                Point::new(foot.x() + x, foot.y() + y, ground_z_m)
            };
            for step in 0..pieces {
                draw_piece(view, camera, [place(step), place(step + 1)], colour)?;
            }
        }
    }
    Ok(())
}

fn draw_horizon(view: &mut Canvas, camera: &RigCamera) -> Result<(), DrawError> {
    /// So far away that the camera's place does not matter, metres.
    const FAR_M: f64 = 1e6;
    let place = |step: u32| {
        let azimuth = TAU * f64::from(step) / f64::from(HORIZON_PIECES);
        let away = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0) * FAR_M;
        Point::from_coords(camera.base_from_optical.origin().coords + away)
    };
    for step in 0..HORIZON_PIECES {
        draw_piece(view, camera, [place(step), place(step + 1)], palette::MARK)?;
    }
    Ok(())
}

/// A short straight piece, where all of it is in the image or nearly.
fn draw_piece(
    view: &mut Canvas,
    camera: &RigCamera,
    ends: [Point<BaseLink>; 2],
    colour: Colour,
) -> Result<(), DrawError> {
    let optical_from_base = camera.base_from_optical.inverse();
    let (width, height) = (
        f64::from(view.size().width_px),
        f64::from(view.size().height_px),
    );
    let seen = ends.map(|end| {
        let pixel = camera.model.project(optical_from_base * end)?;
        let near =
            (-width..2.0 * width).contains(&pixel.x) && (-height..2.0 * height).contains(&pixel.y);
        near.then_some(pixel)
    });
    match seen {
        [Some(a), Some(b)] => view.line(at(a), at(b), colour, 1),
        _ => Ok(()),
    }
}

fn draw_evidence(view: &mut Canvas, evidence: &MountEvidence) -> Result<(), DrawError> {
    for point in &evidence.points {
        view.circle(at(point.seen), 5.0, palette::of_class("bus"))?;
    }
    for &[a, b] in &evidence.segments {
        view.line(at(a), at(b), palette::of_class("bus"), 2)?;
    }
    for box_px in &evidence.boxes {
        outline(view, box_px, palette::of_class("bus"))?;
    }
    Ok(())
}

/// Where the mount that was found puts the points.
fn draw_put(view: &mut Canvas, evidence: &MountEvidence) -> Result<(), DrawError> {
    for point in &evidence.points {
        view.line(at(point.seen), at(point.put), palette::MARK, 2)?;
        view.circle(at(point.put), 2.0, palette::MARK)?;
    }
    Ok(())
}

fn outline(view: &mut Canvas, b: &BoxPx, colour: Colour) -> Result<(), DrawError> {
    let [left, top, right, bottom] =
        [b.x_min, b.y_min, b.x_max, b.y_max].map(|edge| f64::from(edge) - 0.5);
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
    view.outline(&corners, colour, 1)
}

fn caption(view: &mut Canvas, text: &str) -> Result<(), DrawError> {
    let letter_px = f64::from(view.size().height_px) * LETTER_SHARE;
    let (width, pad) = (Canvas::text_width(text, letter_px)?, letter_px / 2.0);
    let (right, bottom) = (width + 2.0 * pad, letter_px + 2.0 * pad);
    view.fill(
        &[(0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom)],
        palette::PAPER,
    )?;
    view.text(text, (pad, pad + letter_px), letter_px, palette::TEXT)
}

fn at(pixel: Pixel) -> At {
    (pixel.x, pixel.y)
}
