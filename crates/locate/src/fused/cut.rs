//! What the image's border leaves of an outline: the top and the foot of the part that is inside.

use super::{
    edges::{BOTTOM, LEFT, RIGHT, SeenBox, TOP},
    solid::{MOST_POINTS, Outline, Touch, Turned},
};
use arrayvec::ArrayVec;
use nalgebra::{Matrix3, RowVector3, Vector3};

/// The border on one side: at `at` on the plane at depth 1, the image on the side of greater values or of lesser ones.
#[derive(Clone, Copy)]
struct Border {
    at: f64,
    side: f64,
}

/// A point of the hull's surface.
#[derive(Clone, Copy)]
struct Candidate {
    touch: Touch,
    /// In optical axes.
    point: Vector3<f64>,
    /// Slope of its height on the plane at depth 1, by the place of that point of the surface.
    slope: RowVector3<f64>,
}

impl Border {
    fn shows(self, point: &Vector3<f64>) -> bool {
        (point.x - self.at * point.z) * self.side >= 0.0
    }
}

impl Candidate {
    fn height(&self) -> f64 {
        self.point.y / self.point.z
    }
}

impl Outline {
    /// The same outline with the top and the foot of what is between the borders that cut the box on its sides. A box that is not cut
    /// there, and one none of whose hull is inside, stays as it is.
    pub(super) fn within(
        self,
        seen: &SeenBox,
        (turned, middle): (&Turned, &Vector3<f64>),
        optical_from_base: &Matrix3<f64>,
    ) -> Self {
        let border = |edge: usize, side: f64| {
            let at = seen.edges[edge];
            seen.cut[edge].then_some(Border { at, side })
        };
        let borders = [border(LEFT, 1.0), border(RIGHT, -1.0)];
        if borders.iter().all(Option::is_none) {
            return self;
        }
        let Some((top, foot)) = top_and_foot(turned, middle, borders) else {
            return self;
        };
        let mut within = self;
        for (edge, found) in [(TOP, top), (BOTTOM, foot)] {
            within.edges[edge] = found.height();
            within.touches[edge] = found.touch;
            within.slopes[edge] = found.slope * optical_from_base;
        }
        within
    }
}

/// Of what is inside the borders; `None` when nothing is. They are among the hull's points inside, and where lines between two of its
/// points cross a border.
fn top_and_foot(
    turned: &Turned,
    middle: &Vector3<f64>,
    borders: [Option<Border>; 2],
) -> Option<(Candidate, Candidate)> {
    let points: ArrayVec<Vector3<f64>, MOST_POINTS> =
        turned.points().map(|point| point + middle).collect();
    let mut ends: Option<(Candidate, Candidate)> = None;
    let mut take = |one: Candidate| {
        let (top, foot) = ends.get_or_insert((one, one));
        if one.height() < top.height() {
            *top = one;
        }
        if one.height() > foot.height() {
            *foot = one;
        }
    };
    let shown = |point: &Vector3<f64>| borders.iter().flatten().all(|border| border.shows(point));
    for (number, point) in points.iter().enumerate() {
        if shown(point) {
            take(corner(number, point));
        }
    }
    for (border, other) in [(borders[0], borders[1]), (borders[1], borders[0])] {
        let Some(border) = border else {
            continue;
        };
        let (inside, outside): (Side<'_>, Side<'_>) = points
            .iter()
            .enumerate()
            .partition(|(_, point)| border.shows(point));
        for &from in &inside {
            for &to in &outside {
                let crossing = crossing(border, from, to);
                if other.is_none_or(|other| other.shows(&crossing.point)) {
                    take(crossing);
                }
            }
        }
    }
    ends
}

/// Points of the hull on one side of a border, by their numbers.
type Side<'a> = ArrayVec<(usize, &'a Vector3<f64>), MOST_POINTS>;

fn corner(number: usize, point: &Vector3<f64>) -> Candidate {
    Candidate {
        touch: Touch::at(number),
        point: *point,
        slope: RowVector3::new(0.0, 1.0, -point.y / point.z) / point.z,
    }
}

/// Where the line from a point inside to one outside crosses the border. When the object moves, the crossing moves along the
/// border.
fn crossing(
    border: Border,
    (from, inside): (usize, &Vector3<f64>),
    (to, outside): (usize, &Vector3<f64>),
) -> Candidate {
    let line = outside - inside;
    let across = line.x - border.at * line.z;
    let share = (border.at * inside.z - inside.x) / across;
    let point = inside + line * share;
    let height = point.y / point.z;
    let along = (line.y - height * line.z) / across;
    Candidate {
        touch: Touch { from, to, share },
        point,
        slope: RowVector3::new(-along, 1.0, along * border.at - height) / point.z,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{box_noise::BoxNoise, fused::solid::Solid, hull::HullSpec};
    use roadwatch_core::{
        BoxPx, CameraModel, Distortion, ImageSize, Intrinsics, ObjectClass, SizeLwh,
    };

    /// A camera that looks along base_link's x, and a car across its view, 12 m ahead.
    fn outline(left_m: f64, x_min: f32) -> (Outline, Outline, SeenBox) {
        let model = CameraModel {
            size: ImageSize {
                width_px: 1000,
                height_px: 600,
            },
            intrinsics: Intrinsics {
                fx: 500.0,
                fy: 500.0,
                cx: 499.5,
                cy: 299.5,
            },
            distortion: Distortion::None,
        };
        let optical_from_base = Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0);
        let size = SizeLwh {
            length_m: 4.6,
            width_m: 1.85,
            height_m: 1.6,
        };
        let solid = Solid::new(&HullSpec::for_class(&ObjectClass::new("car")), size);
        let turned = solid.turn((1.0, 0.0), &optical_from_base);
        let box_px = BoxPx::new(x_min, 250.0, 200.0, 350.0).expect("a box");
        let seen = SeenBox::new(&model, &box_px, &BoxNoise::default()).expect("seen");
        let middle = optical_from_base * Vector3::new(12.0, left_m, -1.5);
        let whole = turned.outline(&middle, &optical_from_base).expect("ahead");
        let within = whole.within(&seen, (&turned, &middle), &optical_from_base);
        (whole, within, seen)
    }

    #[test]
    fn a_box_that_no_side_cuts_has_the_whole_outline() {
        let (whole, within, _) = outline(11.0, 20.0);
        assert_eq!(whole.edges, within.edges);
    }

    #[test]
    fn a_bonnet_at_the_border_is_lower_than_the_roof_outside() {
        let (whole, within, _) = outline(14.0, 0.0);
        assert!(within.edges[TOP] > whole.edges[TOP] + 0.005, "{within:?}");
        assert_eq!(within.edges[RIGHT], whole.edges[RIGHT]);
    }

    #[test]
    fn slopes_are_those_of_the_clipped_outline() {
        let step_m = 1e-3;
        let (_, here, _) = outline(13.0, 0.0);
        let (_, there, _) = outline(13.0 + step_m, 0.0);
        for edge in [TOP, BOTTOM] {
            let by_step = (there.edges[edge] - here.edges[edge]) / step_m;
            assert!(
                (here.slopes[edge].y - by_step).abs() < 1e-4,
                "{edge}: {by_step} {here:?}"
            );
        }
    }

    #[test]
    fn a_hull_outside_the_image_stays_whole() {
        let (whole, within, _) = outline(30.0, 0.0);
        assert_eq!(whole.edges, within.edges);
    }
}
