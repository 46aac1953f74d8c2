//! The matcher: which detection is which labelled object.

use crate::truth::TruthObject;
use roadwatch_core::{BoxPx, Detection};

/// Least overlap of a detection and the labelled object it is taken for (METHOD.md, section 9).
pub const MIN_IOU: f32 = 0.5;

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
    /// *Clean* objects in a 960x540 image (METHOD.md, section 9).
    fn default() -> Self {
        Self {
            min_height_px: 20.0,
            max_occluded: 0.3,
            max_truncated: 0.05,
            classes: vec!["car".to_owned(), "truck".to_owned()],
        }
    }
}

impl TruthFilter {
    /// Whether a class takes part at all.
    #[must_use]
    pub fn has_class(&self, class: &str) -> bool {
        self.classes.iter().any(|wanted| wanted == class)
    }

    /// Whether an object is scored.
    #[must_use]
    pub fn admits(&self, object: &TruthObject) -> bool {
        let height_px = object
            .box_px
            .map_or(0.0, |box_px| f64::from(box_px.height_px()));
        self.has_class(&object.class)
            && height_px >= self.min_height_px
            && object.occluded <= self.max_occluded
            && object.truncated <= self.max_truncated
    }
}

/// The matches in one image, as indices.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Matches {
    /// (detection, object), each at most once.
    pub pairs: Vec<(usize, usize)>,
    /// Detections of a wanted class that match no object.
    pub unmatched: Vec<usize>,
}

/// Best score first, each detection takes the free object of the wanted classes that it overlaps most,
/// if by [`MIN_IOU`] or more. Classes need not agree beyond being wanted: cars and trucks are often confused.
#[must_use]
pub fn match_image(
    detections: &[&Detection],
    objects: &[TruthObject],
    filter: &TruthFilter,
) -> Matches {
    let mut order: Vec<usize> = (0..detections.len())
        .filter(|&at| filter.has_class(detections[at].class.as_str()))
        .collect();
    order.sort_by(|&a, &b| {
        detections[b]
            .score
            .get()
            .total_cmp(&detections[a].score.get())
    });
    let mut free: Vec<(usize, BoxPx)> = objects
        .iter()
        .enumerate()
        .filter(|(_, object)| filter.has_class(&object.class))
        .filter_map(|(at, object)| Some((at, object.box_px?)))
        .collect();
    let mut matches = Matches::default();
    for detection in order {
        let box_px = detections[detection].box_px;
        let overlaps = free
            .iter()
            .enumerate()
            .map(|(place, (_, object))| (box_px.iou(object), place));
        let best = overlaps.max_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((iou, place)) if iou >= MIN_IOU => {
                let (object, _) = free.remove(place);
                matches.pairs.push((detection, object));
            }
            _ => matches.unmatched.push(detection),
        }
    }
    matches
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_core::{ObjectClass, Score, space::Point};

    fn detection(x: f32, score: f32, class: &str) -> Detection {
        Detection {
            class: ObjectClass::new(class),
            score: Score::new(score).expect("a score"),
            box_px: BoxPx::new(x, 0.0, x + 40.0, 30.0).expect("a box"),
        }
    }

    fn object(x: f32, class: &str) -> TruthObject {
        TruthObject {
            id: format!("{class}{x}"),
            class: class.to_owned(),
            box_px: BoxPx::new(x, 0.0, x + 40.0, 30.0),
            truncated: 0.0,
            occluded: 0.0,
            center: Point::new(10.0, 0.0, 0.7),
        }
    }

    #[test]
    fn the_better_detection_takes_the_object_and_the_other_goes_without() {
        let (weak, strong) = (detection(0.0, 0.4, "car"), detection(5.0, 0.9, "car"));
        let found = match_image(
            &[&weak, &strong],
            &[object(0.0, "car")],
            &TruthFilter::default(),
        );
        assert_eq!(found.pairs, [(1, 0)]);
        assert_eq!(found.unmatched, [0]);
    }

    #[test]
    fn classes_nobody_asked_for_do_not_take_part() {
        let (person, car) = (
            detection(0.0, 0.9, "person"),
            detection(100.0, 0.9, "truck"),
        );
        let objects = [object(0.0, "person"), object(100.0, "car")];
        let found = match_image(&[&person, &car], &objects, &TruthFilter::default());
        assert_eq!(found.pairs, [(1, 1)]);
        assert!(found.unmatched.is_empty());
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
