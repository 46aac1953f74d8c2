//! The 3D box of an object, and what a camera sees of its edges.

use nalgebra::{Rotation3, Vector3};
use roadwatch_core::{
    RigCamera, Track,
    space::{BaseLink, Optical, Point},
};

/// Edges are cut here in front of the lens, metres: nearer, projections run off to infinity.
const NEAR_M: f64 = 0.2;

/// Signs of length, width and height: the floor's four corners from the front left, counter-clockwise seen
/// from above, then the roof's.
const CORNERS: [[f64; 3]; 8] = [
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
];

const EDGES: [(usize, usize); 12] = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
];

/// An object's box in base_link. Where no heading is known it lies along the vehicle's own axes, as the
/// published identity quaternion says.
pub(crate) struct Cuboid {
    corners: [Vector3<f64>; 8],
}

impl Cuboid {
    pub(crate) fn of(track: &Track) -> Self {
        let size = track.size();
        let half = Vector3::new(size.length_m, size.width_m, size.height_m) / 2.0;
        let yaw_rad = track.heading().map_or(0.0, |heading| heading.yaw_rad);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        let center = track.position().coords.coords;
        Self {
            corners: CORNERS.map(|signs| center + turn * Vector3::from(signs).component_mul(&half)),
        }
    }

    /// The floor's corners, from the front left, counter-clockwise seen from above.
    pub(crate) fn footprint(&self) -> [Vector3<f64>; 4] {
        std::array::from_fn(|at| self.corners[at])
    }

    /// The edges in front of a camera, as pairs of pixel positions, inside the image or not.
    pub(crate) fn edges_px(&self, camera: &RigCamera) -> Vec<[(f64, f64); 2]> {
        let optical_from_base = camera.base_from_optical.inverse();
        let seen = self.corners.map(|corner| {
            let point: Point<BaseLink> = Point::from_coords(corner.into());
            (optical_from_base * point).coords.coords
        });
        let edges = EDGES.iter().filter_map(|&(a, b)| {
            let (a, b) = in_front(seen[a], seen[b])?;
            let pixel = |at: Vector3<f64>| {
                let point: Point<Optical> = Point::from_coords(at.into());
                camera.model.project(point).map(|pixel| (pixel.x, pixel.y))
            };
            Some([pixel(a)?, pixel(b)?])
        });
        edges.collect()
    }
}

/// The part of a segment that is in front of the lens; `None` when nothing is.
fn in_front(a: Vector3<f64>, b: Vector3<f64>) -> Option<(Vector3<f64>, Vector3<f64>)> {
    if a.z < NEAR_M && b.z < NEAR_M {
        return None;
    }
    let cut = |from: Vector3<f64>, to: Vector3<f64>| {
        if from.z >= NEAR_M {
            return from;
        }
        from + (to - from) * ((NEAR_M - from.z) / (to.z - from.z))
    };
    Some((cut(a, b), cut(b, a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_through_the_lens_is_cut_in_front_of_it() {
        let (behind, ahead) = (Vector3::new(0.0, 0.0, -1.0), Vector3::new(0.0, 0.0, 1.0));
        let (a, b) = in_front(behind, ahead).expect("half of it is seen");
        assert!((a.z - NEAR_M).abs() < 1e-12 && (b - ahead).norm() < 1e-12);
        assert_eq!(in_front(behind, behind), None);
    }
}
