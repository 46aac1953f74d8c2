//! How cameras and detectors fall short, by numbers.

use crate::random::{Purpose, Random};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roadwatch_core::{RigCamera, space::Transform};

/// How a camera really sits, against what its calibration says. The locators do not know.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MountError {
    /// Looks down by so much more, degrees.
    pub pitch_deg: f64,
    /// Looks to the right by so much more, degrees.
    pub yaw_deg: f64,
    /// Is turned clockwise about its own axis by so much more, degrees.
    pub roll_deg: f64,
    /// Sits so much higher, metres.
    pub up_m: f64,
}

impl MountError {
    /// The camera as it really sits.
    #[must_use]
    pub fn apply(&self, believed: &RigCamera) -> RigCamera {
        let turn = |axis, deg: f64| UnitQuaternion::from_axis_angle(&axis, deg.to_radians());
        // About the optical axes: x right, y down, z ahead.
        let turned = turn(Vector3::y_axis(), self.yaw_deg)
            * turn(Vector3::x_axis(), -self.pitch_deg)
            * turn(Vector3::z_axis(), self.roll_deg);
        let mount = believed.base_from_optical.isometry;
        let real = Isometry3::from_parts(
            Translation3::from(mount.translation.vector + Vector3::z() * self.up_m),
            mount.rotation * turned,
        );
        RigCamera {
            base_from_optical: Transform::new(real),
            ..believed.clone()
        }
    }
}

/// A camera that is down for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blind {
    /// Which.
    pub camera: usize,
    /// The first frame it loses.
    pub from: u64,
    /// The first frame it has again.
    pub until: u64,
}

/// Everything that goes wrong. The default is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfections {
    /// Of every random number.
    pub seed: u64,
    /// Share of objects that the detector misses, each by itself.
    pub dropout_share: f64,
    /// Standard deviation of each edge of each box, pixels.
    pub jitter_px: f64,
    /// Share of frames with a detection where nothing is.
    pub false_alarm_share: f64,
    /// Share of frames that a camera loses.
    pub missing_share: f64,
    /// A camera that loses all frames from one on, and before another.
    pub blind: Option<Blind>,
    /// Of every camera.
    pub mount: MountError,
}

impl Imperfections {
    /// Whether the detector misses an object.
    #[must_use]
    pub fn drops(&self, camera: usize, frame: u64, actor: usize) -> bool {
        let key = [camera as u64, frame, actor as u64];
        self.random(Purpose::Dropout, &key).unit() < self.dropout_share
    }

    /// Whether a camera loses a frame.
    #[must_use]
    pub fn loses(&self, camera: usize, frame: u64) -> bool {
        let key = [camera as u64, frame];
        let blind = |one: Blind| one.camera == camera && (one.from..one.until).contains(&frame);
        self.blind.is_some_and(blind)
            || self.random(Purpose::MissingFrame, &key).unit() < self.missing_share
    }

    /// The stream of one purpose and one thing.
    #[must_use]
    pub fn random(&self, purpose: Purpose, thing: &[u64]) -> Random {
        Random::keyed(self.seed, purpose, thing)
    }
}
