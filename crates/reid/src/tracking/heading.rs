//! Which way an object points: what its parts show, and where it moves.

use super::filter::{Filter, HEADING, Row};
use nalgebra::Vector2;
use roadwatch_core::{Heading, angle::wrapped};
use std::f64::consts::{FRAC_PI_2, PI};

/// Looks at one object see much the same, so each counts for this share of what it says of front and back.
const LOOK_SHARE: f64 = 0.6;
/// Nobody is surer than this of front and back by looks alone (log-odds; 1 in 20): less sure than by motion.
const MOST_FRONT: f64 = 3.0;
/// No look is surer than this, whatever it says.
const LEAST_FLIP: f64 = 0.01;
/// Looks err the same way from frame to frame: a heading gets no better than this share of one look's deviation.
const LASTING_SHARE: f64 = 0.4;
/// No look is better than this, radians.
const LEAST_LOOK_STD: f64 = 0.04;
/// An innovation beyond this many squared deviations counts for that much less.
const MOST_SURPRISE: f64 = 9.0;
/// Slower than this, a vehicle that seems to move may stand, metres per second.
const LEAST_SPEED_M_S: f64 = 1.0;
/// Slower than this, somebody who seems to walk may stand, metres per second.
const LEAST_WALK_M_S: f64 = 0.6;
/// Motion says where something points only if the speed is this many deviations from zero.
const LEAST_SPEED_STD_DEVS: f64 = 3.0;
/// Share of moving vehicles that move forwards.
const FORWARDS: f64 = 0.97;
/// Variance of a velocity against what is believed, where it decides between front and back: what comes out from behind
/// something seems to move.
const VELOCITY_DOUBT: f64 = 2.0;
/// Steepness with which a logistic function comes nearest to the normal distribution's.
const NORMAL_BY_LOGISTIC: f64 = 1.702;
/// Heading of something that moves, against its velocity, radians: tyres slip, people look around.
const MOTION_HEADING_STD: f64 = 0.05;

/// What one frame shows of an object's heading, in the steady frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) heading_rad: f64,
    pub(super) std_dev_rad: f64,
    pub(super) flip_probability: f64,
    /// How much less it says than it claims: of an object that the image's edges cut off, it shows little.
    pub(super) doubt: f64,
}

impl Filter {
    /// Takes in what a frame shows of the heading.
    pub(super) fn look(&mut self, look: &Look) {
        let flip = look.flip_probability.clamp(LEAST_FLIP, 0.5);
        let says = LOOK_SHARE * ((1.0 - flip) / flip).ln() / look.doubt;
        let variance = (look.std_dev_rad.powi(2) + LEAST_LOOK_STD.powi(2)) * look.doubt;
        if !self.heading_known {
            self.set_heading(look.heading_rad, variance);
            self.front = says;
            return;
        }
        let mut off = wrapped(look.heading_rad - self.mean[HEADING]);
        let turned_round = off.abs() > FRAC_PI_2;
        if turned_round {
            off = wrapped(off - PI);
        }
        let front = if turned_round { -says } else { says };
        self.front = (self.front + front).clamp(-MOST_FRONT, MOST_FRONT);
        let spread = self.covariance[(HEADING, HEADING)] + variance;
        let excess = (off * off / spread / MOST_SURPRISE).max(1.0);
        let mut by = Row::zeros();
        by[HEADING] = 1.0;
        self.correct_by(&by, off, variance + spread * (excess - 1.0));
        let least = variance * LASTING_SHARE * LASTING_SHARE;
        let lacking = least - self.covariance[(HEADING, HEADING)];
        self.covariance[(HEADING, HEADING)] += lacking.max(0.0);
    }

    /// Lets motion say which way a vehicle points: altogether, where nothing else does, and else front from back.
    pub(super) fn turn_to_motion(&mut self) {
        if self.mobility.curvature_std.is_none() {
            return;
        }
        if !self.heading_known
            && let Some((heading_rad, variance)) = self.motion_heading(LEAST_SPEED_M_S)
        {
            self.set_heading(heading_rad, variance);
        }
        if self.heading_known && self.front + self.motion_front() < 0.0 {
            self.mean[HEADING] = wrapped(self.mean[HEADING] + PI);
            self.front = -self.front;
        }
    }

    /// Direction of the velocity with its variance; `None` where it may stand.
    fn motion_heading(&self, least_m_s: f64) -> Option<(f64, f64)> {
        let (velocity, covariance) = (self.velocity(), self.velocity_covariance());
        let speed = velocity.norm();
        let along = velocity / speed.max(f64::EPSILON);
        let across = Vector2::new(-along.y, along.x);
        let along_std = along.dot(&(covariance * along)).max(0.0).sqrt();
        let moves = speed > least_m_s && speed > LEAST_SPEED_STD_DEVS * along_std;
        moves.then(|| {
            let across_variance = across.dot(&(covariance * across)).max(0.0);
            let variance = across_variance / (speed * speed) + MOTION_HEADING_STD.powi(2);
            (velocity.y.atan2(velocity.x), variance)
        })
    }

    /// Log-odds that front is front, by motion: few move backwards.
    fn motion_front(&self) -> f64 {
        let (sin, cos) = self.mean[HEADING].sin_cos();
        let along = Vector2::new(cos, sin);
        let speed = self.velocity().dot(&along);
        let variance = along.dot(&(self.velocity_covariance() * along)) * VELOCITY_DOUBT;
        let beyond = (speed.abs() - LEAST_SPEED_M_S).max(0.0).copysign(speed);
        let std_devs = beyond / variance.max(f64::EPSILON).sqrt();
        let ahead = 1.0 / (1.0 + (-NORMAL_BY_LOGISTIC * std_devs).exp());
        let front = ahead * FORWARDS + (1.0 - ahead) * (1.0 - FORWARDS);
        (front / (1.0 - front)).ln()
    }

    /// The heading in the steady frame; `None` when nothing says which way it points.
    pub(super) fn heading(&self, over_ground: bool) -> Option<Heading> {
        let walks = self.mobility.curvature_std.is_none() && over_ground;
        let walking = walks.then(|| self.motion_heading(LEAST_WALK_M_S)).flatten();
        if let Some((yaw_rad, variance)) = walking {
            return Some(Heading {
                yaw_rad,
                std_dev_rad: variance.sqrt(),
                flip_probability: 1.0 - FORWARDS,
            });
        }
        let front = self.front
            + if over_ground {
                self.motion_front()
            } else {
                0.0
            };
        self.heading_known.then(|| Heading {
            yaw_rad: self.mean[HEADING],
            std_dev_rad: self.covariance[(HEADING, HEADING)].max(0.0).sqrt().min(PI),
            flip_probability: (1.0 / (1.0 + front.exp())).min(0.5),
        })
    }
}
