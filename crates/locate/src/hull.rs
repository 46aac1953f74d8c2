//! Silhouettes: how large an object of a class looks, which is less than its cuboid.

use nalgebra::{Point3, Vector3};
use roadwatch_core::{
    BoxPx, CameraModel, Distortion, ObjectClass, SizeLwh,
    camera_model::Pixel,
    space::{CameraGround, Optical, Point, Transform},
};

/// Rays that return to their point within this distance on the plane z = 1 lie inside the lens
/// model's field of view; beyond it polynomials fold back and put distant points into the image.
const FOLD_TOLERANCE: f64 = 1e-6;

/// One horizontal slice of a hull: an upright octagon, given as shares of the object's size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HullLayer {
    /// Height above the ground as a share of the object's height.
    height_share: f64,
    /// Length of the slice as a share of the object's length.
    length_share: f64,
    /// Width of the slice as a share of the object's width.
    width_share: f64,
    /// How much of each corner is cut off, as a share of the slice's width; 0 is a rectangle.
    corner_share: f64,
}

const fn layer(height: f64, length: f64, width: f64, corner: f64) -> HullLayer {
    HullLayer {
        height_share: height,
        length_share: length,
        width_share: width,
        corner_share: corner,
    }
}

/// Cars. Tyres touch the ground between the overhangs (wheelbase and contact patch are about 0.62 of
/// the length), bumpers begin a hand's breadth above it, the lower body is full up to 0.6 of the height,
/// and the roof is about half as long and two thirds as wide as the body. The roof ends at 0.96 of the
/// height: measured heights include rails and aerials, which detectors' boxes leave out.
const CAR: &[HullLayer] = &[
    layer(0.0, 0.62, 0.9, 0.05),
    layer(0.15, 0.96, 0.9, 0.15),
    layer(0.35, 1.0, 1.0, 0.2),
    layer(0.6, 0.94, 0.96, 0.2),
    layer(0.9, 0.56, 0.74, 0.1),
    layer(0.96, 0.42, 0.6, 0.1),
];
/// Buses and lorries: tyres set back from the ends, then a box up to the roof.
const BOXY: &[HullLayer] = &[
    layer(0.0, 0.75, 0.92, 0.05),
    layer(0.12, 1.0, 1.0, 0.05),
    layer(1.0, 0.98, 0.96, 0.05),
];
/// Two-wheelers with a rider: long below, narrow above.
const CYCLE: &[HullLayer] = &[
    layer(0.0, 0.9, 0.2, 0.0),
    layer(0.4, 1.0, 0.6, 0.2),
    layer(0.6, 0.6, 1.0, 0.3),
    layer(1.0, 0.2, 0.3, 0.2),
];
/// People: an upright body that narrows to the head.
const UPRIGHT: &[HullLayer] = &[
    layer(0.0, 0.8, 0.6, 0.2),
    layer(0.5, 1.0, 1.0, 0.3),
    layer(0.8, 0.8, 1.0, 0.3),
    layer(1.0, 0.4, 0.35, 0.3),
];
/// Whatever nobody described: the cuboid.
const CUBOID: &[HullLayer] = &[layer(0.0, 1.0, 1.0, 0.0), layer(1.0, 1.0, 1.0, 0.0)];

/// The shape of a class of objects as a stack of slices, whose convex hull is the silhouette.
///
/// Front and back are alike: nobody knows which end of a car is the nearer one before its heading
/// is known, so headings half a turn apart cast the same silhouette.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullSpec {
    /// Lowest first, at least one.
    layers: &'static [HullLayer],
}

impl HullSpec {
    /// The hull of a class; the cuboid for a class nobody described.
    #[must_use]
    pub fn for_class(class: &ObjectClass) -> Self {
        let layers = match class.as_str() {
            "car" => CAR,
            "bus" | "truck" | "train" => BOXY,
            "bicycle" | "motorcycle" => CYCLE,
            "person" => UPRIGHT,
            _ => CUBOID,
        };
        Self { layers }
    }

    /// Distance from the centre to where the nearest point touches the ground, as a mean over all
    /// headings, metres: a rectangle `l` by `w` turned through all angles reaches `(l + w) / pi`.
    #[must_use]
    pub fn mean_contact_extent_m(&self, size: SizeLwh) -> f64 {
        let (length_m, width_m) = self.contact_m(size);
        (length_m + width_m) / std::f64::consts::PI
    }

    /// Standard deviation of that distance over all headings, metres, as if it were uniform between
    /// broadside and end-on.
    #[must_use]
    pub fn contact_extent_std_m(&self, size: SizeLwh) -> f64 {
        let (length_m, width_m) = self.contact_m(size);
        (length_m - width_m).abs() / 2.0 / 12.0_f64.sqrt()
    }

    fn contact_m(&self, size: SizeLwh) -> (f64, f64) {
        let lowest = &self.layers[0];
        (
            size.length_m * lowest.length_share,
            size.width_m * lowest.width_share,
        )
    }

    /// The hull's points about the middle of its footprint: x along the heading, y left, z up, metres.
    #[must_use]
    pub fn points(&self, size: SizeLwh) -> Vec<Vector3<f64>> {
        self.layers
            .iter()
            .flat_map(|layer| octagon(layer, size))
            .collect()
    }
}

fn octagon(layer: &HullLayer, size: SizeLwh) -> impl Iterator<Item = Vector3<f64>> + use<> {
    let x = size.length_m * layer.length_share / 2.0;
    let y = size.width_m * layer.width_share / 2.0;
    let cut = 2.0 * y * layer.corner_share;
    let z = size.height_m * layer.height_share;
    [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)]
        .into_iter()
        .flat_map(move |(sx, sy)| {
            [
                Vector3::new(sx * x, sy * (y - cut), z),
                Vector3::new(sx * (x - cut), sy * y, z),
            ]
        })
}

/// Where an object stands in camera-ground space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPose {
    /// To the right of the optical axis, metres.
    pub loc_x_m: f64,
    /// Along the horizontal projection of the optical axis, metres.
    pub loc_y_m: f64,
    /// About the vertical, counter-clockwise, zero along LocY, radians.
    pub heading_rad: f64,
}

/// A camera over its ground plane: projects silhouettes.
#[derive(Clone, Debug)]
pub struct SilhouetteCamera {
    model: CameraModel,
    optical_from_ground: Transform<Optical, CameraGround>,
}

impl SilhouetteCamera {
    /// A camera from its lens and its place over the ground.
    #[must_use]
    pub fn new(model: CameraModel, optical_from_ground: Transform<Optical, CameraGround>) -> Self {
        Self {
            model,
            optical_from_ground,
        }
    }

    /// Component of a point along the optical axis, metres.
    #[must_use]
    pub fn depth_m(&self, point: Point<CameraGround>) -> f64 {
        (self.optical_from_ground * point).z()
    }

    /// The box around the silhouette of `hull_points` (see [`HullSpec::points`]) standing at `pose`,
    /// not clipped to the image; `None` where any point is behind the lens or outside the lens
    /// model's field of view.
    #[must_use]
    pub fn silhouette_px(&self, hull_points: &[Vector3<f64>], pose: GroundPose) -> Option<BoxPx> {
        let (sin, cos) = pose.heading_rad.sin_cos();
        let (mut min, mut max) = (Pixel::repeat(f64::MAX), Pixel::repeat(f64::MIN));
        for point in hull_points {
            let pixel = self.pixel(Point::from_coords(Point3::new(
                pose.loc_y_m + cos * point.x - sin * point.y,
                -pose.loc_x_m + sin * point.x + cos * point.y,
                point.z,
            )))?;
            (min, max) = (min.inf(&pixel), max.sup(&pixel));
        }
        BoxPx::between(min, max)
    }

    fn pixel(&self, point: Point<CameraGround>) -> Option<Pixel> {
        let seen = self.optical_from_ground * point;
        let pixel = self.model.project(seen)?;
        if self.model.distortion == Distortion::None {
            return Some(pixel);
        }
        let ray = self.model.ray(pixel)?;
        let straight = Vector3::new(seen.x() / seen.z(), seen.y() / seen.z(), 1.0);
        ((ray - straight).norm() < FOLD_TOLERANCE).then_some(pixel)
    }

    /// The part of a box inside the image, and which share of its area that is.
    #[must_use]
    pub fn clip(&self, whole: BoxPx) -> Option<(BoxPx, f32)> {
        let size = self.model.size;
        let clipped = BoxPx::new(
            whole.x_min.max(0.0),
            whole.y_min.max(0.0),
            whole.x_max.min(size.width_px as f32),
            whole.y_max.min(size.height_px as f32),
        )?;
        Some((clipped, clipped.area_px2() / whole.area_px2()))
    }
}
