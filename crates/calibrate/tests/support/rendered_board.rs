//! Pictures of a board as a camera of known lens sees them: every pixel's ray is followed to the board.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use roadwatch_core::{CameraModel, Pixels, camera_model::Pixel};

/// Rays per pixel and side, so that edges are as soft as a sensor's.
const SAMPLES: u32 = 4;
const BACKGROUND: f64 = 110.0;

/// Brightness, 0 to 255, at a place on the board, metres; `None` beside it.
pub(crate) type Texture<'a> = &'a dyn Fn(f64, f64) -> Option<f64>;

/// A chessboard of `columns` x `rows` inner corners with a white margin; the first corner is at (0, 0).
pub(crate) fn chessboard(
    columns: i32,
    rows: i32,
    square_m: f64,
) -> impl Fn(f64, f64) -> Option<f64> {
    move |x_m, y_m| {
        let (x, y) = (
            (x_m / square_m).floor() as i32,
            (y_m / square_m).floor() as i32,
        );
        let is_square = (-1..columns).contains(&x) && (-1..rows).contains(&y);
        let is_margin = (-2..=columns).contains(&x) && (-2..=rows).contains(&y);
        match (is_square, is_margin) {
            (true, _) if (x + y).rem_euclid(2) == 0 => Some(25.0),
            (true, _) | (_, true) => Some(230.0),
            _ => None,
        }
    }
}

/// Poses that show a board of `width_m` x `height_m` in all parts of the image, tilted both ways.
pub(crate) fn poses(camera: &CameraModel, (width_m, height_m): (f64, f64)) -> Vec<Isometry3<f64>> {
    let k = &camera.intrinsics;
    let half = f64::from(camera.size.width_px) / 2.0 / k.fx;
    let tall = f64::from(camera.size.height_px) / 2.0 / k.fy;
    let places = [
        (0.0, 0.0, 1.0),
        (-0.38, -0.28, 1.25),
        (0.38, -0.28, 1.25),
        (-0.38, 0.28, 1.25),
        (0.38, 0.28, 1.25),
        (0.0, -0.4, 1.5),
        (0.0, 0.4, 1.5),
        (-0.5, 0.0, 1.5),
        (0.5, 0.0, 1.5),
        (-0.6, -0.5, 1.9),
        (0.6, 0.5, 1.9),
        (0.6, -0.5, 1.9),
        (-0.6, 0.5, 1.9),
        (0.1, 0.1, 2.2),
    ];
    let middle = Vector3::new(width_m / 2.0, height_m / 2.0, 0.0);
    let nearest = width_m / half * 1.1;
    places
        .iter()
        .enumerate()
        .map(|(at, &(across, down, times))| {
            let turn = at as f64;
            let tilt = UnitQuaternion::from_euler_angles(
                0.45 * (turn * 1.7).sin(),
                0.45 * (turn * 2.3 + 0.5).cos(),
                0.2 * (turn * 0.9).sin(),
            );
            let depth = nearest * times;
            let center = Vector3::new(across * half * depth, down * tall * depth, depth);
            Isometry3::from_parts(Translation3::from(center - tilt * middle), tilt)
        })
        .collect()
}

/// What the camera sees of a board at a pose.
pub(crate) fn render(
    camera: &CameraModel,
    optical_from_board: &Isometry3<f64>,
    texture: Texture<'_>,
) -> Pixels {
    let size = camera.size;
    let board_from_optical = optical_from_board.inverse();
    let origin = board_from_optical * Point3::origin();
    // Lenses are smooth, so rays inside a pixel lie evenly between those of its corners.
    let corners_of_row = |row: u32| -> Vec<Vector3<f64>> {
        let corner = |column: u32| Pixel::new(f64::from(column) - 0.5, f64::from(row) - 0.5);
        let rays = (0..=size.width_px).map(|column| camera.ray(corner(column)));
        rays.map(|ray| board_from_optical.rotation * ray.expect("inside the lens model"))
            .collect()
    };
    let brightness = |ray: Vector3<f64>| {
        let reach = -origin.z / ray.z;
        let place = origin + ray * reach;
        if reach > 0.0 {
            texture(place.x, place.y)
        } else {
            None
        }
    };
    let share = |step: u32| (f64::from(step) + 0.5) / f64::from(SAMPLES);
    let mut bgr = Vec::new();
    let mut below = corners_of_row(0);
    for row in 0..size.height_px {
        let above = std::mem::replace(&mut below, corners_of_row(row + 1));
        for column in 0..size.width_px as usize {
            let samples = (0..SAMPLES * SAMPLES).map(|sample| {
                let (right, down) = (share(sample % SAMPLES), share(sample / SAMPLES));
                let upper = above[column].lerp(&above[column + 1], right);
                let lower = below[column].lerp(&below[column + 1], right);
                brightness(upper.lerp(&lower, down)).unwrap_or(BACKGROUND)
            });
            let mean = samples.sum::<f64>() / f64::from(SAMPLES * SAMPLES);
            bgr.extend([mean.round() as u8; 3]);
        }
    }
    Pixels::new(size, bgr).expect("a picture")
}
