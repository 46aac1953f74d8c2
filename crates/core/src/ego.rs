//! Where the vehicle itself is, through time: told by whoever knows, asked for at the moments of captures.

use crate::{
    space::{BaseLink, Odom, Steady, Transform},
    time::Timestamp,
};
use nalgebra::{Isometry3, UnitQuaternion};
use std::{
    collections::VecDeque,
    fmt,
    sync::{Mutex, MutexGuard, OnceLock, PoisonError},
    time::Duration,
};

/// Poses that are kept at most of what is told live: a quarter of an hour at 100 Hz, 11 MB. Whoever asks for older ones
/// gets the oldest.
const MOST_POSES: usize = 90_000;
/// Beyond the newest pose the vehicle is taken to go on as it did, for so long: odometry comes at 10 Hz or more, and
/// what is older is no delay.
const GOES_ON: Duration = Duration::from_millis(500);
/// Nobody drives faster: a larger step is a new origin, not a motion, metres per second.
const MOST_SPEED_M_S: f64 = 100.0;
/// Nobody turns faster, radians per second.
const MOST_TURN_RAD_S: f64 = 5.0;
/// A pose that is older than the newest by more than this begins a recording anew; one that is less came late.
const BEGINS_ANEW: Duration = Duration::from_secs(1);

/// How the vehicle's motion is known at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EgoKnowledge {
    /// Nobody tells it: the vehicle counts as standing still, and speeds are against the vehicle.
    #[default]
    None,
    /// Between two poses that were told, or at one.
    Measured,
    /// Up to half a second beyond the last pose: it is taken to go on as it did.
    Extrapolated,
    /// Outside what was told: the vehicle counts as standing still where it was told to be last.
    Stale,
}

impl EgoKnowledge {
    /// Its name in messages.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Measured => "measured",
            Self::Extrapolated => "extrapolated",
            Self::Stale => "stale",
        }
    }
}

/// Where the vehicle is at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ego {
    /// The vehicle's pose as it is told; without odometry, the identity.
    pub odom_from_base: Transform<Odom, BaseLink>,
    /// The same without jumps.
    pub steady_from_base: Transform<Steady, BaseLink>,
    /// How it is known.
    pub knowledge: EgoKnowledge,
}

impl Default for Ego {
    fn default() -> Self {
        Self {
            odom_from_base: Transform::new(Isometry3::identity()),
            steady_from_base: Transform::new(Isometry3::identity()),
            knowledge: EgoKnowledge::None,
        }
    }
}

/// Why a pose was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PoseRefused {
    /// A coordinate is infinite or no number.
    #[error("the pose is not finite")]
    NotFinite,
    /// It is not newer than the last one.
    #[error("its stamp is not later than the last one's")]
    NotLater,
}

/// What became of the poses that were told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EgoCounts {
    /// Taken.
    pub taken: u64,
    /// Refused: not finite, not later than the last, or unreadable.
    pub refused: u64,
    /// Steps that nobody drives: a new origin. What was tracked stays where it is around the vehicle.
    pub jumps: u64,
    /// Times that stamps went back so far that everything began anew.
    pub restarts: u64,
}

/// The vehicle's poses through time. Told by one, asked by another, from any thread.
///
/// Between poses it is interpolated. In [`Steady`] the vehicle never jumps: when what is told does, it is taken to have gone on
/// as it did; when it is first told, or told anew from the begin of a recording, it is where it was.
#[derive(Default)]
pub struct EgoMotion {
    /// It never moves, and nobody need say so.
    still: bool,
    /// A recording that is looped tells the same after this time.
    lap: OnceLock<Duration>,
    told: Mutex<Told>,
}

#[derive(Default)]
struct Told {
    poses: VecDeque<Pose>,
    /// All are kept, as of a recording.
    whole: bool,
    counts: EgoCounts,
}

#[derive(Clone, Copy)]
struct Pose {
    at: Timestamp,
    odom_from_base: Isometry3<f64>,
    steady_from_base: Isometry3<f64>,
}

impl fmt::Debug for EgoMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EgoMotion({:?})", self.counts())
    }
}

impl EgoMotion {
    /// Of something that never moves: a mast, a parked car.
    #[must_use]
    pub fn still() -> Self {
        Self {
            still: true,
            ..Self::default()
        }
    }

    /// Of a recording, which is told from its first pose to its last before anybody asks: all are kept.
    #[must_use]
    pub fn recorded() -> Self {
        let told = Told {
            whole: true,
            ..Told::default()
        };
        Self {
            told: Mutex::new(told),
            ..Self::default()
        }
    }

    /// Says that what was told comes again after `lap`, as in a recording that is looped; the first word counts.
    pub fn repeat_every(&self, lap: Duration) {
        self.lap.get_or_init(|| lap);
    }

    /// Takes one more pose.
    ///
    /// # Errors
    /// When it is not finite, or not later than the last one (unless stamps went back by more than a second: then
    /// everything begins anew). It is counted.
    pub fn tell(&self, at: Timestamp, odom_from_base: Isometry3<f64>) -> Result<(), PoseRefused> {
        self.lock().take(at, odom_from_base)
    }

    /// Counts a pose as refused that never became one: a message that cannot be read.
    pub fn refuse(&self) {
        self.lock().counts.refused += 1;
    }

    /// The stamp of the newest pose; `None` before the first.
    #[must_use]
    pub fn newest(&self) -> Option<Timestamp> {
        self.lock().poses.back().map(|pose| pose.at)
    }

    /// Where the vehicle is at a moment.
    #[must_use]
    pub fn at(&self, at: Timestamp) -> Ego {
        match self.still {
            true => Ego {
                knowledge: EgoKnowledge::Measured,
                ..Ego::default()
            },
            false => self.lock().at_in_lap(at, self.lap.get().copied()),
        }
    }

    /// What became of the poses so far.
    #[must_use]
    pub fn counts(&self) -> EgoCounts {
        self.lock().counts
    }

    fn lock(&self) -> MutexGuard<'_, Told> {
        self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Told {
    fn take(&mut self, at: Timestamp, told: Isometry3<f64>) -> Result<(), PoseRefused> {
        let Some(odom_from_base) = normalised(told) else {
            self.counts.refused += 1;
            return Err(PoseRefused::NotFinite);
        };
        let last = self.poses.back().copied();
        let steady_from_base = match last {
            None => Isometry3::identity(),
            Some(last) if at > last.at => self.continued(&last, at, &odom_from_base),
            Some(last) if last.at.saturating_since(at) <= BEGINS_ANEW => {
                self.counts.refused += 1;
                return Err(PoseRefused::NotLater);
            }
            Some(last) => {
                self.poses.clear();
                self.counts.restarts += 1;
                last.steady_from_base
            }
        };
        self.poses.push_back(Pose {
            at,
            odom_from_base,
            steady_from_base,
        });
        self.counts.taken += 1;
        if self.poses.len() > MOST_POSES && !self.whole {
            self.poses.pop_front();
        }
        Ok(())
    }

    /// The next pose without a jump.
    fn continued(
        &mut self,
        last: &Pose,
        at: Timestamp,
        odom_from_base: &Isometry3<f64>,
    ) -> Isometry3<f64> {
        let step = last.odom_from_base.inverse() * odom_from_base;
        let seconds = at.saturating_since(last.at).as_secs_f64();
        let jumps = step.translation.vector.norm() > MOST_SPEED_M_S * seconds
            || step.rotation.angle() > MOST_TURN_RAD_S * seconds;
        if jumps {
            self.counts.jumps += 1;
            return last.steady_from_base
                * self.going_on(at.saturating_since(last.at).min(GOES_ON));
        }
        last.steady_from_base * step
    }

    /// The motion of the last step, carried on for some time.
    fn going_on(&self, time: Duration) -> Isometry3<f64> {
        let newest = self.poses.len().wrapping_sub(1);
        let (Some(last), Some(before)) = (
            self.poses.get(newest),
            self.poses.get(newest.wrapping_sub(1)),
        ) else {
            return Isometry3::identity();
        };
        let step = before.steady_from_base.inverse() * last.steady_from_base;
        let seconds = last.at.saturating_since(before.at).as_secs_f64();
        let share = time.as_secs_f64() / seconds.max(f64::EPSILON);
        Isometry3::from_parts(
            (step.translation.vector * share).into(),
            UnitQuaternion::from_scaled_axis(step.rotation.scaled_axis() * share),
        )
    }

    /// At the same moment of the first lap.
    fn at_in_lap(&self, at: Timestamp, lap: Option<Duration>) -> Ego {
        let first = self.poses.front().map(|pose| pose.at);
        match (first, lap.filter(|lap| !lap.is_zero())) {
            (Some(first), Some(lap)) if at > first => {
                let since = at.saturating_since(first).as_nanos() % lap.as_nanos();
                // A remainder of what fits fits.
                self.at(first.saturating_add(Duration::from_nanos(since as u64)))
            }
            _ => self.at(at),
        }
    }

    fn at(&self, at: Timestamp) -> Ego {
        let later = self.poses.partition_point(|pose| pose.at < at);
        let before = later.checked_sub(1).and_then(|at| self.poses.get(at));
        match (before, self.poses.get(later)) {
            (None, None) => Ego::default(),
            (_, Some(next)) if next.at == at => {
                next.seen_from(next.steady_from_base, EgoKnowledge::Measured)
            }
            (None, Some(first)) => first.seen_from(first.steady_from_base, EgoKnowledge::Stale),
            (Some(before), Some(next)) => {
                let share = at.saturating_since(before.at).as_secs_f64()
                    / next.at.saturating_since(before.at).as_secs_f64();
                let steady = between(&before.steady_from_base, &next.steady_from_base, share);
                next.seen_from(steady, EgoKnowledge::Measured)
            }
            (Some(last), None) => {
                let beyond = at.saturating_since(last.at);
                let knowledge = match beyond <= GOES_ON {
                    true => EgoKnowledge::Extrapolated,
                    false => EgoKnowledge::Stale,
                };
                let steady = last.steady_from_base * self.going_on(beyond.min(GOES_ON));
                last.seen_from(steady, knowledge)
            }
        }
    }
}

impl Pose {
    /// The vehicle at a pose of the steady frame, by where odom is at this one.
    fn seen_from(&self, steady_from_base: Isometry3<f64>, knowledge: EgoKnowledge) -> Ego {
        let moved = self.steady_from_base.inverse() * steady_from_base;
        Ego {
            odom_from_base: Transform::new(self.odom_from_base * moved),
            steady_from_base: Transform::new(steady_from_base),
            knowledge,
        }
    }
}

/// The pose with a rotation of exactly one; `None` where it is not finite.
fn normalised(pose: Isometry3<f64>) -> Option<Isometry3<f64>> {
    let rotation = UnitQuaternion::try_new(pose.rotation.into_inner(), f64::EPSILON)?;
    let finite = pose.translation.vector.iter().all(|one| one.is_finite())
        && rotation.coords.iter().all(|one| one.is_finite());
    finite.then_some(Isometry3::from_parts(pose.translation, rotation))
}

/// A share of the way from one pose to another; half a turn or more is not interpolated but taken as it begins.
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, share: f64) -> Isometry3<f64> {
    from.try_lerp_slerp(to, share, f64::EPSILON)
        .unwrap_or(*from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn at(millis: i64) -> Timestamp {
        Timestamp::from_nanos(1_000_000_000 + millis * 1_000_000)
    }

    fn pose(x: f64, yaw_rad: f64) -> Isometry3<f64> {
        Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * yaw_rad)
    }

    fn driving() -> EgoMotion {
        let motion = EgoMotion::default();
        for step in 0..=10 {
            let told = motion.tell(at(step * 100), pose(step as f64, 0.0));
            told.expect("a pose");
        }
        motion
    }

    fn x(motion: &EgoMotion, millis: i64) -> (f64, EgoKnowledge) {
        let ego = motion.at(at(millis));
        (ego.odom_from_base.origin().x(), ego.knowledge)
    }

    #[test]
    fn without_a_word_the_vehicle_stands_and_says_so() {
        assert_eq!(EgoMotion::default().at(at(5)), Ego::default());
    }

    #[test]
    fn the_first_word_moves_nobody() {
        let motion = EgoMotion::default();
        motion.tell(at(0), pose(500.0, 1.0)).expect("a pose");
        let ego = motion.at(at(0));
        assert_eq!(ego.steady_from_base, Ego::default().steady_from_base);
        assert!((ego.odom_from_base.yaw_rad() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn what_never_moves_is_where_it_is_at_any_time() {
        let ego = EgoMotion::still().at(at(1_000_000));
        assert_eq!(ego.knowledge, EgoKnowledge::Measured);
        assert_eq!(ego.odom_from_base, Ego::default().odom_from_base);
    }

    #[test]
    fn between_poses_it_is_interpolated_and_beyond_them_it_goes_on_for_half_a_second() {
        let motion = driving();
        assert_eq!(x(&motion, 300), (3.0, EgoKnowledge::Measured));
        let (between, known) = x(&motion, 250);
        assert!((between - 2.5).abs() < 1e-9 && known == EgoKnowledge::Measured);
        let (beyond, known) = x(&motion, 1_200);
        assert!((beyond - 12.0).abs() < 1e-9 && known == EgoKnowledge::Extrapolated);
        let (stale, known) = x(&motion, 9_000);
        assert!((stale - 15.0).abs() < 1e-9 && known == EgoKnowledge::Stale);
        assert_eq!(x(&motion, -500), (0.0, EgoKnowledge::Stale));
    }

    #[test]
    fn a_looped_recording_tells_the_same_in_every_lap() {
        let motion = driving();
        motion.repeat_every(Duration::from_millis(1_100));
        let (again, known) = x(&motion, 2_450);
        assert!((again - 2.5).abs() < 1e-9 && known == EgoKnowledge::Measured);
    }

    #[test]
    fn a_jump_is_a_new_origin_and_the_vehicle_goes_on_as_it_did() {
        let motion = driving();
        motion.tell(at(1_100), pose(511.0, 0.0)).expect("a pose");
        motion.tell(at(1_200), pose(512.0, 0.0)).expect("a pose");
        let ego = motion.at(at(1_150));
        assert_eq!(ego.knowledge, EgoKnowledge::Measured);
        // In odom it is where it is told to be.
        assert!((ego.odom_from_base.origin().x() - 511.5).abs() < 1e-9);
        assert!((ego.steady_from_base.origin().x() - 11.5).abs() < 1e-9);
        assert_eq!(motion.counts().jumps, 1);
    }

    #[test]
    fn what_is_no_pose_or_comes_late_is_refused_and_counted() {
        let motion = driving();
        let infinite = motion.tell(at(1_100), pose(f64::NAN, 0.0));
        assert_eq!(infinite, Err(PoseRefused::NotFinite));
        let late = motion.tell(at(950), pose(9.0, 0.0));
        assert_eq!(late, Err(PoseRefused::NotLater));
        assert_eq!(motion.counts().refused, 2);
        assert_eq!(motion.counts().taken, 11);
    }

    #[test]
    fn of_a_long_recording_the_first_pose_is_known_and_of_a_long_drive_the_newest() {
        for (motion, first) in [
            (EgoMotion::recorded(), 0.0),
            (EgoMotion::default(), 1_000.0),
        ] {
            for step in 0..MOST_POSES as i64 + 1_000 {
                let told = motion.tell(at(step * 100), pose(step as f64, 0.0));
                told.expect("a pose");
            }
            assert_eq!(x(&motion, 0).0, first);
        }
    }

    #[test]
    fn stamps_that_go_far_back_begin_anew() {
        let motion = driving();
        motion.tell(at(-5_000), pose(7.0, 0.0)).expect("a pose");
        assert_eq!(x(&motion, -5_000), (7.0, EgoKnowledge::Measured));
        assert_eq!(motion.counts().restarts, 1);
        let ego = motion.at(at(-5_000));
        assert_eq!(ego.steady_from_base.origin().x(), 10.0);
    }
}
