//! The matcher: which detection is which labelled object.

use crate::truth::{ImageLabels, TruthObject};
use roadwatch_core::{BoxPx, Detection};

/// Least overlap of a detection and the labelled object it is taken for (docs/method.md, section 9).
pub const MIN_IOU: f32 = 0.5;

/// A detection of which this share or more lies in an unlabelled region is not judged, as in KITTI's evaluation.
pub const UNLABELLED_SHARE: f32 = 0.5;

/// Which labelled objects are scored.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthFilter {
    /// Least height of the labelled box, pixels.
    pub min_height_px: f64,
    /// Greatest hidden share, 0 to 1.
    pub max_occluded: f64,
    /// Greatest share outside the image, 0 to 1.
    pub max_truncated: f64,
    /// Classes of objects and of detections.
    pub classes: Vec<String>,
}

impl Default for TruthFilter {
    /// *Clean* cars in a 960x540 image (docs/method.md, section 9).
    fn default() -> Self {
        Self {
            min_height_px: 20.0,
            max_occluded: 0.3,
            max_truncated: 0.05,
            classes: vec!["car".to_owned()],
        }
    }
}

/// Classes between which detectors and labels draw the line differently: COCO calls a pickup a truck,
/// other labels a car.
const CONFUSED: [&str; 2] = ["car", "truck"];

impl TruthFilter {
    /// Whether an object is scored.
    #[must_use]
    pub fn admits(&self, object: &TruthObject) -> bool {
        let high_enough = |box_px: BoxPx| f64::from(box_px.height_px()) >= self.min_height_px;
        self.classes.contains(&object.class)
            && object.box_px.is_some_and(high_enough)
            && object.occluded <= self.max_occluded
            && object.truncated <= self.max_truncated
    }

    /// Whether something of this class, seen or labelled, may stand for an object that is scored.
    pub(crate) fn may_stand_for_scored(&self, class: &str) -> bool {
        let confused = || {
            CONFUSED.contains(&class) && self.classes.iter().any(|c| CONFUSED.contains(&c.as_str()))
        };
        self.classes.iter().any(|wanted| wanted == class) || confused()
    }
}

/// The matches in one image, as indices.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Matches {
    /// (detection, scored object), each at most once.
    pub pairs: Vec<(usize, usize)>,
    /// Detections that match no object, scored or not, and are not in a region that nobody labelled.
    pub false_alarms: Vec<usize>,
}

/// Best score first, each detection takes the free scored object it overlaps most, if by [`MIN_IOU`] or
/// more. Only a detection that finds none may stand for an object that is not scored (as in COCO's
/// evaluation), by its whole box or by what is seen of it; such count neither for nor against. Otherwise a car hidden behind another would take the
/// detection of the one in front, whose box is nearly the same.
#[must_use]
pub fn match_image(
    detections: &[&Detection],
    labels: &ImageLabels,
    filter: &TruthFilter,
) -> Matches {
    let objects = &labels.objects;
    let mut order: Vec<usize> = (0..detections.len())
        .filter(|&at| filter.may_stand_for_scored(detections[at].class.as_str()))
        .collect();
    order.sort_by(|&a, &b| {
        detections[b]
            .score
            .get()
            .total_cmp(&detections[a].score.get())
    });
    let candidates = objects.iter().enumerate();
    let candidates = candidates.filter(|(_, object)| filter.may_stand_for_scored(&object.class));
    let (mut scored, mut others): (Vec<_>, Vec<_>) = candidates
        .map(|(at, _)| at)
        .partition(|&at| filter.admits(&objects[at]));
    let mut matches = Matches::default();
    for detection in order {
        let box_px = detections[detection].box_px;
        let whole = |at: usize| objects[at].box_px.map_or(0.0, |whole| whole.iou(&box_px));
        let seen = |at: usize| {
            let visible = objects[at].visible_px;
            visible.map_or(0.0, |visible| visible.iou(&box_px))
        };
        if let Some(object) = take_best(&mut scored, whole) {
            matches.pairs.push((detection, object));
        } else if take_best(&mut others, |at| whole(at).max(seen(at))).is_none()
            && !is_unlabelled(box_px, &labels.unlabelled_px)
        {
            matches.false_alarms.push(detection);
        }
    }
    matches
}

/// Whether one of the regions covers the box by [`UNLABELLED_SHARE`] or more.
fn is_unlabelled(box_px: BoxPx, regions: &[BoxPx]) -> bool {
    let covered = |region: &BoxPx| {
        let width = box_px.x_max.min(region.x_max) - box_px.x_min.max(region.x_min);
        let height = box_px.y_max.min(region.y_max) - box_px.y_min.max(region.y_min);
        width.max(0.0) * height.max(0.0)
    };
    let regions = regions.iter().map(covered);
    regions.fold(0.0, f32::max) >= UNLABELLED_SHARE * box_px.area_px2()
}

/// Removes the object of the greatest overlap; `None` when none reaches [`MIN_IOU`].
fn take_best(free: &mut Vec<usize>, iou: impl Fn(usize) -> f32) -> Option<usize> {
    let overlaps = free.iter().enumerate();
    let overlaps = overlaps.map(|(place, &object)| (iou(object), place));
    let (iou, place) = overlaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (iou >= MIN_IOU).then(|| free.remove(place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_core::{ObjectClass, Score, space::Point};

    fn detection(x: f32, score: f32, class: &str) -> Detection {
        Detection {
            class: ObjectClass::new(class),
            score: Score::new(score).expect("a score"),
            input_pixel_px: 1.0,
            box_px: BoxPx::new(x, 0.0, x + 40.0, 30.0).expect("a box"),
        }
    }

    fn object(x: f32, class: &str) -> TruthObject {
        TruthObject {
            id: format!("{class}{x}"),
            class: class.to_owned(),
            label: None,
            box_px: BoxPx::new(x, 0.0, x + 40.0, 30.0),
            silhouette_px: None,
            visible_px: None,
            truncated: 0.0,
            occluded: 0.0,
            center: Point::new(10.0, 0.0, 0.7),
            size: None,
            yaw_rad: None,
        }
    }

    #[test]
    fn what_is_seen_of_an_object_that_is_not_scored_is_no_false_alarm() {
        let hidden = TruthObject {
            occluded: 0.6,
            box_px: BoxPx::new(0.0, 0.0, 120.0, 30.0),
            visible_px: BoxPx::new(0.0, 0.0, 45.0, 30.0),
            ..object(0.0, "car")
        };
        let found = detection(0.0, 0.9, "car");
        let matches =
            |object| match_image(&[&found], &vec![object].into(), &TruthFilter::default());
        assert_eq!(matches(hidden.clone()), Matches::default());
        let unsaid = TruthObject {
            visible_px: None,
            ..hidden
        };
        assert_eq!(matches(unsaid).false_alarms, [0]);
    }

    #[test]
    fn the_better_detection_takes_the_object_and_the_other_goes_without() {
        let (weak, strong) = (detection(0.0, 0.4, "car"), detection(5.0, 0.9, "car"));
        let labels = vec![object(0.0, "car")].into();
        let found = match_image(&[&weak, &strong], &labels, &TruthFilter::default());
        assert_eq!(found.pairs, [(1, 0)]);
        assert_eq!(found.false_alarms, [0]);
    }

    #[test]
    fn classes_nobody_asked_for_do_not_take_part() {
        let (person, car) = (
            detection(0.0, 0.9, "person"),
            detection(100.0, 0.9, "truck"),
        );
        let labels = vec![object(0.0, "person"), object(100.0, "car")].into();
        let found = match_image(&[&person, &car], &labels, &TruthFilter::default());
        assert_eq!(found.pairs, [(1, 1)]);
        assert!(found.false_alarms.is_empty());
    }

    #[test]
    fn a_hidden_object_does_not_take_the_detection_of_the_one_in_front() {
        let hidden = TruthObject {
            occluded: 1.0,
            ..object(0.0, "car")
        };
        let labels = vec![hidden, object(4.0, "car")].into();
        let (seen, more) = (detection(1.0, 0.9, "car"), detection(0.0, 0.5, "car"));
        let found = match_image(&[&seen, &more], &labels, &TruthFilter::default());
        assert_eq!(found.pairs, [(0, 1)]);
        assert!(found.false_alarms.is_empty());
    }

    #[test]
    fn what_is_detected_where_nobody_labelled_is_not_judged() {
        let labels = ImageLabels {
            objects: vec![object(0.0, "car")],
            unlabelled_px: BoxPx::new(0.0, 0.0, 225.0, 300.0).into_iter().collect(),
        };
        let (car, inside) = (detection(0.0, 0.9, "car"), detection(200.0, 0.8, "car"));
        let outside = detection(210.0, 0.7, "car");
        let detections = [&car, &inside, &outside];
        let found = match_image(&detections, &labels, &TruthFilter::default());
        assert_eq!(found.pairs, [(0, 0)]);
        assert_eq!(found.false_alarms, [2]);
    }

    #[test]
    fn small_hidden_and_cut_objects_are_not_scored() {
        let filter = TruthFilter::default();
        let good = object(0.0, "car");
        assert!(filter.admits(&good));
        assert!(!filter.admits(&TruthObject {
            occluded: 0.5,
            ..good.clone()
        }));
        assert!(!filter.admits(&TruthObject {
            truncated: 0.2,
            ..good.clone()
        }));
        assert!(!filter.admits(&TruthObject {
            box_px: BoxPx::new(0.0, 0.0, 40.0, 19.0),
            ..good.clone()
        }));
        assert!(!filter.admits(&TruthObject {
            box_px: None,
            ..good
        }));
    }
}
