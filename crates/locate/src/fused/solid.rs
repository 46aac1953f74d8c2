//! The object's hull as the four edges of its box see it, with slopes.

use super::edges::{EDGES, Edges};
use crate::hull::HullSpec;
use multiversion::multiversion;
use nalgebra::{Matrix3, RowVector3, Vector3};
use roadwatch_core::SizeLwh;

/// Nearer to the camera than this, along the optical axis, a point has no place in the image, metres.
const NEAREST_DEPTH_M: f32 = 0.3;
/// Bits that hold a point's number: more than any hull has, and few enough for a hundredth of a pixel.
const NUMBER: i32 = 63;
/// Of a hull.
pub(super) const MOST_POINTS: usize = NUMBER as usize + 1;

/// Length, width, height and heading: what the hull's points depend on beside the object's place.
const SHAPE_CAUSES: usize = 4;

/// A class's hull at its expected size, about the middle of its footprint.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// x along the heading, y left, z up, metres.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    size: SizeLwh,
}

/// A hull turned into a heading and into the camera's axes: what is left is to put it somewhere.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    /// Of each point, from the footprint's middle, in optical axes, metres.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

/// What the camera sees of a solid at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outline {
    /// Left, top, right, bottom on the plane at depth 1.
    pub(super) edges: Edges,
    /// Where the hull touches each edge.
    pub(super) touches: [Touch; EDGES],
    /// Slope of each edge by the place of the point on it, in base_link.
    pub(super) slopes: [RowVector3<f64>; EDGES],
}

/// A point on the line from one point of the hull to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) from: usize,
    pub(super) to: usize,
    /// 0 at the first, 1 at the other.
    pub(super) share: f64,
}

impl Touch {
    /// One of the hull's points.
    pub(super) fn at(point: usize) -> Self {
        Self {
            from: point,
            to: point,
            share: 0.0,
        }
    }

    fn of(self, coordinate: &[f64]) -> f64 {
        let from = coordinate[self.from];
        from + (coordinate[self.to] - from) * self.share
    }
}

impl Solid {
    pub(super) fn new(spec: &HullSpec, size: SizeLwh) -> Self {
        let points = spec.points(size);
        debug_assert!(points.len() <= MOST_POINTS, "{} points", points.len());
        Self {
            x: points.iter().map(|point| point.x).collect(),
            y: points.iter().map(|point| point.y).collect(),
            z: points.iter().map(|point| point.z).collect(),
            size,
        }
    }

    /// Turns the hull by `yaw_rad` in base_link, for a camera of those axes.
    pub(super) fn turn(&self, (sin, cos): (f64, f64), optical_from_base: &Matrix3<f64>) -> Turned {
        let ahead = optical_from_base * Vector3::new(cos, sin, 0.0);
        let left = optical_from_base * Vector3::new(-sin, cos, 0.0);
        let up = optical_from_base.column(2);
        let axes = Matrix3::from_columns(&[ahead, left, up.into_owned()]);
        let points = self.x.iter().zip(&self.y).zip(&self.z);
        let points = points.map(|((&x, &y), &z)| axes * Vector3::new(x, y, z));
        let coordinate = |axis: usize| points.clone().map(|point| point[axis] as f32).collect();
        Turned {
            x: coordinate(0),
            y: coordinate(1),
            z: coordinate(2),
        }
    }

    /// How the outline's edges change, each a column: by one standard deviation of length, of width and of
    /// height, and by a radian of heading.
    #[inline(always)]
    pub(super) fn shape_slopes(
        &self,
        outline: &Outline,
        (sin, cos): (f64, f64),
        std_dev: SizeLwh,
    ) -> [Edges; SHAPE_CAUSES] {
        let (length, width, height) = (
            std_dev.length_m / self.size.length_m,
            std_dev.width_m / self.size.width_m,
            std_dev.height_m / self.size.height_m,
        );
        let of_edge = |edge: usize| {
            let touch = outline.touches[edge];
            let [x, y, z] = [&self.x, &self.y, &self.z].map(|one| touch.of(one));
            let by = &outline.slopes[edge];
            let ahead = by.x * cos + by.y * sin;
            let left = by.y * cos - by.x * sin;
            // The corners' cuts go with the width (see `HullSpec::points`), which moves x a little too; what
            // that makes is far below the spread of a length.
            [
                ahead * x * length,
                left * y * width,
                by.z * z * height,
                left * x - ahead * y,
            ]
        };
        let by_edge: [_; EDGES] = std::array::from_fn(of_edge);
        std::array::from_fn(|cause| Edges::from(by_edge.map(|causes| causes[cause])))
    }
}

impl Turned {
    /// The points, from the footprint's middle.
    pub(super) fn points(&self) -> impl Iterator<Item = Vector3<f64>> {
        let points = self.x.iter().zip(&self.y).zip(&self.z);
        points.map(|((&x, &y), &z)| Vector3::new(x, y, z).cast())
    }

    /// The outline of the hull with its footprint's middle at `middle` in optical axes; `None` where part of
    /// it is behind the camera.
    #[inline(always)]
    pub(super) fn outline(
        &self,
        middle: &Vector3<f64>,
        optical_from_base: &Matrix3<f64>,
    ) -> Option<Outline> {
        let (bounds, points) = extremes(self, middle)?;
        let slope = |edge: usize| {
            let depth_m = f64::from(self.z[points[edge]]) + middle.z;
            let across = optical_from_base.row(edge % 2);
            (across - optical_from_base.row(2) * f64::from(bounds[edge])) / depth_m
        };
        Some(Outline {
            edges: Edges::from(bounds.map(f64::from)),
            touches: points.map(Touch::at),
            slopes: std::array::from_fn(slope),
        })
    }
}

/// Left, top, right and bottom of the points moved by `middle`, and which point is there; `None` where one is
/// too near.
///
/// Least and greatest are sought among integers that order as the floats do and carry the point's number in
/// their last bits: those of floats alone do not run in lanes, for the sake of not-a-numbers.
#[multiversion(targets("x86_64+avx2+fma"))]
fn extremes(turned: &Turned, middle: &Vector3<f64>) -> Option<([f32; EDGES], [usize; EDGES])> {
    let [right, down, away] = [middle.x as f32, middle.y as f32, middle.z as f32];
    let count = turned.x.len();
    let (xs, ys, zs) = (&turned.x[..count], &turned.y[..count], &turned.z[..count]);
    let (mut left_most, mut right_most) = (i32::MAX, i32::MIN);
    let (mut top_most, mut bottom_most) = (i32::MAX, i32::MIN);
    let mut nearest = i32::MAX;
    for number in 0..count {
        let depth_m = zs[number] + away;
        let inverse = 1.0 / depth_m;
        let u = ordered((xs[number] + right) * inverse, number as i32);
        let v = ordered((ys[number] + down) * inverse, number as i32);
        left_most = left_most.min(u);
        right_most = right_most.max(u);
        top_most = top_most.min(v);
        bottom_most = bottom_most.max(v);
        nearest = nearest.min(depth_m.to_bits().cast_signed());
    }
    if nearest < NEAREST_DEPTH_M.to_bits().cast_signed() {
        return None;
    }
    let points = [left_most, top_most, right_most, bottom_most].map(|key| (key & NUMBER) as usize);
    let position = |edge: usize| {
        let at = points[edge];
        let across = if edge.is_multiple_of(2) {
            xs[at] + right
        } else {
            ys[at] + down
        };
        across / (zs[at] + away)
    };
    Some((std::array::from_fn(position), points))
}

/// An integer that orders as `value` does, but for its last bits, which are `number`.
#[inline(always)]
fn ordered(value: f32, number: i32) -> i32 {
    let bits = value.to_bits().cast_signed();
    // Negative floats order the other way round.
    let ascending = bits ^ ((bits >> 31) & i32::MAX);
    (ascending & !NUMBER) | number
}
