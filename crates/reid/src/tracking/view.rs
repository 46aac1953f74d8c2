//! What a camera would see of a tracked object.

use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use roadwatch_core::{
    BoxPx, CameraId, Ego, Located, RigCamera, SizeLwh, Timestamp, camera_model::Pixel, space::Point,
};
use std::time::Duration;

/// Boxes change little in this time: a later one is drawn from the object's size instead.
const RECENT: Duration = Duration::from_millis(600);
/// Nearer than this to the image's plane, nothing is drawn, metres.
const NEAREST_M: f64 = 0.5;
/// A box outside its image by more than this share is no longer expected to be seen.
const MOST_OUTSIDE: f32 = 0.4;
/// Detectors miss what is smaller, pixels high.
const LEAST_HEIGHT_PX: f32 = 14.0;

/// A box that comes this near to the image's edge is cut off by it, pixels.
const EDGE_PX: f32 = 4.0;
/// Variance of a place by a box that one edge cuts off, against what its locator says …
const CUT_ONCE: f64 = 2.5;
/// … by one that a side cuts down to less than the object is wide: what is seen is a bonnet, not as high as its roof …
const CUT_NARROW: f64 = 6.0;
/// … and by one that two cut off, a side and the bottom: little is left of the object.
const CUT_TWICE: f64 = 14.0;

/// A camera at the moment of a capture.
pub(super) struct View<'a> {
    pub(super) camera: CameraId,
    pub(super) at: Timestamp,
    rig_camera: &'a RigCamera,
    optical_from_steady: Isometry3<f64>,
    /// Above the ground, in the steady frame.
    pub(super) eye: Vector2<f64>,
}

/// How a camera saw an object last.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Glimpse {
    pub(super) camera: CameraId,
    pub(super) at: Timestamp,
    pub(super) box_px: BoxPx,
    /// Where its believed centre was in the image, and how far along the optical axis.
    center: Option<(Pixel, f64)>,
}

/// A box that is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expected {
    pub(super) box_px: BoxPx,
    /// Along the optical axis, metres.
    pub(super) depth_m: f64,
    /// Whether a detector should find it, if nothing hides it.
    pub(super) in_view: bool,
}

/// A box in space, in the steady frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub(super) center: Point3<f64>,
    pub(super) size: SizeLwh,
    pub(super) heading_rad: Option<f64>,
}

impl<'a> View<'a> {
    pub(super) fn new(
        camera: CameraId,
        at: Timestamp,
        rig_camera: &'a RigCamera,
        ego: &Ego,
    ) -> Self {
        let steady_from_optical = ego.steady_from_base * rig_camera.base_from_optical;
        Self {
            camera,
            at,
            rig_camera,
            optical_from_steady: steady_from_optical.isometry.inverse(),
            eye: steady_from_optical.isometry.translation.vector.xy(),
        }
    }

    /// How much more the variance of a place or a heading is than its box alone says: what the image's edges cut off says
    /// nothing.
    pub(super) fn doubt(&self, located: &Located) -> f64 {
        let (box_px, whole) = (&located.detection.box_px, located.location.size);
        let size = self.rig_camera.model.size;
        let (width, height) = (size.width_px as f32, size.height_px as f32);
        let side = box_px.x_min < EDGE_PX || box_px.x_max > width - EDGE_PX;
        let below = box_px.y_max > height - EDGE_PX;
        let shape = f64::from(box_px.width_px() / box_px.height_px());
        let narrow = shape < whole.width_m / whole.height_m;
        match (side, below) {
            (false, false) => 1.0,
            (true, true) => CUT_TWICE,
            (true, false) if narrow => CUT_NARROW,
            _ => CUT_ONCE,
        }
    }

    /// Keeps how an object was seen.
    pub(super) fn glimpse(&self, box_px: BoxPx, center: &Point3<f64>) -> Glimpse {
        Glimpse {
            camera: self.camera,
            at: self.at,
            box_px,
            center: self.center(center),
        }
    }

    /// The box of an object in this image; `None` where the camera does not look.
    pub(super) fn expect(&self, solid: &Solid, glimpses: &[Glimpse]) -> Option<Expected> {
        let (center, depth_m) = self.center(&solid.center)?;
        let recent = glimpses.iter().find(|glimpse| {
            glimpse.camera == self.camera && self.at.saturating_since(glimpse.at) <= RECENT
        });
        let whole = recent
            .and_then(|glimpse| glimpse.moved_to(center, depth_m))
            .or_else(|| self.drawn(solid))?;
        self.within_image(whole, depth_m)
    }

    fn center(&self, center: &Point3<f64>) -> Option<(Pixel, f64)> {
        let optical = self.optical_from_steady * center;
        if optical.z < NEAREST_M {
            return None;
        }
        // A lens model says nothing of rays far outside the image.
        let half = Vector2::new(
            f64::from(self.rig_camera.model.size.width_px),
            f64::from(self.rig_camera.model.size.height_px),
        );
        let k = &self.rig_camera.model.intrinsics;
        let reach = Vector2::new(half.x / k.fx, half.y / k.fy);
        if optical.x.abs() > reach.x * optical.z || optical.y.abs() > reach.y * optical.z {
            return None;
        }
        let pixel = self.rig_camera.model.project(Point::from_coords(optical))?;
        Some((pixel, optical.z))
    }

    /// Around the corners of the object's box.
    fn drawn(&self, solid: &Solid) -> Option<BoxPx> {
        let SizeLwh {
            length_m,
            width_m,
            height_m,
        } = solid.size;
        // Of unknown heading, something between its length and its width.
        let (length_m, width_m, heading_rad) = match solid.heading_rad {
            Some(heading_rad) => (length_m, width_m, heading_rad),
            None => (length_m.midpoint(width_m), length_m.midpoint(width_m), 0.0),
        };
        let (sin, cos) = heading_rad.sin_cos();
        let (mut least, mut most) = (
            Pixel::repeat(f64::INFINITY),
            Pixel::repeat(f64::NEG_INFINITY),
        );
        for corner in 0..8_u8 {
            let side = |bit: u8| if corner >> bit & 1 == 1 { 0.5 } else { -0.5 };
            let (along, across) = (side(0) * length_m, side(1) * width_m);
            let offset = Vector3::new(
                along * cos - across * sin,
                along * sin + across * cos,
                side(2) * height_m,
            );
            let mut optical = self.optical_from_steady * (solid.center + offset);
            optical.z = optical.z.max(NEAREST_M);
            let pixel = self.rig_camera.model.project(Point::from_coords(optical))?;
            least = least.inf(&pixel);
            most = most.sup(&pixel);
        }
        BoxPx::between(least, most)
    }

    fn within_image(&self, whole: BoxPx, depth_m: f64) -> Option<Expected> {
        let size = self.rig_camera.model.size;
        let (width, height) = (size.width_px as f32, size.height_px as f32);
        let box_px = BoxPx::new(
            whole.x_min.max(0.0),
            whole.y_min.max(0.0),
            whole.x_max.min(width),
            whole.y_max.min(height),
        )?;
        let outside = 1.0 - box_px.area_px2() / whole.area_px2();
        Some(Expected {
            box_px,
            depth_m,
            in_view: outside <= MOST_OUTSIDE && box_px.height_px() >= LEAST_HEIGHT_PX,
        })
    }
}

impl Glimpse {
    /// The same box, moved and scaled as the object's centre has moved since.
    fn moved_to(&self, center: Pixel, depth_m: f64) -> Option<BoxPx> {
        let (before, depth_before_m) = self.center?;
        let scale = depth_before_m / depth_m;
        let corner = |x: f32, y: f32| {
            let from_center = Pixel::new(f64::from(x), f64::from(y)) - before;
            center + from_center * scale
        };
        let (least, most) = (
            corner(self.box_px.x_min, self.box_px.y_min),
            corner(self.box_px.x_max, self.box_px.y_max),
        );
        BoxPx::new(least.x as f32, least.y as f32, most.x as f32, most.y as f32)
    }
}
