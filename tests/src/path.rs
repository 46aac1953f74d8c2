//! How things move on the ground.

use nalgebra::{Isometry2, Vector2};
use std::time::Duration;

/// Slower turns than this are straight lines, radians per second.
const STRAIGHT_RAD_S: f64 = 1e-9;

/// Where something is and which way it points, at every moment: poses in the world's ground plane, metres, x
/// along the heading, y to its left.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// At constant velocity in the world, whichever way it points.
    Line {
        /// At time zero.
        start: Isometry2<f64>,
        /// In the world, metres per second.
        velocity_m_s: Vector2<f64>,
    },
    /// At constant speed along its heading, which turns at a constant rate.
    Arc {
        /// At time zero.
        start: Isometry2<f64>,
        /// Along the heading, metres per second.
        speed_m_s: f64,
        /// Counter-clockwise, radians per second.
        turn_rad_s: f64,
    },
    /// One arc after the other, then on along the last.
    Legs {
        /// At time zero.
        start: Isometry2<f64>,
        /// At least one.
        legs: Vec<Leg>,
    },
    /// Standing at one pose after the other, then at the last.
    Stations {
        /// At least one.
        poses: Vec<Isometry2<f64>>,
        /// How long at each.
        dwell: Duration,
    },
}

/// A part of a path at constant speed and turn rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// How long.
    pub secs: f64,
    /// Along the heading, metres per second.
    pub speed_m_s: f64,
    /// Counter-clockwise, radians per second.
    pub turn_rad_s: f64,
}

impl Leg {
    /// Straight on.
    #[must_use]
    pub fn straight(secs: f64, speed_m_s: f64) -> Self {
        Self {
            secs,
            speed_m_s,
            turn_rad_s: 0.0,
        }
    }
}

/// A pose from metres and degrees.
#[must_use]
pub fn pose(x_m: f64, y_m: f64, yaw_deg: f64) -> Isometry2<f64> {
    Isometry2::new(Vector2::new(x_m, y_m), yaw_deg.to_radians())
}

impl Path {
    /// Always at one place.
    #[must_use]
    pub fn standing(x_m: f64, y_m: f64, yaw_deg: f64) -> Self {
        Self::driving(x_m, y_m, yaw_deg, 0.0)
    }

    /// Straight on, the way it points.
    #[must_use]
    pub fn driving(x_m: f64, y_m: f64, yaw_deg: f64, speed_m_s: f64) -> Self {
        Self::Arc {
            start: pose(x_m, y_m, yaw_deg),
            speed_m_s,
            turn_rad_s: 0.0,
        }
    }

    /// The pose in the world.
    ///
    /// # Panics
    /// Without any station.
    #[must_use]
    pub fn at(&self, time: Duration) -> Isometry2<f64> {
        let t = time.as_secs_f64();
        match self {
            Self::Line {
                start,
                velocity_m_s,
            } => Isometry2::from_parts(
                (start.translation.vector + velocity_m_s * t).into(),
                start.rotation,
            ),
            Self::Arc {
                start,
                speed_m_s,
                turn_rad_s,
            } => start * along_arc(speed_m_s * t, turn_rad_s * t),
            Self::Legs { start, legs } => {
                let (mut pose, mut left) = (*start, t);
                for (at, leg) in legs.iter().enumerate() {
                    let is_last = at + 1 == legs.len();
                    let secs = if is_last { left } else { left.min(leg.secs) };
                    pose *= along_arc(leg.speed_m_s * secs, leg.turn_rad_s * secs);
                    left -= secs;
                }
                pose
            }
            Self::Stations { poses, dwell } => {
                let station = time.as_nanos() / dwell.as_nanos().max(1);
                let last = poses.len().checked_sub(1).expect("at least one station");
                poses[usize::try_from(station).unwrap_or(last).min(last)]
            }
        }
    }
}

/// From the start of an arc, seen along its first heading, to its end.
fn along_arc(length_m: f64, turned_rad: f64) -> Isometry2<f64> {
    let end = if turned_rad.abs() < STRAIGHT_RAD_S {
        Vector2::new(length_m, 0.0)
    } else {
        let (sin, cos) = turned_rad.sin_cos();
        Vector2::new(sin, 1.0 - cos) * (length_m / turned_rad)
    };
    Isometry2::new(end, turned_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Isometry2<f64>, b: Isometry2<f64>) -> bool {
        (a.translation.vector - b.translation.vector).norm() < 1e-9
            && a.rotation.angle_to(&b.rotation).abs() < 1e-9
    }

    #[test]
    fn a_quarter_turn_ends_a_radius_ahead_and_aside() {
        let path = Path::Arc {
            start: pose(1.0, 2.0, 90.0),
            speed_m_s: std::f64::consts::FRAC_PI_2 * 10.0,
            turn_rad_s: std::f64::consts::FRAC_PI_2,
        };
        assert!(near(
            path.at(Duration::from_secs(1)),
            pose(-9.0, 12.0, 180.0)
        ));
    }

    #[test]
    fn straight_ahead_is_along_the_heading_and_a_line_is_along_its_velocity() {
        let ahead = Path::driving(0.0, 0.0, 90.0, 5.0);
        assert!(near(
            ahead.at(Duration::from_secs(2)),
            pose(0.0, 10.0, 90.0)
        ));
        let sideways = Path::Line {
            start: pose(0.0, 0.0, 90.0),
            velocity_m_s: Vector2::new(3.0, 0.0),
        };
        assert!(near(
            sideways.at(Duration::from_secs(2)),
            pose(6.0, 0.0, 90.0)
        ));
    }

    #[test]
    fn stations_follow_each_other_and_the_last_one_stays() {
        let path = Path::Stations {
            poses: vec![pose(1.0, 0.0, 0.0), pose(2.0, 0.0, 0.0)],
            dwell: Duration::from_millis(100),
        };
        let at = |millis| path.at(Duration::from_millis(millis)).translation.x;
        assert_eq!([at(0), at(99), at(100), at(5000)], [1.0, 1.0, 2.0, 2.0]);
    }
}
