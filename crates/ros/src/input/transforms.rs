//! Transforms between frames through time, and where a chain of them puts one frame in another.

use crate::msg::geometry_msgs::TransformStamped;
use nalgebra::{Isometry3, UnitQuaternion};
use roadwatch_core::Timestamp;
use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    time::Duration,
};

/// Longer chains of frames are circles.
const LONGEST_CHAIN: usize = 32;
/// Frames that are remembered at most: a vehicle has some hundred.
const MOST_FRAMES: usize = 10_000;
/// Steps of a moving frame that are kept: the pieces of a chain come at their own pace, some a second ahead.
const MOST_STEPS: usize = 256;
/// A stamp that jumps back by more is a recording that begins anew; less came late.
const BEGINS_ANEW: Duration = Duration::from_secs(1);
/// Places that differ by less, metres or radians, are one place that two publishers rounded.
const SAME: f64 = 1e-3;

/// How a frame moves in its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moves {
    /// Told once, for all time: `/tf_static`.
    Never,
    /// Told again and again: `/tf`.
    Always,
}

/// What cannot be of a transform; said once of each frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Oddity {
    TwoPlaces,
    Late,
    NoTransform,
}

impl Oddity {
    const fn as_str(self) -> &'static str {
        match self {
            Self::TwoPlaces => {
                "a frame is told to be in two places at once, by two publishers or with a stamp that stands still: the \
                 last one counts"
            }
            Self::Late => "a transform comes later than a newer one: it is left out",
            Self::NoTransform => "a transform is not finite, or no rotation: it is left out",
        }
    }
}

/// Frames with their parents.
#[derive(Debug, Default)]
pub(super) struct Transforms {
    frames: BTreeMap<String, Edge>,
    said: BTreeSet<(String, Oddity)>,
}

/// From a frame to its parent.
#[derive(Debug)]
struct Edge {
    parent: String,
    moves: Moves,
    newest: Step,
    /// Older ones, oldest first; none of a frame that never moves.
    older: VecDeque<Step>,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    at: Timestamp,
    parent_from_child: Isometry3<f64>,
}

impl Transforms {
    /// Takes one transform in.
    pub(super) fn take(&mut self, transform: &TransformStamped, moves: Moves) {
        let child = bare(&transform.child_frame_id);
        let parent = bare(&transform.header.frame_id);
        let Some(parent_from_child) = rigid((&transform.transform).into()) else {
            self.say(child, parent, Oddity::NoTransform);
            return;
        };
        let step = Step {
            at: transform.header.stamp.into(),
            parent_from_child,
        };
        let has_room = self.frames.len() < MOST_FRAMES;
        let odd = match self.frames.get_mut(child) {
            Some(edge) if edge.parent == parent && edge.moves == moves => edge.follow(step),
            Some(edge) => {
                *edge = Edge::new(parent, moves, step);
                Some(Oddity::TwoPlaces)
            }
            None if has_room => {
                let edge = Edge::new(parent, moves, step);
                self.frames.insert(child.to_owned(), edge);
                None
            }
            None => None,
        };
        if let Some(odd) = odd {
            self.say(child, parent, odd);
        }
    }

    /// Where `child` is in `of`, at the newest moment of which all moving pieces of the chain tell; `None` while no
    /// chain leads there, or nothing in it moves.
    pub(super) fn pose(&self, of: &str, child: &str) -> Option<(Timestamp, Isometry3<f64>)> {
        let chain = self.chain(of, child)?;
        let moving = chain.iter().filter(|edge| edge.moves == Moves::Always);
        let at = moving.map(|edge| edge.newest.at).min()?;
        let mut pose = Isometry3::identity();
        for edge in chain {
            pose = edge.at(at)? * pose;
        }
        Some((at, pose))
    }

    /// The frames that are known, each with its parent: `odom -> base_link`.
    pub(super) fn known(&self) -> impl Iterator<Item = String> {
        let edges = self.frames.iter();
        edges.map(|(child, edge)| format!("{} -> {child}", edge.parent))
    }

    /// The edges from `child` up to `of`.
    fn chain(&self, of: &str, child: &str) -> Option<Vec<&Edge>> {
        let (mut frame, mut chain) = (child, Vec::new());
        while frame != of {
            if chain.len() == LONGEST_CHAIN {
                return None;
            }
            let edge = self.frames.get(frame)?;
            frame = &edge.parent;
            chain.push(edge);
        }
        Some(chain)
    }

    fn say(&mut self, frame: &str, parent: &str, odd: Oddity) {
        if self.said.len() < MOST_FRAMES && self.said.insert((frame.to_owned(), odd)) {
            tracing::warn!(%frame, %parent, "{}", odd.as_str());
        }
    }
}

impl Edge {
    fn new(parent: &str, moves: Moves, newest: Step) -> Self {
        Self {
            parent: parent.to_owned(),
            moves,
            newest,
            older: VecDeque::new(),
        }
    }

    /// Takes the next step in, and says what is odd about it.
    fn follow(&mut self, step: Step) -> Option<Oddity> {
        let before = self.newest;
        let differs = differ(&before.parent_from_child, &step.parent_from_child);
        if self.moves == Moves::Never || step.at == before.at {
            self.newest = step;
            return differs.then_some(Oddity::TwoPlaces);
        }
        if step.at < before.at {
            if before.at.saturating_since(step.at) <= BEGINS_ANEW {
                return Some(Oddity::Late);
            }
            self.older.clear();
        } else {
            self.older.push_back(before);
            if self.older.len() >= MOST_STEPS {
                self.older.pop_front();
            }
        }
        self.newest = step;
        None
    }

    /// Where it was at a moment, not after its newest step; `None` before its first.
    fn at(&self, at: Timestamp) -> Option<Isometry3<f64>> {
        if self.moves == Moves::Never || at >= self.newest.at {
            return Some(self.newest.parent_from_child);
        }
        let later = self.older.partition_point(|step| step.at <= at);
        let from = self.older.get(later.checked_sub(1)?)?;
        let to = self.older.get(later).unwrap_or(&self.newest);
        let share = at.saturating_since(from.at).as_secs_f64()
            / to.at.saturating_since(from.at).as_secs_f64();
        let (from, to) = (&from.parent_from_child, &to.parent_from_child);
        // Half a turn between two steps is not interpolated.
        Some(
            from.try_lerp_slerp(to, share, f64::EPSILON)
                .unwrap_or(*from),
        )
    }
}

/// A frame's name; ROS 1 led them with a slash.
pub(super) fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

/// With a rotation of exactly one; `None` where it is none.
fn rigid(transform: Isometry3<f64>) -> Option<Isometry3<f64>> {
    let rotation = UnitQuaternion::try_new(transform.rotation.into_inner(), f64::EPSILON)?;
    let mut numbers = transform
        .translation
        .vector
        .iter()
        .chain(rotation.coords.iter());
    let is_finite = numbers.all(|one| one.is_finite());
    is_finite.then_some(Isometry3::from_parts(transform.translation, rotation))
}

fn differ(one: &Isometry3<f64>, other: &Isometry3<f64>) -> bool {
    let off = one.inverse() * other;
    off.translation.vector.norm() > SAME || off.rotation.angle() > SAME
}

#[cfg(test)]
mod tests;
