//! What is believed of one object: an extended Kalman filter over place, motion and heading, which takes into account that fixes
//! share most of their errors.

use super::lasting::Lasting;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};
use roadwatch_core::{CameraId, angle::wrapped};
use std::f64::consts::PI;

/// Numbers of the state.
pub(super) const DIMS: usize = 8;
/// The state: position (0, 1), velocity (2, 3) and acceleration (4, 5) in the steady frame; heading (6) and turn rate (7).
pub(super) type State = SVector<f64, DIMS>;
pub(super) type StateCovariance = SMatrix<f64, DIMS, DIMS>;
pub(super) type Row = SMatrix<f64, 1, DIMS>;

pub(super) const VELOCITY: usize = 2;
pub(super) const ACCELERATION: usize = 4;
pub(super) const HEADING: usize = 6;
pub(super) const TURN: usize = 7;

/// How things of a kind move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mobility {
    /// Of the speed when it is first seen, metres per second.
    pub(super) speed_std_m_s: f64,
    /// Of the acceleration while it moves, metres per second squared.
    pub(super) acceleration_std_m_s2: f64,
    /// How long an acceleration lasts, seconds.
    pub(super) acceleration_lasts_s: f64,
    /// Of the curvature of its path, 1 per metre; `None` where it may turn on the spot.
    pub(super) curvature_std: Option<f64>,
}

/// Cars drive 14 m/s in cities and faster outside, brake by half a metre per second squared and follow bends of ten metres and more; they
/// move along their heading. (Bar-Shalom, Li and Kirubarajan 2001, sections 6.2 and 8.2, on accelerations that fade.)
pub(super) const VEHICLE: Mobility = Mobility {
    speed_std_m_s: 10.0,
    acceleration_std_m_s2: 0.6,
    acceleration_lasts_s: 1.2,
    curvature_std: Some(0.1),
};
/// People walk 1.4 m/s and turn on the spot.
pub(super) const WALKER: Mobility = Mobility {
    speed_std_m_s: 1.2,
    acceleration_std_m_s2: 0.7,
    acceleration_lasts_s: 0.5,
    curvature_std: None,
};

/// What stands rarely starts: accelerations of standing objects are that share of moving ones'.
const STANDING_SHARE: f64 = 0.15;
/// At this speed an object moves, metres per second.
const MOVING_M_S: f64 = 1.5;
/// How long a turn lasts, seconds.
const TURN_LASTS_S: f64 = 8.0;
/// Turn rates of something that stands, radians per second.
const STANDING_TURN_STD: f64 = 0.02;
/// Turn rates of something that turns on the spot, radians per second.
const ON_THE_SPOT_TURN_STD: f64 = 0.7;
/// Of a speed's variance at first sight, this much is left to an object that is believed anew: it drives on.
const RESTART_SHARE: f64 = 0.04;
/// Places of one object are off by this much whatever their covariances say, metres: no car is quite the hull that stands for it.
const LEAST_STD_M: f64 = 0.15;
/// Sideways speed of the centre of something that moves along its heading, metres per second …
const SLIP_M_S: f64 = 0.3;
/// … and its share of the speed: headings of one object err alike from frame to frame, by some ten degrees.
const SLIP_SHARE: f64 = 0.2;
/// Sideways motion beyond this many squared deviations is a wrong heading: it counts for that much less.
const MOST_SLIP_SURPRISE: f64 = 4.0;
/// A heading no better known than this says nothing of where something moves, radians.
const MOST_HEADING_STD: f64 = 0.5;
/// An innovation beyond this many squared deviations is a mistake of some kind: it counts for that much less.
const MOST_SURPRISE: f64 = 9.0;
/// After this many such innovations in a row the belief is the mistake.
const MOST_SURPRISES: u32 = 3;

/// The belief at one moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Filter {
    pub(super) mobility: Mobility,
    pub(super) mean: State,
    pub(super) covariance: StateCovariance,
    /// Whether anything ever said which way it points.
    pub(super) heading_known: bool,
    /// Log-odds that front is front, by what was seen of it.
    pub(super) front: f64,
    /// What the state owes to errors that fixes have in common.
    lasting: Lasting,
    /// Fixes in a row that surprised.
    surprises: u32,
}

/// Where an object was seen: in the steady frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fix {
    /// Who saw it …
    pub(super) camera: CameraId,
    /// … from where.
    pub(super) eye: Vector2<f64>,
    /// Where the box says it is.
    pub(super) place: Vector2<f64>,
    /// Covariance of that.
    pub(super) covariance: Matrix2<f64>,
}

impl Fix {
    /// Covariance of all that it gets wrong.
    pub(super) fn spread(&self) -> Matrix2<f64> {
        self.covariance + Matrix2::identity() * (LEAST_STD_M * LEAST_STD_M)
    }
}

/// How little a fix is what was expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surprise {
    /// Mahalanobis distance.
    pub(super) squared: f64,
    /// How much less is known of the fix than of itself: logarithm of the ratio of determinants.
    pub(super) vague: f64,
}

pub(super) fn left_of(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

impl Filter {
    /// What one box says, of something of which nothing was known.
    pub(super) fn new(fix: &Fix, mobility: Mobility) -> Self {
        let (lasting, errors) = Lasting::of(fix);
        let mut mean = State::zeros();
        mean.fixed_rows_mut::<2>(0).copy_from(&fix.place);
        let mut covariance = StateCovariance::zeros();
        covariance
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&errors.covariance());
        for axis in 0..2 {
            covariance[(VELOCITY + axis, VELOCITY + axis)] = mobility.speed_std_m_s.powi(2);
            covariance[(ACCELERATION + axis, ACCELERATION + axis)] =
                mobility.acceleration_std_m_s2.powi(2);
        }
        covariance[(HEADING, HEADING)] = PI * PI / 3.0;
        covariance[(TURN, TURN)] = STANDING_TURN_STD.powi(2);
        Self {
            mobility,
            mean,
            covariance,
            heading_known: false,
            front: 0.0,
            surprises: 0,
            lasting,
        }
    }

    pub(super) fn position(&self) -> Vector2<f64> {
        self.mean.fixed_rows::<2>(0).into_owned()
    }

    pub(super) fn velocity(&self) -> Vector2<f64> {
        self.mean.fixed_rows::<2>(VELOCITY).into_owned()
    }

    pub(super) fn velocity_covariance(&self) -> Matrix2<f64> {
        self.covariance
            .fixed_view::<2, 2>(VELOCITY, VELOCITY)
            .into_owned()
    }

    /// Where it will be, cheaply.
    pub(super) fn position_after(&self, seconds: f64) -> Vector2<f64> {
        let acceleration = self.mean.fixed_rows::<2>(ACCELERATION);
        self.position() + self.velocity() * seconds + acceleration * (seconds * seconds / 2.0)
    }

    /// The belief some time later.
    pub(super) fn predict(&mut self, seconds: f64) {
        if seconds <= 0.0 {
            return;
        }
        let (velocity, turn) = (self.velocity(), self.mean[TURN]);
        let mobility = self.mobility;
        let kept = |lasts_s: f64| (-seconds / lasts_s).exp();
        let (accelerating, turning) = (kept(mobility.acceleration_lasts_s), kept(TURN_LASTS_S));
        let mut step = StateCovariance::identity();
        for axis in 0..2 {
            step[(axis, VELOCITY + axis)] = seconds;
            step[(axis, ACCELERATION + axis)] = seconds * seconds / 2.0;
            step[(VELOCITY + axis, ACCELERATION + axis)] = seconds;
            step[(ACCELERATION + axis, ACCELERATION + axis)] = accelerating;
        }
        step[(HEADING, TURN)] = seconds;
        step[(TURN, TURN)] = turning;
        let mut mean = step * self.mean;
        // The velocity turns with the object.
        let turned = left_of(velocity) * seconds;
        for axis in 0..2 {
            mean[VELOCITY + axis] += turned[axis] * turn;
            step[(VELOCITY + axis, TURN)] = turned[axis];
        }
        step[(VELOCITY, VELOCITY + 1)] -= turn * seconds;
        step[(VELOCITY + 1, VELOCITY)] += turn * seconds;
        mean[HEADING] = wrapped(mean[HEADING]);
        let mut covariance = spread_by(&step, &spread_by(&step, &self.covariance).transpose());
        let grown = |kept: f64, variance: f64| variance * (1.0 - kept * kept);
        let speed = velocity.norm();
        let moving = STANDING_SHARE + (1.0 - STANDING_SHARE) * (speed / MOVING_M_S).min(1.0);
        let acceleration = (mobility.acceleration_std_m_s2 * moving).powi(2);
        for axis in 0..2 {
            let at = ACCELERATION + axis;
            covariance[(at, at)] += grown(accelerating, acceleration);
        }
        let turn_std = mobility
            .curvature_std
            .map_or(ON_THE_SPOT_TURN_STD, |curvature| {
                STANDING_TURN_STD
                    .max(curvature * speed)
                    .min(ON_THE_SPOT_TURN_STD)
            });
        covariance[(TURN, TURN)] += grown(turning, turn_std * turn_std);
        self.mean = mean;
        self.covariance = covariance;
        self.lasting.predict(&step, seconds);
    }

    /// Covariance of the position.
    pub(super) fn position_covariance(&self) -> Matrix2<f64> {
        self.covariance.fixed_view::<2, 2>(0, 0).into_owned()
    }

    /// How much a fix surprises some time later, as [`Filter::predict`] has it; `None` when by more than `most` squared deviations.
    pub(super) fn surprise_after(&self, seconds: f64, fix: &Fix, most: f64) -> Option<Surprise> {
        let seconds = seconds.max(0.0);
        // Place, velocity and acceleration are what a later place is made of.
        let step = Vector3::new(1.0, seconds, seconds * seconds / 2.0);
        let mut place = Matrix2::zeros();
        for (one, share) in step.iter().enumerate() {
            for (other, other_share) in step.iter().enumerate() {
                let part = self.covariance.fixed_view::<2, 2>(2 * one, 2 * other);
                place += part * (share * other_share);
            }
        }
        let innovation = fix.place - self.position_after(seconds);
        // Two errors, however they go together, have at most twice their variances; most fixes are out of this reach.
        let reach = 2.0 * (place.trace() + fix.spread().trace());
        if innovation.norm_squared() > most * reach {
            return None;
        }
        let errors = self.lasting.errors(fix);
        let shared = self.lasting.shared_after(seconds, &step, &errors);
        let own = errors.covariance();
        let covariance = place + own + shared + shared.transpose();
        let squared = squared(&innovation, &covariance);
        let vague = covariance.determinant() / own.determinant();
        (squared <= most).then(|| Surprise {
            squared,
            vague: vague.max(1.0).ln(),
        })
    }

    /// Takes in where it was seen: corrects the state by what is new in the fix, knowing that the rest is what earlier fixes got
    /// wrong too. That rest is taken into account and not estimated, as a size, a slope and a hidden edge cannot be told apart
    /// (Schmidt 1966; Bar-Shalom, Li and Kirubarajan 2001, section 8.2.4).
    pub(super) fn correct(&mut self, fix: &Fix) {
        let errors = self.lasting.errors(fix);
        let innovation = fix.place - self.position();
        let shared = self.lasting.shared_with(&errors);
        let spread = self.covariance.fixed_columns::<2>(0) + shared;
        let mut covariance =
            spread.fixed_rows::<2>(0) + shared.fixed_rows::<2>(0).transpose() + errors.covariance();
        let excess = squared(&innovation, &covariance) / MOST_SURPRISE;
        self.surprises = if excess > 1.0 { self.surprises + 1 } else { 0 };
        if self.surprises >= MOST_SURPRISES {
            // Not the fixes err, but the belief.
            self.restart(fix);
            return;
        }
        covariance *= excess.max(1.0);
        let Some(inverse) = covariance.try_inverse() else {
            return;
        };
        let gain = spread * inverse;
        self.mean += gain * innovation;
        self.covariance -= gain * spread.transpose();
        self.lasting.correct(&gain, &errors);
        self.settle();
    }

    /// Believes a fix, and of its motion and heading only what was known of it at first.
    fn restart(&mut self, fix: &Fix) {
        let (heading_rad, variance) = (self.mean[HEADING], self.covariance[(HEADING, HEADING)]);
        let (known, front) = (self.heading_known, self.front);
        let velocity = self.velocity();
        *self = Self::new(fix, self.mobility);
        self.mean.fixed_rows_mut::<2>(VELOCITY).copy_from(&velocity);
        for axis in 0..2 {
            self.covariance[(VELOCITY + axis, VELOCITY + axis)] *= RESTART_SHARE;
        }
        if known {
            self.set_heading(heading_rad, variance);
            self.front = front;
        }
    }

    /// Takes in one number that depends on the state by `by` and is off by `innovation`.
    pub(super) fn correct_by(&mut self, by: &Row, innovation: f64, variance: f64) {
        let spread = self.covariance * by.transpose();
        let gain = spread / ((by * spread)[0] + variance);
        self.mean += gain * innovation;
        self.covariance -= gain * spread.transpose();
        self.lasting.correct_by(by, &gain);
        self.settle();
    }

    /// What moves along its heading does not move sideways. Says something of both.
    pub(super) fn keep_to_heading(&mut self) {
        let heading_std = self.covariance[(HEADING, HEADING)].sqrt();
        if self.mobility.curvature_std.is_none()
            || !self.heading_known
            || heading_std > MOST_HEADING_STD
        {
            return;
        }
        let (sin, cos) = self.mean[HEADING].sin_cos();
        let velocity = self.velocity();
        let along = velocity.x * cos + velocity.y * sin;
        let across = velocity.y * cos - velocity.x * sin;
        let mut by = Row::zeros();
        by[VELOCITY] = -sin;
        by[VELOCITY + 1] = cos;
        by[HEADING] = -along;
        // Headings that waver say nothing of a speed that nobody knows yet.
        let ahead = Vector2::new(cos, sin);
        let unknown = ahead.dot(&(self.velocity_covariance() * ahead)).max(0.0);
        let slip = SLIP_M_S.hypot(SLIP_SHARE * along.hypot(unknown.sqrt()));
        let spread = (by * self.covariance * by.transpose())[0] + slip * slip;
        let excess = (across * across / spread / MOST_SLIP_SURPRISE).max(1.0);
        self.correct_by(&by, -across, slip * slip + spread * (excess - 1.0));
    }

    /// Begins anew with a heading.
    pub(super) fn set_heading(&mut self, heading_rad: f64, variance: f64) {
        self.mean[HEADING] = wrapped(heading_rad);
        self.covariance.row_mut(HEADING).fill(0.0);
        self.covariance.column_mut(HEADING).fill(0.0);
        self.covariance[(HEADING, HEADING)] = variance;
        self.lasting.forget(HEADING);
        self.heading_known = true;
    }

    /// Symmetric, and an angle is an angle.
    fn settle(&mut self) {
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
        self.mean[HEADING] = wrapped(self.mean[HEADING]);
    }

    /// Whether all numbers are numbers, and no variance is negative.
    pub(super) fn is_sound(&self) -> bool {
        let diagonal = self.covariance.diagonal();
        self.mean.iter().all(|one| one.is_finite())
            && diagonal.iter().all(|one| one.is_finite() && *one >= 0.0)
    }
}

/// A covariance times a transposed step, most of which is nothing.
fn spread_by(step: &StateCovariance, covariance: &StateCovariance) -> StateCovariance {
    let mut product = StateCovariance::zeros();
    for from in 0..DIMS {
        for to in 0..DIMS {
            let share = step[(to, from)];
            if share != 0.0 {
                let mut column = product.column_mut(to);
                column += covariance.column(from) * share;
            }
        }
    }
    product
}

/// Squared Mahalanobis distance; infinite where the covariance has no inverse.
pub(super) fn squared(apart: &Vector2<f64>, covariance: &Matrix2<f64>) -> f64 {
    let inverse = covariance.try_inverse();
    inverse.map_or(f64::INFINITY, |inverse| apart.dot(&(inverse * apart)))
}
