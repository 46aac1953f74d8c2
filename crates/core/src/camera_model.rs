//! Pinhole camera with lens distortion: points to pixels and pixels to rays.

use crate::{
    distortion::Distortion,
    space::{Optical, Point},
};
use nalgebra::{Vector2, Vector3};

/// Nearer than this in front of the lens nothing is in focus or in view, and projections blow up, metres.
const MIN_DEPTH_M: f64 = 0.05;

/// Width and height of an image, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageSize {
    /// Columns.
    pub width_px: u32,
    /// Rows.
    pub height_px: u32,
}

impl std::fmt::Display for ImageSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width_px, self.height_px)
    }
}

/// Focal lengths and principal point, pixels of the image size they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Horizontal focal length.
    pub fx: f64,
    /// Vertical focal length.
    pub fy: f64,
    /// Column of the principal point.
    pub cx: f64,
    /// Row of the principal point.
    pub cy: f64,
}

/// A pixel position: the centre of the top-left pixel is (0, 0) (see the crate's page).
pub type Pixel = Vector2<f64>;

/// What a camera does to rays: image size, intrinsics, distortion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraModel {
    /// The image the intrinsics belong to.
    pub size: ImageSize,
    /// Focal lengths and principal point.
    pub intrinsics: Intrinsics,
    /// The lens.
    pub distortion: Distortion,
}

impl CameraModel {
    /// The pixel a point lands on, inside the image or not; `None` behind the lens or closer than 5 cm.
    #[must_use]
    pub fn project(&self, point: Point<Optical>) -> Option<Pixel> {
        if point.z() < MIN_DEPTH_M {
            return None;
        }
        let ideal = Vector2::new(point.x() / point.z(), point.y() / point.z());
        let real = self.distortion.distort(ideal);
        let k = &self.intrinsics;
        Some(Pixel::new(k.fx * real.x + k.cx, k.fy * real.y + k.cy))
    }

    /// The ray through a pixel as the point where it meets the plane at depth 1 (not a unit vector);
    /// `None` where the lens model has no inverse.
    #[must_use]
    pub fn ray(&self, pixel: Pixel) -> Option<Vector3<f64>> {
        let k = &self.intrinsics;
        let real = Vector2::new((pixel.x - k.cx) / k.fx, (pixel.y - k.cy) / k.fy);
        let ideal = self.distortion.undistort(real)?;
        Some(Vector3::new(ideal.x, ideal.y, 1.0))
    }

    /// The same lens with its image resized to `size`.
    #[must_use]
    pub fn scaled_to(&self, size: ImageSize) -> Self {
        let sx = f64::from(size.width_px) / f64::from(self.size.width_px);
        let sy = f64::from(size.height_px) / f64::from(self.size.height_px);
        let k = &self.intrinsics;
        Self {
            size,
            intrinsics: Intrinsics {
                fx: k.fx * sx,
                fy: k.fy * sy,
                cx: (k.cx + 0.5) * sx - 0.5,
                cy: (k.cy + 0.5) * sy - 0.5,
            },
            distortion: self.distortion,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn model(distortion: Distortion) -> CameraModel {
        CameraModel {
            size: ImageSize {
                width_px: 960,
                height_px: 540,
            },
            intrinsics: Intrinsics {
                fx: 465.0,
                fy: 466.0,
                cx: 486.0,
                cy: 254.0,
            },
            distortion,
        }
    }

    fn lens() -> impl Strategy<Value = Distortion> {
        prop_oneof![
            Just(Distortion::None),
            (
                -0.3..0.1_f64,
                -0.02..0.05_f64,
                -1e-3..1e-3_f64,
                -1e-3..1e-3_f64
            )
                .prop_map(|(k1, k2, p1, p2)| Distortion::BrownConrady([
                    k1, k2, p1, p2, 0.0, 0.0, 0.0, 0.0
                ])),
            (-0.05..0.05_f64, -0.01..0.01_f64)
                .prop_map(|(k1, k2)| Distortion::Fisheye([k1, k2, 0.0, 0.0])),
        ]
    }

    proptest! {
        #[test]
        fn a_ray_goes_back_through_the_pixel_it_came_from(
            lens in lens(), x in -0.6..0.6_f64, y in -0.4..0.4_f64, depth_m in 0.1..200.0_f64,
        ) {
            let camera = model(lens);
            let pixel = camera
                .project(Point::new(x * depth_m, y * depth_m, depth_m))
                .expect("in front of the lens");
            let ray = camera.ray(pixel).expect("inside the fitted field of view");
            prop_assert!((ray.x - x).abs() < 1e-8 && (ray.y - y).abs() < 1e-8);
        }
    }

    #[test]
    fn nothing_behind_the_lens_has_a_pixel() {
        assert_eq!(
            model(Distortion::None).project(Point::new(0.0, 0.0, -3.0)),
            None
        );
    }

    #[test]
    fn scaling_moves_pixels_by_their_corners() {
        let full = model(Distortion::None);
        let half = full.scaled_to(ImageSize {
            width_px: 480,
            height_px: 270,
        });
        let point = Point::new(1.0, 0.5, 7.0);
        let (a, b) = (
            full.project(point).expect("seen"),
            half.project(point).expect("seen"),
        );
        assert!(((a.x + 0.5) * 0.5 - 0.5 - b.x).abs() < 1e-9);
        assert!(((a.y + 0.5) * 0.5 - 0.5 - b.y).abs() < 1e-9);
    }
}
