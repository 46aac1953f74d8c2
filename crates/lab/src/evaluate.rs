//! Evaluation: detections of a whole dataset against its labels, every method side by side.

use crate::{
    baseline::Baseline,
    bootstrap::Intervals,
    identity::{IdentityReport, IdentityScore, Judge, SeenTrack, SeenTruth, Sighting},
    matching::{Matches, TruthFilter, match_image},
    motion::{MotionReport, TrueMotion, VelocityError},
    recorder::{Answer, Recorded, Recording},
    report::{DetectionScore, Report},
    sample::{Estimator, Sample, Target},
    sample_table::SampleTable,
    score::{Figures, share},
    truth::Truth,
};
use roadwatch_camera::RigDataset;
use roadwatch_core::{CameraId, Detection, Known, Locator, Method, Rig, Timestamp};
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

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
    /// Where it was said to be, and which way it points; `None` when no place was published for it.
    published: Option<Answer>,
    /// The same by this frame alone.
    single: Option<Answer>,
    known: Known,
    target: Arc<Target>,
}

/// Everything recorded, matched to the labels.
#[derive(Default)]
struct Matched<'a> {
    images: usize,
    perceived: usize,
    false_alarms: usize,
    targets: Vec<Arc<Target>>,
    pairs: Vec<Pair<'a>>,
    sightings: Vec<Sighting>,
    velocities: Vec<VelocityError>,
}

/// Matches everything recorded to the labels, and scores each method on the same matches, and each baseline's
/// identities on the same objects.
#[must_use]
pub fn evaluate(
    evaluation: &Evaluation<'_>,
    recording: &Recording,
    methods: &[MethodUnderTest],
    baselines: Vec<Baseline>,
) -> Report {
    let motion = TrueMotion::of(evaluation.dataset, evaluation.truth);
    let matched = evaluation.matched(&recording.frames, &motion);
    let identity_baselines = baselines.into_iter().map(|baseline| {
        let (name, renamed) = baseline.rename(&recording.frames);
        let sightings = evaluation.matched(&renamed, &motion).sightings;
        (name, IdentityReport::of(&sightings))
    });
    let identity_baselines = identity_baselines.collect();
    let (mut samples, mut unavailable) = (matched.said(), BTreeMap::new());
    for MethodUnderTest { method, locators } in methods {
        match locators {
            Ok(locators) => samples.extend(matched.located_by(*method, locators)),
            Err(reason) => {
                unavailable.insert(*method, reason.clone());
            }
        }
    }
    let detection = matched.detection();
    let table = SampleTable {
        targets: matched.targets,
        samples,
    };
    let figures = |estimator| Figures::of(table.of(estimator));
    let (published, single) = (figures(Estimator::Published), figures(Estimator::Single));
    let of_method =
        |tested: &MethodUnderTest| (tested.method, figures(Estimator::By(tested.method)));
    let estimators = table.estimators().into_iter();
    let judge = evaluation.judge(&motion, &matched.sightings);
    let moments = judge.moments(&recording.scenes);
    let scene_identity = (!moments.is_empty()).then(|| IdentityScore::of(&moments));
    Report {
        frames: matched.perceived,
        frames_missing: matched.images - matched.perceived,
        filter: evaluation.filter.clone(),
        detection,
        published,
        single,
        methods: methods.iter().map(of_method).collect(),
        unavailable,
        identity: IdentityReport {
            scene: scene_identity,
            ..IdentityReport::of(&matched.sightings)
        },
        identity_baselines,
        motion: MotionReport::of(&matched.velocities),
        intervals: estimators
            .map(|who| (who, Intervals::of(table.of(who))))
            .collect(),
        latency: None,
        table,
    }
}

impl Evaluation<'_> {
    /// Every image of the dataset up to the limit: camera, stamp, frame number.
    pub fn images(&self) -> impl Iterator<Item = (CameraId, Timestamp, u64)> {
        let limit = self.frame_limit.map_or(usize::MAX, |limit| {
            usize::try_from(limit).unwrap_or(usize::MAX)
        });
        self.rig.ids().flat_map(move |camera| {
            let frames = self.dataset.frames().iter();
            let captured = frames.filter_map(move |frame| {
                // Cameras beyond the dataset's are the configuration's own: nothing of theirs is labelled.
                let stamp = (*frame.stamps.get(camera.index())?)?;
                Some((camera, stamp, frame.number))
            });
            captured.take(limit)
        })
    }

    /// Every detection that was taken for an object that is scored, with that object.
    #[must_use]
    pub fn pairs(&self, recorded: &[Recorded]) -> Vec<(Detection, Arc<Target>)> {
        let motion = TrueMotion::of(self.dataset, self.truth);
        let pairs = self.matched(recorded, &motion).pairs.into_iter();
        pairs
            .map(|pair| (pair.detection.clone(), pair.target))
            .collect()
    }

    fn matched<'r>(&self, recorded: &'r [Recorded], motion: &TrueMotion) -> Matched<'r> {
        let by_moment: HashMap<_, _> = recorded
            .iter()
            .map(|frame| ((frame.camera, frame.captured_at), frame))
            .collect();
        let mut matched = Matched::default();
        for (camera, captured_at, number) in self.images() {
            matched.images += 1;
            match by_moment.get(&(camera, captured_at)) {
                Some(frame) => self.match_frame(&mut matched, (frame, number), motion),
                None if self.lost_images == LostImages::Ignore => {}
                None => self.miss_all(&mut matched, camera, number),
            }
        }
        matched
    }

    /// Of an image that was lost nothing is found.
    fn miss_all(&self, matched: &mut Matched<'_>, camera: CameraId, number: u64) {
        let camera = self.rig.camera(camera);
        let objects = self.truth.objects(number, camera.name.as_str()).iter();
        let missed = objects.filter(|object| self.filter.admits(object));
        let targets = missed.map(|object| Arc::new(Target::new(object, camera, false)));
        matched.targets.extend(targets);
    }

    fn match_frame<'r>(
        &self,
        matched: &mut Matched<'r>,
        (frame, number): (&'r Recorded, u64),
        motion: &TrueMotion,
    ) {
        let camera = self.rig.camera(frame.camera);
        let labels = self.truth.labels(number, camera.name.as_str());
        let detections: Vec<&Detection> = frame.detections().collect();
        let matches = match_image(&detections, labels, self.filter);
        matched.perceived += 1;
        matched.false_alarms += matches.false_alarms.len();
        matched
            .sightings
            .push(self.sighting(frame, number, &matches));
        let taken: HashMap<usize, usize> = matches.pairs.iter().map(|&(d, o)| (o, d)).collect();
        let objects = labels.objects.iter().enumerate();
        for (at, object) in objects.filter(|(_, object)| self.filter.admits(object)) {
            let detection = taken.get(&at);
            let track = detection.and_then(|&at| frame.tracks.get(at));
            matched
                .velocities
                .extend(track.and_then(|track| {
                    motion.judge((&object.id, number), track, frame.captured_at)
                }));
            let target = Arc::new(Target::new(object, camera, detection.is_some()));
            matched.targets.push(Arc::clone(&target));
            matched.pairs.extend(detection.map(|&detection| Pair {
                camera: frame.camera.index(),
                detection: detections[detection],
                published: frame.published(detection, camera),
                single: frame.single(detection),
                known: frame.known(detection),
                target,
            }));
        }
    }
}

impl Evaluation<'_> {
    /// What the identities of scenes are judged by.
    fn judge<'a>(&'a self, motion: &'a TrueMotion, sightings: &'a [Sighting]) -> Judge<'a> {
        let mut labelled: BTreeMap<u64, BTreeSet<&str>> = BTreeMap::new();
        let mut frames = BTreeMap::new();
        for (camera, captured_at, number) in self.images() {
            let camera = self.rig.camera(camera).name.as_str();
            let objects = self.truth.objects(number, camera).iter();
            let scored = objects.filter(|object| self.filter.may_stand_for_scored(&object.class));
            let names = labelled.entry(number).or_default();
            names.extend(scored.map(|object| object.id.as_str()));
            frames.insert(captured_at, number);
        }
        Judge {
            motion,
            sightings,
            labelled,
            frames,
        }
    }

    /// What is scored of identities in one image: objects, the tracks that were found of them, and which is which.
    fn sighting(&self, frame: &Recorded, number: u64, matches: &Matches) -> Sighting {
        let camera = self.rig.camera(frame.camera).name.as_str();
        let labels = self.truth.objects(number, camera).iter().enumerate();
        let scored: Vec<_> = labels
            .filter(|(_, object)| self.filter.admits(object))
            .collect();
        let matched = matches.pairs.iter().map(|&(detection, _)| detection);
        // What has no place has no identity, and false alarms are counted where detection is.
        let judged: Vec<usize> = matched.filter(|&at| at < frame.tracks.len()).collect();
        let place = |&(detection, object): &(usize, usize)| {
            let truth = scored.iter().position(|&(at, _)| at == object)?;
            let found = judged.iter().position(|&at| at == detection)?;
            Some((truth, found))
        };
        Sighting {
            camera: frame.camera,
            number,
            pairs: matches.pairs.iter().filter_map(place).collect(),
            truths: scored
                .iter()
                .map(|(_, object)| SeenTruth {
                    id: object.id.clone(),
                    box_px: object.box_px,
                    center: object.center,
                })
                .collect(),
            found: judged
                .iter()
                .map(|&at| {
                    let track = &frame.tracks[at];
                    let located = &track.observed.located;
                    SeenTrack {
                        id: track.id.0,
                        box_px: located.detection.box_px,
                        center: track.position(),
                    }
                })
                .collect(),
        }
    }
}

impl Matched<'_> {
    fn said(&self) -> Vec<Sample> {
        let judge = |who, pair: &Pair<'_>, answer: &Option<Answer>| {
            let answer = answer.as_ref();
            let answer = answer.map(|(location, heading)| (location, *heading));
            Sample::judge(who, &pair.target, answer)
        };
        let published = self.pairs.iter();
        let published = published.map(|pair| judge(Estimator::Published, pair, &pair.published));
        let single = self.pairs.iter();
        let single = single.map(|pair| judge(Estimator::Single, pair, &pair.single));
        published.chain(single).collect()
    }

    fn located_by(
        &self,
        method: Method,
        locators: &[Box<dyn Locator>],
    ) -> impl Iterator<Item = Sample> {
        self.pairs.iter().map(move |pair| {
            let found = locators[pair.camera].locate(pair.detection, &pair.known);
            let answer = found.as_ref().map(|location| (location, None));
            Sample::judge(Estimator::By(method), &pair.target, answer)
        })
    }

    /// Objects outside the filter count neither for nor against.
    fn detection(&self) -> DetectionScore {
        let (objects, found) = (self.targets.len(), self.pairs.len());
        DetectionScore {
            n: objects,
            matched: found,
            recall: share(found, objects),
            precision: share(found, found + self.false_alarms),
        }
    }
}
