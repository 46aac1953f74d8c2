//! Makes poses of messages, and says what is wrong with them.

use super::EgoSource;
use crate::{
    input::transforms::{Moves, Transforms, bare},
    msg::{geometry_msgs::TransformStamped, nav_msgs::Odometry},
};
use nalgebra::Isometry3;
use roadwatch_core::{EgoMotion, Timestamp};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
    time::{Duration, Instant},
};

/// Messages between two complaints of the same kind.
const COMPLAIN_EVERY: u64 = 1000;
/// Frames that are listed at most.
const MOST_LISTED: usize = 12;
/// Nobody starts so slowly: what has told nothing by then is said.
const FIRST_WORD: Duration = Duration::from_secs(10);
/// Odometry comes several times a second: what is silent for longer has stopped.
const SILENCE: Duration = Duration::from_secs(2);

/// Where the vehicle is, and when.
pub(super) type Pose = (Timestamp, Isometry3<f64>);

/// Takes messages, tells poses.
pub(super) struct Teller {
    source: EgoSource,
    transforms: Transforms,
    motion: Arc<EgoMotion>,
    /// What the transforms said last.
    last: Option<Pose>,
    /// Messages that were not taken, by reason.
    refused: BTreeMap<&'static str, u64>,
    /// Other frames that odometry tells of.
    others: BTreeSet<String>,
    said_no_covariance: bool,
    silence: Silence,
}

impl Teller {
    pub(super) fn new(source: EgoSource, motion: Arc<EgoMotion>, now: Instant) -> Self {
        Self {
            source,
            transforms: Transforms::default(),
            motion,
            last: None,
            refused: BTreeMap::new(),
            others: BTreeSet::new(),
            said_no_covariance: false,
            silence: Silence::from(now),
        }
    }

    /// The vehicle's pose; `None`, said once by name, where another frame's is told.
    pub(super) fn pose_of(&mut self, message: &Odometry) -> Option<Pose> {
        let (topic, base_frame) = (self.source.topic(), self.source.base_frame());
        let child = bare(&message.child_frame_id);
        if !child.is_empty() && child != base_frame {
            if self.others.len() < MOST_LISTED && self.others.insert(child.to_owned()) {
                tracing::warn!(%topic, "odometry of `{child}` is not taken: the vehicle is `{base_frame}`");
            }
            return None;
        }
        if message.pose.covariance[0][0] <= 0.0 && !self.said_no_covariance {
            self.said_no_covariance = true;
            tracing::warn!(%topic, "odometry has no covariance: it is taken as exact");
        }
        Some((
            message.header.stamp.into(),
            Isometry3::from(&message.pose.pose),
        ))
    }

    /// Takes one transform in. Tells where the vehicle is when that follows anew.
    pub(super) fn transform(&mut self, transform: &TransformStamped, moves: Moves) {
        let EgoSource::Transforms {
            odom_frame,
            base_frame,
            ..
        } = &self.source
        else {
            return;
        };
        self.transforms.take(transform, moves);
        let pose = self.transforms.pose(odom_frame, base_frame);
        if let Some(pose) = pose.filter(|pose| self.last.as_ref() != Some(pose)) {
            self.last = Some(pose);
            self.tell(pose);
        }
    }

    pub(super) fn tell(&mut self, (at, pose): Pose) {
        if at == Timestamp::from_nanos(0) {
            self.motion.refuse();
            self.complain("it has no stamp", "its publisher leaves it zero");
        } else if let Err(refused) = self.motion.tell(at, pose) {
            self.complain("it cannot be", &refused.to_string());
        }
    }

    /// A message that cannot be read.
    pub(super) fn unreadable(&mut self, why: &str) {
        self.motion.refuse();
        self.complain("it cannot be read", why);
    }

    /// A message of a second publisher.
    pub(super) fn second_publisher(&mut self) {
        self.motion.refuse();
        self.complain("two publishers", "what the second says is not looked at");
    }

    fn complain(&mut self, reason: &'static str, why: &str) {
        let count = self.refused.entry(reason).or_default();
        *count += 1;
        if *count % COMPLAIN_EVERY == 1 {
            let topic = self.source.topic();
            tracing::warn!(%topic, count = *count, "a pose of the vehicle is not taken: {reason}: {why}");
        }
    }

    /// Says when nothing was told for too long, and when it goes on. To be called several times a second.
    pub(super) fn look(&mut self, now: Instant) {
        let taken = self.motion.counts().taken;
        let topic = self.source.topic();
        match self.silence.look(taken, now) {
            None => {}
            Some(Change::NeverSpoke) => {
                let why = self.why_nothing();
                tracing::warn!(%topic, "nothing says where the vehicle is: {why}");
            }
            Some(Change::Stopped) => {
                tracing::warn!(%topic, taken, "nothing says any more where the vehicle is: it counts as standing");
            }
            Some(Change::GoesOn) => {
                tracing::info!(%topic, taken, "it is known again where the vehicle is")
            }
        }
    }

    /// Why nothing was taken, as far as it can be seen.
    pub(super) fn why_nothing(&self) -> String {
        let base_frame = self.source.base_frame();
        if let Some((reason, count)) = self.refused.iter().max_by_key(|(_, count)| **count) {
            return format!("not taken {count} times: {reason}");
        }
        match &self.source {
            EgoSource::Odometry { .. } => match self.others.is_empty() {
                true => "there is no message".to_owned(),
                false => format!(
                    "it tells of {}, and not of `{base_frame}`",
                    listed(self.others.iter().cloned())
                ),
            },
            EgoSource::Transforms { odom_frame, .. } => format!(
                "no moving transforms lead from `{odom_frame}` to `{base_frame}`; there are {}",
                listed(self.transforms.known())
            ),
        }
    }
}

fn listed(names: impl Iterator<Item = String>) -> String {
    let mut names: Vec<_> = names.take(MOST_LISTED + 1).collect();
    if names.len() > MOST_LISTED {
        names[MOST_LISTED] = "…".to_owned();
    }
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}

/// What changed about who tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    NeverSpoke,
    Stopped,
    GoesOn,
}

/// Notices when nobody tells any more.
#[derive(Debug)]
struct Silence {
    heard: Instant,
    taken: u64,
    is_said: bool,
}

impl Silence {
    fn from(now: Instant) -> Self {
        Self {
            heard: now,
            taken: 0,
            is_said: false,
        }
    }

    fn look(&mut self, taken: u64, now: Instant) -> Option<Change> {
        if taken != self.taken {
            self.taken = taken;
            self.heard = now;
            let was_said = std::mem::take(&mut self.is_said);
            return was_said.then_some(Change::GoesOn);
        }
        let (patience, change) = match self.taken {
            0 => (FIRST_WORD, Change::NeverSpoke),
            _ => (SILENCE, Change::Stopped),
        };
        if self.is_said || now - self.heard < patience {
            return None;
        }
        self.is_said = true;
        Some(change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_is_said_once_and_so_is_its_end() {
        let start = Instant::now();
        let secs = |secs| start + Duration::from_secs(secs);
        let mut silence = Silence::from(start);
        let looks = [
            (0, 9),
            (0, 10),
            (0, 30),
            (5, 31),
            (6, 32),
            (6, 33),
            (6, 34),
            (6, 60),
            (7, 61),
        ];
        let said = looks.map(|(taken, at)| silence.look(taken, secs(at)));
        let expected = [
            None,
            Some(Change::NeverSpoke),
            None,
            Some(Change::GoesOn),
            None,
            None,
            Some(Change::Stopped),
            None,
            Some(Change::GoesOn),
        ];
        assert_eq!(said, expected);
    }
}
