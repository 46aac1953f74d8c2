//! A box as the fit sees it: four edges on the plane at depth 1, each with its noise, some of them cut.

use crate::box_noise::BoxNoise;
use nalgebra::Vector4;
use roadwatch_core::{BoxPx, CameraModel, camera_model::Pixel};

/// Left, top, right, bottom.
pub(super) const EDGES: usize = 4;
pub(super) const LEFT: usize = 0;
pub(super) const TOP: usize = 1;
pub(super) const RIGHT: usize = 2;
pub(super) const BOTTOM: usize = 3;

/// A value per edge: left, top, right, bottom.
pub(super) type Edges = Vector4<f64>;

/// An edge this close to the image's border is the border's, not the object's, pixels: networks round their
/// boxes, and clip them a pixel or so before the border.
const BORDER_PX: f32 = 2.0;

/// Of an edge that nobody saw, on the plane at depth 1: wider than any lens.
const UNKNOWN_STD: f64 = 10.0;

/// What was measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenBox {
    /// Positions on the plane at depth 1, lens distortion undone.
    pub(super) edges: Edges,
    /// Standard deviations, in the same unit.
    pub(super) std_devs: Edges,
    /// Edges that the image's border cut off; their deviations say that nothing is known of them.
    pub(super) cut: [bool; EDGES],
}

impl SeenBox {
    /// `None` where the lens model has no ray to an edge, and when every edge is cut.
    pub(super) fn new(model: &CameraModel, box_px: &BoxPx, noise: &BoxNoise) -> Option<Self> {
        let middle = box_px.center();
        let edge = |position: f32| f64::from(position) - 0.5;
        let std_px = noise.edge_std_px(box_px);
        // Position and deviation on the plane; a pixel is worth more of it where the lens squeezes the image.
        let on_plane = |pixel: Pixel, axis: usize| {
            let mut beside = pixel;
            beside[axis] += 1.0;
            let here = model.ray(pixel)?[axis];
            Some((here, std_px * (model.ray(beside)?[axis] - here).abs()))
        };
        let (left, left_std) = on_plane(Pixel::new(edge(box_px.x_min), middle.y), 0)?;
        let (top, top_std) = on_plane(Pixel::new(middle.x, edge(box_px.y_min)), 1)?;
        let (right, right_std) = on_plane(Pixel::new(edge(box_px.x_max), middle.y), 0)?;
        let (bottom, bottom_std) = on_plane(Pixel::new(middle.x, edge(box_px.y_max)), 1)?;
        let (width, height) = (model.size.width_px as f32, model.size.height_px as f32);
        let cut = [
            box_px.x_min < BORDER_PX,
            box_px.y_min < BORDER_PX,
            box_px.x_max > width - BORDER_PX,
            box_px.y_max > height - BORDER_PX,
        ];
        let mut std_devs = Edges::new(left_std, top_std, right_std, bottom_std);
        for (std_dev, _) in std_devs.iter_mut().zip(cut).filter(|(_, cut)| *cut) {
            *std_dev = UNKNOWN_STD;
        }
        let some_left = cut.iter().any(|&cut| !cut);
        some_left.then_some(Self {
            edges: Edges::new(left, top, right, bottom),
            std_devs,
            cut,
        })
    }

    pub(super) fn width(&self) -> f64 {
        self.edges[RIGHT] - self.edges[LEFT]
    }

    pub(super) fn height(&self) -> f64 {
        self.edges[BOTTOM] - self.edges[TOP]
    }
}
