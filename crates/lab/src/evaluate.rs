//! Evaluation: detections of a whole dataset against its labels, every method side by side.

use crate::{
    matching::{TruthFilter, match_image},
    recorder::Recorded,
    report::{DetectionScore, MethodReport, Report},
    score::{Sample, score_distance, score_location, share},
    truth::{Truth, TruthObject},
};
use roadwatch_camera::RigDataset;
use roadwatch_core::{CameraId, Detection, Location, Locator, Method, Rig, RigCamera, Timestamp};
use std::collections::{BTreeMap, HashMap};

/// A method with its locators, one per camera of the rig.
pub struct MethodUnderTest {
    /// The method.
    pub method: Method,
    /// Locators in order of camera ids, or why the method cannot be used on this rig.
    pub locators: Result<Vec<Box<dyn Locator>>, String>,
}

/// What becomes of objects in images that were lost on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LostImages {
    /// They count as not found.
    Count,
    /// They are not scored: a run in real time may drop frames.
    Ignore,
}

/// What is evaluated.
pub struct Evaluation<'a> {
    /// The rig, with the same cameras in the same order as the dataset.
    pub rig: &'a Rig,
    /// Where the frames came from.
    pub dataset: &'a RigDataset,
    /// Their labels.
    pub truth: &'a Truth,
    /// Which objects are scored.
    pub filter: &'a TruthFilter,
    /// What a lost image means.
    pub lost_images: LostImages,
    /// Only the first frames of each camera were played; `None` when all were.
    pub frame_limit: Option<u64>,
}

/// A detection taken for a labelled object that is scored.
struct Pair<'a> {
    camera: usize,
    detection: &'a Detection,
    /// Where it was said to be; `None` when no place was published for it.
    published: Option<&'a Location>,
    object: &'a TruthObject,
}

/// Matches everything recorded to the labels, and scores each method on the same matches.
#[must_use]
pub fn evaluate(
    evaluation: &Evaluation<'_>,
    recorded: &[Recorded],
    methods: &[MethodUnderTest],
) -> Report {
    let by_moment: HashMap<_, _> = recorded
        .iter()
        .map(|frame| ((frame.camera, frame.captured_at), frame))
        .collect();
    let mut pairs = Vec::new();
    let mut counts = Counts::default();
    for (camera, captured_at, number) in evaluation.images() {
        let name = evaluation.rig.camera(camera).name.as_str();
        let objects = evaluation.truth.objects(number, name);
        let found = by_moment.get(&(camera, captured_at));
        counts.images += 1;
        if found.is_none() && evaluation.lost_images == LostImages::Ignore {
            continue;
        }
        counts.objects += objects
            .iter()
            .filter(|object| evaluation.filter.admits(object))
            .count();
        let Some(frame) = found else {
            continue;
        };
        let detections: Vec<&Detection> = frame.detections().collect();
        let matches = match_image(&detections, objects, evaluation.filter);
        counts.perceived += 1;
        counts.found += matches.pairs.len();
        counts.false_alarms += matches.false_alarms.len();
        pairs.extend(matches.pairs.iter().map(|&(detection, object)| Pair {
            camera: camera.index(),
            detection: detections[detection],
            published: frame.location(detection),
            object: &objects[object],
        }));
    }
    let by_method = methods.iter().map(|tested| {
        let report = match &tested.locators {
            Ok(locators) => score_places(evaluation.rig, &pairs, |pair| {
                locators[pair.camera].locate(pair.detection, None)
            }),
            Err(reason) => MethodReport::unavailable(reason.clone()),
        };
        (tested.method, report)
    });
    Report {
        frames: counts.perceived,
        frames_missing: counts.images - counts.perceived,
        filter: evaluation.filter.clone(),
        detection: counts.score(),
        published: score_places(evaluation.rig, &pairs, |pair| pair.published.cloned()),
        methods: by_method.collect::<BTreeMap<_, _>>(),
    }
}

impl Evaluation<'_> {
    /// Every image of the dataset up to the limit: camera, stamp, frame number.
    fn images(&self) -> impl Iterator<Item = (CameraId, Timestamp, u64)> {
        let limit = self.frame_limit.map_or(usize::MAX, |limit| {
            usize::try_from(limit).unwrap_or(usize::MAX)
        });
        self.rig.ids().flat_map(move |camera| {
            let frames = self.dataset.frames().iter();
            let captured = frames.filter_map(move |frame| {
                Some((camera, frame.stamps[camera.index()]?, frame.number))
            });
            captured.take(limit)
        })
    }
}

fn score_places(
    rig: &Rig,
    pairs: &[Pair<'_>],
    place: impl Fn(&Pair<'_>) -> Option<Location>,
) -> MethodReport {
    let samples: Vec<Sample> = pairs
        .iter()
        .filter_map(|pair| {
            let location = place(pair)?;
            let camera: &RigCamera = &rig.cameras()[pair.camera];
            let (found, true_center) = (location.position, pair.object.center);
            Some(Sample {
                range_m: location.range_m,
                true_range_m: camera.range_m(true_center),
                location_error_m: (found.x() - true_center.x()).hypot(found.y() - true_center.y()),
            })
        })
        .collect();
    MethodReport {
        distance: score_distance(&samples),
        location: score_location(&samples),
        unlocated: pairs.len() - samples.len(),
        unavailable: None,
    }
}

/// Counts of detection. Objects outside the filter count neither for nor against.
#[derive(Default)]
struct Counts {
    images: usize,
    perceived: usize,
    objects: usize,
    found: usize,
    false_alarms: usize,
}

impl Counts {
    fn score(&self) -> DetectionScore {
        DetectionScore {
            n: self.objects,
            matched: self.found,
            recall: share(self.found, self.objects),
            precision: share(self.found, self.found + self.false_alarms),
        }
    }
}
