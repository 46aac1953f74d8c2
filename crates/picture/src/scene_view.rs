//! The scene from above: the vehicle, what its cameras can see, every object with its uncertainty.

use crate::{
    canvas::{At, Canvas, DrawError},
    cuboid::Cuboid,
    palette,
};
use nalgebra::{SymmetricEigen, Vector2};
use roadwatch_core::{ImageSize, Rig, RigCamera, Scene, SceneObject, Track};

const SIDE_PX: u32 = 1000;
/// From the middle to each edge at least, metres: a street and its crossing.
const MIN_REACH_M: f64 = 20.0;
/// More than this is empty picture: cameras of this kind place nothing reliably there, metres.
const MAX_REACH_M: f64 = 80.0;
const MARGIN_M: f64 = 5.0;
const RING_STEP_M: f64 = 10.0;
const LETTER_PX: f64 = 12.0;
/// A middle-sized car around base_link's origin on the ground, for scale: length and width, metres.
const VEHICLE_M: (f64, f64) = (4.6, 1.85);
const ARROW_SHARE: f64 = 0.8;
const ELLIPSE_CORNERS: usize = 40;

/// Ahead is up, ten metres between two rings, around each object the ellipse of one standard deviation, behind it
/// its trail.
///
/// # Errors
/// When OpenCV refuses.
pub fn scene_view(rig: &Rig, scene: &Scene) -> Result<Canvas, DrawError> {
    let size = ImageSize {
        width_px: SIDE_PX,
        height_px: SIDE_PX,
    };
    let map = Map::around(scene);
    let mut canvas = Canvas::new(size, palette::PAPER)?;
    for camera in rig.cameras() {
        field_of_view(&mut canvas, &map, camera)?;
    }
    rings(&mut canvas, &map)?;
    vehicle(&mut canvas, &map)?;
    for object in &scene.objects {
        draw_object(&mut canvas, &map, object)?;
    }
    let title = format!(
        "scene {} at {} s, {} objects",
        scene.seq,
        scene.stamp,
        scene.objects.len()
    );
    canvas.text(&title, (10.0, 22.0), LETTER_PX, palette::TEXT)?;
    Ok(canvas)
}

/// From metres in base_link to pixels of the picture.
struct Map {
    reach_m: f64,
    px_per_m: f64,
}

impl Map {
    fn around(scene: &Scene) -> Self {
        let farthest = scene.objects.iter().map(|object| {
            let position = object.track.position();
            position.x().abs().max(position.y().abs())
        });
        let reach_m = (farthest.fold(0.0, f64::max) + MARGIN_M).clamp(MIN_REACH_M, MAX_REACH_M);
        Self {
            reach_m,
            px_per_m: f64::from(SIDE_PX) / (2.0 * reach_m),
        }
    }

    fn place(&self, base_m: Vector2<f64>) -> At {
        let middle = f64::from(SIDE_PX) / 2.0;
        (
            middle - base_m.y * self.px_per_m,
            middle - base_m.x * self.px_per_m,
        )
    }
}

/// The wedge between the rays through the image's left and right edges.
fn field_of_view(canvas: &mut Canvas, map: &Map, camera: &RigCamera) -> Result<(), DrawError> {
    let size = camera.model.size;
    let foot = camera.base_from_optical.origin();
    let foot = Vector2::new(foot.x(), foot.y());
    let edge = |x: f64| {
        let ray = camera
            .model
            .ray([x, f64::from(size.height_px) / 2.0].into())?;
        let direction = camera.base_from_optical.rotate(ray).xy();
        Some(foot + direction.normalize() * map.reach_m * 3.0)
    };
    let (Some(left), Some(right)) = (edge(-0.5), edge(f64::from(size.width_px) - 0.5)) else {
        return Ok(());
    };
    let corners = [foot, left, right].map(|corner| map.place(corner));
    canvas.tint(&corners, palette::FIELD_OF_VIEW, 0.5)
}

fn rings(canvas: &mut Canvas, map: &Map) -> Result<(), DrawError> {
    let middle = map.place(Vector2::zeros());
    let mut radius_m = RING_STEP_M;
    while radius_m < map.reach_m {
        canvas.circle(middle, radius_m * map.px_per_m, palette::GRID)?;
        let at = (middle.0 + 4.0, middle.1 - radius_m * map.px_per_m - 4.0);
        canvas.text(
            &format!("{radius_m:.0} m"),
            at,
            LETTER_PX,
            palette::FAINT_TEXT,
        )?;
        radius_m += RING_STEP_M;
    }
    Ok(())
}

fn vehicle(canvas: &mut Canvas, map: &Map) -> Result<(), DrawError> {
    let (length, width) = VEHICLE_M;
    let corner = |x: f64, y: f64| map.place(Vector2::new(x * length, y * width));
    let body = [
        corner(0.5, 0.0),
        corner(0.3, 0.5),
        corner(-0.5, 0.5),
        corner(-0.5, -0.5),
        corner(0.3, -0.5),
    ];
    canvas.fill(&body, palette::VEHICLE)
}

fn draw_object(canvas: &mut Canvas, map: &Map, object: &SceneObject) -> Result<(), DrawError> {
    let track = &object.track;
    let colour = palette::of_identity(track.id);
    let footprint = Cuboid::of(track)
        .footprint()
        .map(|corner| map.place(corner.xy()));
    let center = track.position().coords.coords.xy();
    let trail: Vec<At> = object
        .trail
        .iter()
        .map(|p| map.place(p.coords.coords.xy()))
        .collect();
    for step in trail.windows(2) {
        canvas.line(step[0], step[1], colour, 1)?;
    }
    canvas.tint(&footprint, colour, 0.6)?;
    canvas.outline(&footprint, colour, 1)?;
    canvas.outline(&ellipse(map, track), colour, 1)?;
    if let Some(heading) = track.heading() {
        let (sin, cos) = heading.yaw_rad.sin_cos();
        let tip = center + Vector2::new(cos, sin) * track.size().length_m * ARROW_SHARE;
        canvas.line(map.place(center), map.place(tip), colour, 2)?;
    }
    let (x, y) = map.place(center);
    let text = format!("{} {}", track.class(), track.id.0);
    canvas.text(&text, (x + 10.0, y - 6.0), LETTER_PX, colour)
}

/// One standard deviation of the position on the ground.
fn ellipse(map: &Map, track: &Track) -> Vec<At> {
    let center = track.position().coords.coords.xy();
    let covariance = track.covariance().matrix;
    let eigen = SymmetricEigen::new(covariance.fixed_view::<2, 2>(0, 0).into_owned());
    let axes = eigen.eigenvectors
        * nalgebra::Matrix2::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0).sqrt()));
    (0..ELLIPSE_CORNERS)
        .map(|at| {
            let (sin, cos) = (std::f64::consts::TAU * at as f64 / ELLIPSE_CORNERS as f64).sin_cos();
            map.place(center + axes * Vector2::new(cos, sin))
        })
        .collect()
}
