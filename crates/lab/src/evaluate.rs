//! Evaluation: detections of a whole dataset against its labels, every method side by side.

use crate::{
    matching::{Matches, TruthFilter, match_image},
    recorder::Recorded,
    report::{DetectionScore, MethodReport, Report},
    score::{Sample, score_distance, score_location, share},
    truth::{Truth, TruthObject},
};
use roadwatch_camera::RigDataset;
use roadwatch_core::{Detection, Locator, Method, Rig, RigCamera};
use std::collections::{BTreeMap, HashMap};

/// A method with its locators, one per camera of the rig.
pub struct MethodUnderTest {
    /// The method.
    pub method: Method,
    /// Locators in order of camera ids, or why the method cannot be used on this rig.
    pub locators: Result<Vec<Box<dyn Locator>>, String>,
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
}

/// A detection taken for a labelled object that is scored.
struct Pair<'a> {
    camera: usize,
    detection: &'a Detection,
    object: &'a TruthObject,
}

/// Matches everything recorded to the labels, and scores each method on the same matches.
#[must_use]
pub fn evaluate(
    evaluation: &Evaluation<'_>,
    recorded: &[Recorded],
    methods: &[MethodUnderTest],
) -> Report {
    let numbers = frame_numbers(evaluation.dataset);
    let mut pairs = Vec::new();
    let mut counts = Counts::default();
    for frame in recorded {
        let camera = frame.camera.index();
        let Some(&number) = numbers.get(&(camera, frame.captured_at.as_nanos())) else {
            continue;
        };
        let name = evaluation.rig.camera(frame.camera).name.as_str();
        let objects = evaluation.truth.objects(number, name);
        let detections: Vec<&Detection> = frame.detections().collect();
        let matches = match_image(&detections, objects, evaluation.filter);
        counts.add(&matches, objects, evaluation.filter);
        pairs.extend(matches.pairs.iter().map(|&(detection, object)| Pair {
            camera,
            detection: detections[detection],
            object: &objects[object],
        }));
    }
    let by_method = methods.iter().map(|tested| {
        let report = match &tested.locators {
            Ok(locators) => score_method(evaluation.rig, locators, &pairs),
            Err(reason) => MethodReport::unavailable(reason.clone()),
        };
        (tested.method, report)
    });
    Report {
        frames: recorded.len(),
        filter: evaluation.filter.clone(),
        detection: counts.score(),
        methods: by_method.collect::<BTreeMap<_, _>>(),
    }
}

/// Frame numbers by (camera, stamp).
fn frame_numbers(dataset: &RigDataset) -> HashMap<(usize, i64), u64> {
    let frames = dataset.frames().iter();
    let stamps = frames.flat_map(|frame| {
        let stamps = frame.stamps.iter().enumerate();
        stamps.filter_map(|(camera, stamp)| Some(((camera, (*stamp)?.as_nanos()), frame.number)))
    });
    stamps.collect()
}

fn score_method(rig: &Rig, locators: &[Box<dyn Locator>], pairs: &[Pair<'_>]) -> MethodReport {
    let samples: Vec<Sample> = pairs
        .iter()
        .filter_map(|pair| {
            let location = locators[pair.camera].locate(pair.detection, None)?;
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
    objects: usize,
    found: usize,
    false_alarms: usize,
}

impl Counts {
    fn add(&mut self, matches: &Matches, objects: &[TruthObject], filter: &TruthFilter) {
        self.objects += objects
            .iter()
            .filter(|object| filter.admits(object))
            .count();
        self.found += matches.pairs.len();
        self.false_alarms += matches.false_alarms.len();
    }

    fn score(&self) -> DetectionScore {
        DetectionScore {
            n: self.objects,
            matched: self.found,
            recall: share(self.found, self.objects),
            precision: share(self.found, self.found + self.false_alarms),
        }
    }
}
