//! What a frame found, and what that hides.

use super::view::Expected;
use roadwatch_core::BoxPx;

/// A box hidden by a nearer one to this share is not missed.
const HIDDEN_SHARE: f32 = 0.4;

/// The boxes that a frame found, with the objects they were taken for.
pub(super) struct Found<'a> {
    pub(super) boxes: Vec<(&'a BoxPx, Option<(usize, f64)>)>,
}

impl Found<'_> {
    /// Whether a nearer object's box covers this one.
    pub(super) fn is_hidden(&self, expected: &Expected, index: usize) -> bool {
        let area = expected.box_px.area_px2();
        self.boxes.iter().any(|(box_px, taken)| {
            let nearer =
                taken.is_none_or(|(other, depth_m)| other != index && depth_m < expected.depth_m);
            nearer && shared_px2(box_px, &expected.box_px) > HIDDEN_SHARE * area
        })
    }
}

fn shared_px2(one: &BoxPx, other: &BoxPx) -> f32 {
    let width = one.x_max.min(other.x_max) - one.x_min.max(other.x_min);
    let height = one.y_max.min(other.y_max) - one.y_min.max(other.y_min);
    width.max(0.0) * height.max(0.0)
}
