//! Identities and the fused scene.

use crate::{
    ego::Ego,
    frame::CameraId,
    location::{Heading, Location, Oriented, SizeLwh},
    object_class::ObjectClass,
    space::{BaseLink, Covariance, Point},
    time::Timestamp,
};
use nalgebra::{Matrix2, Vector2};

/// An identity. Of a tracked object a number that never comes again; with left-to-right order the place in the row
/// (docs/method.md, section 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TrackId(pub u64);

/// How far a tracked object is believed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Seen too seldom to be sure that it is there.
    Tentative,
    /// Seen often enough.
    Confirmed,
    /// Confirmed once, and not seen now: where it is follows from its motion.
    Coasting,
}

impl Phase {
    /// Its name in messages.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Tentative => "tentative",
            Self::Confirmed => "confirmed",
            Self::Coasting => "coasting",
        }
    }
}

/// What all frames together say of an object at one moment, in base_link axes of that moment. Velocities are over
/// ground where the vehicle's own motion is known, else against the vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// How far it is believed in.
    pub phase: Phase,
    /// Capture time of the frame that it became known by. It stays when an earlier frame comes late: names are made of it.
    pub first_seen: Timestamp,
    /// What it is, by all frames.
    pub class: ObjectClass,
    /// Centre of its box, metres.
    pub position: Point<BaseLink>,
    /// Covariance of `position`, square metres.
    pub covariance: Covariance<BaseLink>,
    /// Its size, by all frames.
    pub size: SizeLwh,
    /// Which way it points, by what its parts show and where it moves; `None` when nothing says so.
    pub heading: Option<Heading>,
    /// Velocity of the centre along base_link's x and y, metres per second.
    pub velocity_m_s: Vector2<f64>,
    /// Covariance of the velocity.
    pub velocity_covariance: Matrix2<f64>,
    /// Acceleration of the centre, metres per second squared.
    pub acceleration_m_s2: Vector2<f64>,
    /// Covariance of the acceleration.
    pub acceleration_covariance: Matrix2<f64>,
    /// Turn rate about z, radians per second.
    pub turn_rate_rad_s: f64,
    /// Variance of the turn rate.
    pub turn_rate_variance: f64,
}

impl Motion {
    /// Speed, metres per second.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        self.velocity_m_s.norm()
    }
}

/// An observed object with its identity.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Who it is.
    pub id: TrackId,
    /// What was observed: in this frame, or, of one that coasts, in the last one that showed it.
    pub observed: Oriented,
    /// What all frames say; `None` where identities are given without tracking.
    pub motion: Option<Motion>,
}

impl Track {
    fn location(&self) -> &Location {
        &self.observed.located.location
    }

    /// What it is.
    #[must_use]
    pub fn class(&self) -> &ObjectClass {
        let observed = &self.observed.located.detection.class;
        self.motion
            .as_ref()
            .map_or(observed, |motion| &motion.class)
    }

    /// Centre of its box, by all that is known.
    #[must_use]
    pub fn position(&self) -> Point<BaseLink> {
        let motion = self.motion.as_ref();
        motion.map_or(self.location().position, |motion| motion.position)
    }

    /// Covariance of [`Track::position`].
    #[must_use]
    pub fn covariance(&self) -> Covariance<BaseLink> {
        let motion = self.motion.as_ref();
        motion.map_or(self.location().covariance, |motion| motion.covariance)
    }

    /// Its size.
    #[must_use]
    pub fn size(&self) -> SizeLwh {
        let motion = self.motion.as_ref();
        motion.map_or(self.location().size, |motion| motion.size)
    }

    /// Which way it points; `None` when nothing says so.
    #[must_use]
    pub fn heading(&self) -> Option<Heading> {
        match &self.motion {
            Some(motion) => motion.heading,
            None => self.observed.heading.map(|kept| kept.heading),
        }
    }
}

/// One object of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneObject {
    /// Who, what, where.
    pub track: Track,
    /// The cameras that saw it in this round; of one that coasts those that saw it last.
    pub seen_by: Vec<CameraId>,
    /// Capture time of the newest frame it was seen in.
    pub seen_at: Timestamp,
    /// The moment that its place is of: the scene's stamp for a tracked object, else that of its frame.
    pub stamp: Timestamp,
    /// Where it was before, oldest first, in base_link of `stamp`; empty without tracking.
    pub trail: Vec<Point<BaseLink>>,
}

/// All objects of one completed rig round.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Count of scenes, from 0.
    pub seq: u64,
    /// The newest capture time of the round.
    pub stamp: Timestamp,
    /// Where the vehicle is at the stamp.
    pub ego: Ego,
    /// Each object once, by identity; without tracking in order of (camera, place in the camera's list).
    pub objects: Vec<SceneObject>,
}
