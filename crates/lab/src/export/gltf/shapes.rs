//! Meshes: bodies by class, box edges, heading arrows, the ground's grid. Metres, x forward, y left, z up.

use roadwatch_core::{ObjectClass, SizeLwh};
use roadwatch_locate::HullSpec;

pub(super) type Mesh = (Vec<[f32; 3]>, Vec<u16>);

/// Points of one slice of a hull.
const RING: usize = 8;

/// A class's hull about the centre of its box.
pub(super) fn body(class: &ObjectClass, size: SizeLwh) -> Mesh {
    let mut points = HullSpec::for_class(class).points(size);
    for ring in points.chunks_mut(RING) {
        ring.sort_by(|a, b| a.y.atan2(a.x).total_cmp(&b.y.atan2(b.x)));
    }
    let rings = points.len() / RING;
    let at = |ring: usize, corner: usize| (ring * RING + corner % RING) as u16;
    let mut indices = Vec::new();
    for ring in 1..rings {
        for corner in 0..RING {
            let (a, b) = (at(ring - 1, corner), at(ring - 1, corner + 1));
            let (c, d) = (at(ring, corner), at(ring, corner + 1));
            indices.extend([a, b, d, a, d, c]);
        }
    }
    for corner in 1..RING - 1 {
        indices.extend([at(0, 0), at(0, corner + 1), at(0, corner)]);
        let top = rings - 1;
        indices.extend([at(top, 0), at(top, corner), at(top, corner + 1)]);
    }
    let lowered = |point: &nalgebra::Vector3<f64>| {
        [
            point.x as f32,
            point.y as f32,
            (point.z - size.height_m / 2.0) as f32,
        ]
    };
    (points.iter().map(lowered).collect(), indices)
}

/// The edges of a box of that size about its centre, as lines.
pub(super) fn edges(size: SizeLwh) -> Mesh {
    let half = [size.length_m, size.width_m, size.height_m].map(|side| side as f32 / 2.0);
    let corner = |number: u16| -> [f32; 3] {
        std::array::from_fn(|axis| {
            if number >> axis & 1 == 1 {
                half[axis]
            } else {
                -half[axis]
            }
        })
    };
    let joined = |number: u16| {
        (0..3)
            .filter(move |axis| number >> axis & 1 == 0)
            .flat_map(move |axis| [number, number | 1 << axis])
    };
    (
        (0..8).map(corner).collect(),
        (0..8).flat_map(joined).collect(),
    )
}

/// A flat arrow from the middle of the roof to beyond the front.
pub(super) fn arrow(size: SizeLwh) -> Mesh {
    /// Half the shaft's width and half the head's, metres.
    const SHAFT_M: f32 = 0.12;
    const HEAD_M: f32 = 0.4;
    /// How far the head reaches before the front, and how long it is, metres.
    const BEYOND_M: f32 = 1.2;
    const HEAD_LENGTH_M: f32 = 0.8;
    let tip = size.length_m as f32 / 2.0 + BEYOND_M;
    let neck = tip - HEAD_LENGTH_M;
    let top = size.height_m as f32 / 2.0 + 0.1;
    let points = vec![
        [0.0, SHAFT_M, top],
        [0.0, -SHAFT_M, top],
        [neck, -SHAFT_M, top],
        [neck, SHAFT_M, top],
        [neck, -HEAD_M, top],
        [tip, 0.0, top],
        [neck, HEAD_M, top],
    ];
    (points, vec![0, 1, 2, 0, 2, 3, 4, 5, 6])
}

/// Lines every ten metres over a rectangle, at its height.
pub(super) fn grid((least, most): ([f32; 2], [f32; 2]), z_m: f32) -> Mesh {
    const STEP_M: f32 = 10.0;
    /// More lines than this show nothing more, and more points than 65536 have no index.
    const MOST_LINES: f32 = 400.0;
    let longest = (most[0] - least[0]).max(most[1] - least[1]);
    let step = STEP_M * (longest / STEP_M / MOST_LINES).ceil().max(1.0);
    let (mut points, mut indices) = (Vec::new(), Vec::new());
    let mut line = |from: [f32; 3], to: [f32; 3]| {
        let first = points.len() as u16;
        points.extend([from, to]);
        indices.extend([first, first + 1]);
    };
    let ticks = |axis: usize| {
        let first = (least[axis] / step).floor() as i32;
        let last = (most[axis] / step).ceil() as i32;
        (first..=last).map(move |tick| tick as f32 * step)
    };
    for x in ticks(0) {
        line([x, least[1], z_m], [x, most[1], z_m]);
    }
    for y in ticks(1) {
        line([least[0], y, z_m], [most[0], y, z_m]);
    }
    (points, indices)
}
