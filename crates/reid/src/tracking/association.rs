//! Which detection of a frame is which object: by place, by image, by class.

use super::{
    filter::Fix,
    object::Object,
    view::{Expected, View},
};
use crate::assignment::{Pair, assign};
use nalgebra::Vector2;
use roadwatch_core::{BoxPx, Detection, Ego, Located, ObjectClass, Oriented};

/// Least overlap by which a detection is taken for an object before it has a place.
const LEAST_OVERLAP: f32 = 0.3;
/// A place that surprises by more than this many squared deviations is another object's; 16 leaves out one in 3000.
const MOST_SURPRISE: f64 = 16.0;
/// Boxes that overlap by this much, in the eyes of one camera, are one object's whatever their places say …
const SURE_OVERLAP: f32 = 0.5;
/// … up to this.
const MOST_SURPRISE_OVERLAPPING: f64 = 100.0;
/// What no overlap at all costs, in squared deviations; half an overlap costs half.
const NO_OVERLAP: f64 = 8.0;
/// A class costs by the share of its votes among all that an object had, as squared deviations do: detectors waver between
/// car and truck, and who wavered may again. No class is rarer than this: it costs eight.
const LEAST_SHARE: f64 = 0.02;
/// One that it hardly ever had costs more by how much higher or lower things of it are, as a share, in squares of this deviation:
/// a bus before a hidden car is not the car.
const HEIGHT_STD: f64 = 0.25;
/// What it costs to begin a new object.
const NEW_OBJECT: f64 = 24.0;
/// Nobody looks for partners further away than this, metres …
const NEAR_M: f64 = 6.0;
/// … or this share of the distance.
const NEAR_SHARE: f64 = 0.4;

/// Classes that detectors take for each other.
fn kind(class: &ObjectClass) -> u8 {
    match class.as_str() {
        "car" | "truck" | "bus" | "van" | "train" | "trailer" => 0,
        "bicycle" | "motorcycle" | "cyclist" => 1,
        "person" => 2,
        _ => 3,
    }
}

/// Whether both may be one object's.
pub(super) fn may_be_one(one: &ObjectClass, other: &ObjectClass) -> bool {
    one == other || kind(one) == kind(other) && kind(one) < 2
}

/// Where an object should be when a frame was captured.
pub(super) struct Outlook {
    /// In the steady frame.
    place: Vector2<f64>,
    /// In the image; `None` where the camera does not look.
    pub(super) expected: Option<Expected>,
}

/// Where every object should be.
pub(super) fn outlook(objects: &[Object], view: &View<'_>) -> Vec<Outlook> {
    let look = |object: &Object| {
        let solid = object.solid_at(view.at);
        Outlook {
            place: solid.center.coords.xy(),
            expected: view.expect(&solid, &object.glimpses),
        }
    };
    objects.iter().map(look).collect()
}

impl Outlook {
    fn overlap(&self, box_px: &BoxPx) -> f32 {
        self.expected.map_or(0.0, |one| one.box_px.iou(box_px))
    }
}

/// The object that each detection shows, by overlap in the image alone.
pub(super) fn by_image(
    objects: &[Object],
    outlook: &[Outlook],
    detections: &[Detection],
) -> Vec<Option<usize>> {
    let expected = outlook.iter().enumerate();
    let expected: Vec<(usize, BoxPx)> = expected
        .filter_map(|(column, outlook)| Some((column, outlook.expected?.box_px)))
        .collect();
    let mut pairs = Vec::new();
    for (row, detection) in detections.iter().enumerate() {
        for &(column, box_px) in &expected {
            let overlap = box_px.iou(&detection.box_px);
            if overlap >= LEAST_OVERLAP && may_be_one(objects[column].class(), &detection.class) {
                let gain = f64::from(overlap);
                pairs.push(Pair { row, column, gain });
            }
        }
    }
    assign(detections.len(), objects.len(), &pairs)
}

/// Where a located object is, in the steady frame, with the height of its centre; `None` of one that is only remembered, and of
/// one that is nowhere.
pub(super) fn fix(located: &Located, view: &View<'_>, ego: &Ego) -> Option<(Fix, f64)> {
    let location = &located.location;
    let center = ego.steady_from_base * location.position;
    let covariance = (ego.steady_from_base * location.covariance).matrix;
    let fix = Fix {
        camera: view.camera,
        eye: view.eye,
        place: center.coords.coords.xy(),
        covariance: covariance.fixed_view::<2, 2>(0, 0) * view.doubt(located),
    };
    let numbers = fix.place.iter().chain(fix.covariance.iter());
    let is_whole = numbers.chain([&center.z()]).all(|one| one.is_finite());
    (is_whole && !location.held).then_some((fix, center.z()))
}

/// A frame's located objects with what was tracked before it.
pub(super) struct Candidates<'a> {
    pub(super) objects: &'a [Object],
    pub(super) outlook: &'a [Outlook],
    pub(super) view: &'a View<'a>,
}

impl Candidates<'_> {
    /// The tracked object that each located one is; `None` of who is new.
    pub(super) fn assign(&self, seen: &[Oriented], fixes: &[Option<Fix>]) -> Vec<Option<usize>> {
        let mut pairs = Vec::new();
        for (row, (one, fix)) in seen.iter().zip(fixes).enumerate() {
            let detection = &one.located.detection;
            let near = fix.as_ref().map(|fix| self.near(fix));
            for (column, outlook) in self.outlook.iter().enumerate() {
                let overlap = outlook.overlap(&detection.box_px);
                // Most are nowhere near, and cost no more than this.
                let is_near = || near.is_some_and(|near| near.holds(outlook));
                if overlap == 0.0 && !is_near() {
                    continue;
                }
                let object = &self.objects[column];
                if !may_be_one(object.class(), &detection.class) {
                    continue;
                }
                let class = by_class(object, &one.located);
                let by_place = match fix {
                    Some(fix) => self.by_place(fix, object, overlap),
                    // Where it is nobody knows, so that it is in the image what it was.
                    None => (overlap >= LEAST_OVERLAP).then_some(0.0),
                };
                let cost = by_place
                    .map(|squared| squared + class + NO_OVERLAP * (1.0 - f64::from(overlap)));
                pairs.extend(cost.filter(|cost| *cost < NEW_OBJECT).map(|cost| Pair {
                    row,
                    column,
                    gain: NEW_OBJECT - cost,
                }));
            }
        }
        assign(seen.len(), self.objects.len(), &pairs)
    }

    /// What it costs that an object is at a place; `None` when it cannot be.
    fn by_place(&self, fix: &Fix, object: &Object, overlap: f32) -> Option<f64> {
        let most = match overlap >= SURE_OVERLAP {
            true => MOST_SURPRISE_OVERLAPPING,
            false => MOST_SURPRISE,
        };
        let surprise = object.surprise_at(self.view.at, fix, most)?;
        // An object of which little is known fits every fix; that is no merit.
        Some(surprise.squared.min(MOST_SURPRISE) + surprise.vague)
    }

    /// Around a place.
    fn near(&self, fix: &Fix) -> Near {
        let away_m = (fix.place - self.view.eye).norm();
        Near {
            place: fix.place,
            squared_m2: NEAR_M.max(NEAR_SHARE * away_m).powi(2),
        }
    }
}

/// What it costs that an object is of the class that a frame says.
fn by_class(object: &Object, located: &Located) -> f64 {
    let share = object.share_of(&located.detection.class);
    if share > LEAST_SHARE {
        return -2.0 * share.ln();
    }
    let higher = (located.location.size.height_m / object.size().height_m).ln();
    -2.0 * LEAST_SHARE.ln() + (higher / HEIGHT_STD).powi(2)
}

/// Where to look for partners.
#[derive(Clone, Copy)]
struct Near {
    place: Vector2<f64>,
    squared_m2: f64,
}

impl Near {
    fn holds(&self, outlook: &Outlook) -> bool {
        (outlook.place - self.place).norm_squared() < self.squared_m2
    }
}
