//! One heading: the place at which the hull's outline meets the box best, and how well it then does.

use super::{
    edges::{BOTTOM, Edges, LEFT, RIGHT, SeenBox},
    level::Ground,
    normal::{Normal, inverse_and_determinant},
    solid::{Outline, Solid, Turned},
};
use nalgebra::{Matrix2, Matrix3, Matrix4, Matrix4x2, RowVector3, Vector2, Vector3};
use roadwatch_core::{GroundReading, SizeLwh};
use std::f64::consts::TAU;

/// Gauss-Newton steps from the first guess, which may be off by a fifth; outlines are all but linear in the
/// logarithm of the distance.
const APPROACHES: usize = 2;
/// A step moves a place by at most this share of its distance.
const LONGEST_STEP: f64 = 0.4;
/// How far the start may be off, as a share of its distance: keeps places finite where the box says nothing.
const START_STD: f64 = 1.0;
/// At most this share of the box may be missing there: an object hidden more is seldom detected.
const MOST_HIDDEN: f64 = 0.5;
/// An edge that is this many standard deviations outside the outline is not hidden.
const OUTSIDE_STD_DEVS: f64 = 1.0;

/// Where the camera is and what is known before a box comes.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) eye: Vector3<f64>,
    pub(super) optical_from_base: Matrix3<f64>,
    pub(super) ground: Ground,
    pub(super) hidden: HiddenShares,
}

/// How often something stands in front of an object's end or foot, as a share of all objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HiddenShares {
    /// Of its left end, and again of its right end.
    pub side: f64,
    /// Of its foot.
    pub foot: f64,
}

impl Default for HiddenShares {
    /// In simulated traffic a tenth and a fiftieth of the boxes of cars at most 30 % hidden are cut so.
    fn default() -> Self {
        Self {
            side: 0.1,
            foot: 0.02,
        }
    }
}

/// A class's hull in every heading tried.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) solid: Solid,
    pub(super) std_dev: SizeLwh,
    /// Sine and cosine of the heading, and the hull turned into it.
    pub(super) turned: Vec<((f64, f64), Turned)>,
    /// Of the heading within its bin, radians.
    pub(super) heading_std_rad: f64,
}

/// One explanation of the box: a heading, with or without a hidden edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Explanation {
    /// Its evidence is `scale * exp(-cost / 2)`, up to a constant of the box.
    pub(super) scale: f64,
    pub(super) cost: f64,
    /// Middle of the footprint in base_link, metres.
    pub(super) place: Vector2<f64>,
    pub(super) covariance: Matrix2<f64>,
    /// Which heading of the shape.
    pub(super) heading: usize,
    /// Mean and variance of the ground's height, in standard deviations of what was expected of it; `None` where
    /// an edge is hidden.
    pub(super) ground: Option<(f64, f64)>,
    /// What the box adds to that heading, and the deviation that is left, radians.
    pub(super) turn_rad: f64,
    pub(super) turn_std_rad: f64,
}

impl View {
    /// A place from which one more Gauss-Newton step hits: the best one for `heading`, sought from `start`.
    pub(super) fn approach(
        &self,
        shape: &Shape,
        heading: usize,
        seen: &SeenBox,
        start: Vector2<f64>,
    ) -> Option<Vector2<f64>> {
        (0..APPROACHES).try_fold(start, |place, _| {
            Some(self.fit(shape, heading, seen, (place, start))?.best)
        })
    }

    /// Fits a heading from `place` by one Gauss-Newton step; `None` where the hull comes behind the camera.
    /// `start` is where the object was sought first.
    #[inline(always)]
    pub(super) fn fit(
        &self,
        shape: &Shape,
        heading: usize,
        seen: &SeenBox,
        (place, start): (Vector2<f64>, Vector2<f64>),
    ) -> Option<Fit> {
        let (yaw, turned) = &shape.turned[heading];
        let away = place - self.eye.xy();
        let distance_m = away.norm();
        if !(distance_m > 0.0 && distance_m.is_finite()) {
            return None;
        }
        let radial = away / distance_m;
        let lateral = Vector2::new(-radial.y, radial.x);
        let axes = Matrix2::from_columns(&[radial, lateral]);
        let middle = Vector3::new(place.x, place.y, self.ground.height_m(place)) - self.eye;
        let middle = self.optical_from_base * middle;
        let outline = turned.outline(&middle, &self.optical_from_base)?;
        let outline = outline.within(seen, (turned, &middle), &self.optical_from_base);
        let causes = self.causes(shape, &outline, (*yaw, place, distance_m));
        let covariance = causes.covariance(seen);
        let (precision, determinant) = inverse_and_determinant(&covariance);
        let residual = seen.edges - outline.edges;
        let along = |direction: Vector2<f64>| {
            let rise = self.ground.slopes.dot(&direction);
            let slope = |by: RowVector3<f64>| by.x * direction.x + by.y * direction.y + by.z * rise;
            Edges::from(outline.slopes.map(slope))
        };
        let by_place = Matrix4x2::from_columns(&[along(radial), along(lateral)]);
        let start_precision = (START_STD * distance_m).powi(-2);
        let from_start = axes.tr_mul(&(start - place));
        let normal = Normal::new(
            &precision,
            (&by_place, &residual, &causes.turn),
            (from_start, start_precision),
        );
        let longest = LONGEST_STEP * distance_m;
        let step = normal.solve().step.map(|by| by.clamp(-longest, longest));
        Some(Fit {
            best: place + axes * step,
            heading,
            heading_std_rad: shape.heading_std_rad,
            place,
            axes,
            by_place,
            residual,
            precision,
            density: determinant.sqrt().recip(),
            hidden: self.hidden,
            raised: causes.ground,
            normal,
        })
    }

    /// What the box says of the ground by its best explanation; `None` where an edge is hidden.
    pub(super) fn ground_reading(&self, best: &Explanation) -> Option<GroundReading> {
        let distance_m = (best.place - self.eye.xy()).norm();
        let eye_height_m = self.eye.z - self.ground.height_m(best.place);
        self.ground
            .reading((best.place, distance_m), eye_height_m, best.ground?)
    }

    /// What one standard deviation of everything unknown does to the outline's edges.
    #[inline(always)]
    fn causes(
        &self,
        shape: &Shape,
        outline: &Outline,
        (yaw, place, distance_m): ((f64, f64), Vector2<f64>, f64),
    ) -> Causes {
        let [length, width, height, turn] = shape.solid.shape_slopes(outline, yaw, shape.std_dev);
        let ground_std_m = self.ground.std_m(place, distance_m);
        Causes {
            size: [length, width, height],
            turn: turn * shape.heading_std_rad,
            ground: Edges::from(outline.slopes.map(|by| by.z * ground_std_m)),
        }
    }
}

/// What one standard deviation of each does to the edges: of length, width and height, of the heading within
/// its bin, and of the ground's height.
struct Causes {
    size: [Edges; 3],
    turn: Edges,
    ground: Edges,
}

impl Causes {
    /// Of the box's edges about the outline's.
    #[inline(always)]
    fn covariance(&self, seen: &SeenBox) -> Matrix4<f64> {
        let mut covariance = Matrix4::from_diagonal(&seen.std_devs.component_mul(&seen.std_devs));
        let [length, width, height] = self.size;
        for cause in [length, width, height, self.turn, self.ground] {
            covariance += cause * cause.transpose();
        }
        covariance
    }
}

/// A fitted heading, to be explained.
pub(super) struct Fit {
    /// Where the step led: a start for the next heading.
    pub(super) best: Vector2<f64>,
    heading: usize,
    heading_std_rad: f64,
    /// Where the outline was taken.
    place: Vector2<f64>,
    /// Away from the camera and to its left, level.
    axes: Matrix2<f64>,
    by_place: Matrix4x2<f64>,
    residual: Edges,
    precision: Matrix4<f64>,
    /// Of the edges' Gaussian at its middle, without its powers of 2 pi.
    density: f64,
    hidden: HiddenShares,
    /// What ground higher by one standard deviation does to the edges.
    raised: Edges,
    normal: Normal,
}

impl Fit {
    /// The box as it is, and with its left, right or lower edge hidden.
    #[inline(always)]
    pub(super) fn explanations(&self, seen: &SeenBox) -> impl Iterator<Item = Explanation> {
        let HiddenShares { side, foot } = self.hidden;
        let visible = 1.0 - 2.0 * side - foot;
        let whole = self.explain(&self.normal, visible * self.density).0;
        let whole = Explanation {
            ground: Some(self.ground()),
            ..whole
        };
        let hidden = [
            (LEFT, 1.0, side, seen.width()),
            (RIGHT, -1.0, side, seen.width()),
            (BOTTOM, -1.0, foot, seen.height()),
        ];
        let hidden = hidden.into_iter().filter(|&(edge, ..)| !seen.cut[edge]);
        let hidden = hidden.filter_map(|(edge, inward, share, extent)| {
            let outside = -OUTSIDE_STD_DEVS * seen.std_devs[edge];
            let (most, own) = (MOST_HIDDEN * extent, self.precision[(edge, edge)]);
            // One factor of the density of four Gaussian edges gives way to a uniform one.
            let density = self.density * (TAU / own).sqrt() / most;
            let normal = self.normal.without(edge, own);
            let (explanation, step) = self.explain(&normal, share * density);
            let left_over = self.residual[edge] - (self.by_place.row(edge) * step).x;
            (outside..most)
                .contains(&(left_over * inward))
                .then_some(explanation)
        });
        std::iter::once(whole).chain(hidden)
    }

    /// Mean and variance of the ground's height by all four edges, in standard deviations of what was expected
    /// of it.
    #[inline(always)]
    fn ground(&self) -> (f64, f64) {
        self.normal.of_cause(
            &self.precision,
            (&self.by_place, &self.residual),
            &self.raised,
        )
    }

    /// The best place by a form of the normal equations, and the step that leads there.
    #[inline(always)]
    fn explain(&self, normal: &Normal, density: f64) -> (Explanation, Vector2<f64>) {
        let solved = normal.solve();
        let explanation = Explanation {
            scale: density * solved.determinant.sqrt(),
            cost: solved.cost,
            place: self.place + self.axes * solved.step,
            covariance: self.axes * solved.covariance * self.axes.transpose(),
            heading: self.heading,
            ground: None,
            turn_rad: solved.turn * self.heading_std_rad,
            turn_std_rad: solved.turn_variance.max(0.0).sqrt() * self.heading_std_rad,
        };
        (explanation, solved.step)
    }
}
