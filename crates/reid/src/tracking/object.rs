//! One tracked object: its belief through the last moments, so that what comes late finds its place.

use super::{
    filter::{Filter, Fix, HEADING, Mobility, Surprise, VEHICLE, WALKER},
    heading::Look,
    view::{Glimpse, Solid, View},
};
use nalgebra::{Point3, Vector2};
use roadwatch_core::{CameraId, Ego, ObjectClass, Oriented, SizeLwh, Timestamp, TrackId};
use std::{collections::VecDeque, time::Duration};

/// What is older can no longer be corrected: cameras that are later than this are broken.
const CORRECTABLE: Duration = Duration::from_millis(500);
/// Moments that can be corrected at most: six cameras at 15 Hz for half a second would be 45; who is seen by more than
/// two at once is rare.
const MOST_STEPS: usize = 16;
/// Votes fade to this share from sight to sight, so that a class settles within a second and can still change.
const VOTES_KEPT: f64 = 0.97;
/// How much a new height counts at the least: ground rises and falls.
const LEAST_HEIGHT_SHARE: f64 = 0.05;
/// How often a trail gets a point.
const TRAIL_EVERY: Duration = Duration::from_millis(200);
/// How many: five seconds.
const TRAIL_POINTS: usize = 25;

/// What one frame says of an object.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    /// Where it is; `None` where the frame did not tell.
    pub(super) fix: Option<Fix>,
    /// Which way it points; `None` where nobody looked.
    pub(super) look: Option<Look>,
    /// Whether the vehicle's own motion is known, so that what moves is known to move.
    pub(super) over_ground: bool,
}

/// A moment something was said of it, and the belief after that.
#[derive(Clone, Debug)]
struct Step {
    at: Timestamp,
    evidence: Evidence,
    after: Filter,
}

#[derive(Clone, Debug)]
struct Vote {
    class: ObjectClass,
    size: SizeLwh,
    weight: f64,
}

/// One tracked object.
#[derive(Debug)]
pub(super) struct Object {
    pub(super) id: TrackId,
    pub(super) first_seen: Timestamp,
    /// By the newest frame that showed it.
    pub(super) seen_at: Timestamp,
    /// Frames that showed it.
    pub(super) hits: u32,
    /// How long cameras have looked for it in vain since.
    pub(super) missed: Duration,
    pub(super) observed: Oriented,
    /// When it last showed its heading.
    pub(super) heading_at: Option<Timestamp>,
    /// The last of each camera.
    pub(super) glimpses: Vec<Glimpse>,
    /// Whether the vehicle's motion was known when it was last seen.
    over_ground: bool,
    steps: VecDeque<Step>,
    /// Whether steps were forgotten.
    is_old: bool,
    votes: Vec<Vote>,
    /// Height of the centre in the steady frame, and of the variance of its last fix.
    height_m: f64,
    trail: VecDeque<(Timestamp, Point3<f64>)>,
}

/// One sight of an object.
pub(super) struct Sight<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) observed: &'a Oriented,
    pub(super) evidence: Evidence,
    /// Of the centre, in the steady frame.
    pub(super) height_m: f64,
}

/// Classes that detectors take for each other, by how they move.
pub(super) fn mobility(class: &ObjectClass) -> Mobility {
    match class.as_str() {
        "person" | "dog" | "cat" => WALKER,
        _ => VEHICLE,
    }
}

impl Object {
    /// Seen for the first time; `None` where the frame does not say where.
    pub(super) fn new(id: TrackId, sight: &Sight<'_>) -> Option<Self> {
        let at = sight.view.at;
        let fix = sight.evidence.fix.as_ref()?;
        let class = &sight.observed.located.detection.class;
        let mut object = Self {
            id,
            first_seen: at,
            seen_at: at,
            hits: 0,
            missed: Duration::ZERO,
            observed: sight.observed.clone(),
            heading_at: None,
            glimpses: Vec::new(),
            over_ground: sight.evidence.over_ground,
            steps: VecDeque::new(),
            is_old: false,
            votes: Vec::new(),
            height_m: sight.height_m,
            trail: VecDeque::new(),
        };
        let mut first = Filter::new(fix, mobility(class));
        first.take_rest(&sight.evidence);
        object.steps.push_back(Step {
            at,
            evidence: sight.evidence.clone(),
            after: first,
        });
        object.note(sight);
        Some(object)
    }

    /// Takes in another sight. False when it came too late to say anything of the object's motion.
    pub(super) fn see(&mut self, sight: &Sight<'_>) -> bool {
        let in_time = self.correct(sight.view.at, &sight.evidence);
        self.note(sight);
        in_time
    }

    fn correct(&mut self, at: Timestamp, evidence: &Evidence) -> bool {
        let later = self.steps.iter().rev().take_while(|step| step.at > at);
        let place = self.steps.len() - later.count();
        if place == 0 {
            // Before it was first seen, or before what is remembered.
            return !self.is_old && self.begin_earlier(at, evidence);
        }
        let after = self.steps[place - 1].after.clone();
        self.steps.insert(
            place,
            Step {
                at,
                evidence: evidence.clone(),
                after,
            },
        );
        self.replay(place);
        self.forget_steps();
        true
    }

    fn begin_earlier(&mut self, at: Timestamp, evidence: &Evidence) -> bool {
        let (Some(fix), Some(first)) = (&evidence.fix, self.steps.front()) else {
            return false;
        };
        let mut after = Filter::new(fix, first.after.mobility);
        after.take_rest(evidence);
        self.steps.push_front(Step {
            at,
            evidence: evidence.clone(),
            after,
        });
        self.replay(1);
        self.forget_steps();
        true
    }

    /// Believes anew from a step on.
    fn replay(&mut self, from: usize) {
        for at in from..self.steps.len() {
            let before = &self.steps[at - 1];
            let (mut belief, since) = (before.after.clone(), before.at);
            let step = &mut self.steps[at];
            belief.predict(step.at.saturating_since(since).as_secs_f64());
            if let Some(fix) = &step.evidence.fix {
                belief.correct(fix);
            }
            belief.take_rest(&step.evidence);
            if belief.is_sound() {
                step.after = belief;
            }
        }
    }

    fn forget_steps(&mut self) {
        let newest = self.steps.back().map(|step| step.at);
        let too_old =
            |step: &Step| newest.is_some_and(|n| n.saturating_since(step.at) > CORRECTABLE);
        while self.steps.len() > 1
            && (self.steps.len() > MOST_STEPS || self.steps.front().is_some_and(too_old))
        {
            self.steps.pop_front();
            self.is_old = true;
        }
    }

    /// What the filter does not hold.
    fn note(&mut self, sight: &Sight<'_>) {
        let at = sight.view.at;
        self.hits = self.hits.saturating_add(1);
        self.vote(sight.observed);
        let share = (1.0 / f64::from(self.hits)).max(LEAST_HEIGHT_SHARE);
        self.height_m += (sight.height_m - self.height_m) * share;
        if sight.evidence.look.is_some() {
            self.heading_at = self.heading_at.max(Some(at));
        }
        if at >= self.seen_at {
            self.seen_at = at;
            self.missed = Duration::ZERO;
            self.observed = sight.observed.clone();
            self.over_ground = sight.evidence.over_ground;
        }
        let solid = self.solid_at(at);
        let glimpse = sight
            .view
            .glimpse(sight.observed.located.detection.box_px, &solid.center);
        self.glimpses.retain(|one| one.camera != glimpse.camera);
        self.glimpses.push(glimpse);
    }

    fn vote(&mut self, observed: &Oriented) {
        let detection = &observed.located.detection;
        for vote in &mut self.votes {
            vote.weight *= VOTES_KEPT;
        }
        let weight = f64::from(detection.score.get());
        let size = observed.located.location.size;
        match self
            .votes
            .iter_mut()
            .find(|vote| vote.class == detection.class)
        {
            Some(vote) => {
                vote.weight += weight;
                vote.size = size;
            }
            None => self.votes.push(Vote {
                class: detection.class.clone(),
                size,
                weight,
            }),
        }
    }

    fn settled(&self) -> &Vote {
        let best = |best: usize, at: usize| {
            if self.votes[at].weight > self.votes[best].weight {
                at
            } else {
                best
            }
        };
        &self.votes[(1..self.votes.len()).fold(0, best)]
    }

    /// What it is, by all frames.
    pub(super) fn class(&self) -> &ObjectClass {
        &self.settled().class
    }

    /// Share of a class among all that frames said of it.
    pub(super) fn share_of(&self, class: &ObjectClass) -> f64 {
        let (mut of_class, mut all) = (0.0, 0.0);
        for vote in &self.votes {
            all += vote.weight;
            if vote.class == *class {
                of_class += vote.weight;
            }
        }
        of_class / all
    }

    /// How large things of its class are.
    pub(super) fn size(&self) -> SizeLwh {
        self.settled().size
    }

    /// Whether the vehicle's motion was known when it was last seen.
    pub(super) fn is_over_ground(&self) -> bool {
        self.over_ground
    }

    pub(super) fn height_m(&self) -> f64 {
        self.height_m
    }

    fn step_before(&self, at: Timestamp) -> &Step {
        // Nearly always it is the last.
        if let Some(last) = self.steps.back().filter(|last| last.at <= at) {
            return last;
        }
        let place = self.steps.partition_point(|step| step.at <= at);
        // There is always one.
        &self.steps[place.saturating_sub(1)]
    }

    /// The belief at a moment.
    pub(super) fn belief_at(&self, at: Timestamp) -> Filter {
        let step = self.step_before(at);
        let mut belief = step.after.clone();
        belief.predict(at.saturating_since(step.at).as_secs_f64());
        belief
    }

    /// How much a place at a moment surprises; `None` when by more than `most` squared deviations.
    pub(super) fn surprise_at(&self, at: Timestamp, fix: &Fix, most: f64) -> Option<Surprise> {
        let step = self.step_before(at);
        let seconds = at.saturating_since(step.at).as_secs_f64();
        step.after.surprise_after(seconds, fix, most)
    }

    /// Where it will be at a moment, without the cost of how well that is known.
    pub(super) fn solid_at(&self, at: Timestamp) -> Solid {
        let step = self.step_before(at);
        let seconds = at.saturating_since(step.at).as_secs_f64();
        let place = step.after.position_after(seconds);
        Solid {
            center: Point3::new(place.x, place.y, self.height_m),
            size: self.size(),
            heading_rad: step.after.heading_known.then(|| step.after.mean[HEADING]),
        }
    }

    /// The cameras of the newest frame that showed it.
    pub(super) fn last_seen_by(&self) -> Vec<CameraId> {
        let glimpses = self.glimpses.iter();
        let last = glimpses.filter(|one| one.at == self.seen_at);
        last.map(|one| one.camera).collect()
    }

    /// Where it was believed to be when it was last corrected.
    pub(super) fn last_place(&self) -> Vector2<f64> {
        self.step_before(self.seen_at).after.position()
    }

    /// Keeps where it was at the moment of a scene.
    pub(super) fn leave_trail(&mut self, at: Timestamp) {
        let due = self
            .trail
            .back()
            .is_none_or(|(last, _)| at.saturating_since(*last) >= TRAIL_EVERY);
        if due {
            self.trail.push_back((at, self.solid_at(at).center));
            if self.trail.len() > TRAIL_POINTS {
                self.trail.pop_front();
            }
        }
    }

    /// Where it was, oldest first, in base_link of a moment.
    pub(super) fn trail(&self, ego: &Ego) -> impl Iterator<Item = Point3<f64>> {
        let base_from_steady = ego.steady_from_base.isometry.inverse();
        self.trail
            .iter()
            .map(move |(_, point)| base_from_steady * point)
    }
}

impl Filter {
    /// Takes in what is not a place.
    fn take_rest(&mut self, evidence: &Evidence) {
        if let Some(look) = &evidence.look {
            self.look(look);
        }
        if evidence.over_ground {
            self.keep_to_heading();
            self.turn_to_motion();
        }
    }
}
