//! Pitch, height and roll under which two things that a box says about distance agree: its height, with the
//! size that its object is believed to have, and its bottom edge, on the ground.
//!
//! With `h` the box's height, `b` its bottom edge below the horizon, `H` the object's height and `C` the
//! camera's, `h / b` is about `H / C`: what stands at all distances finds the horizon (pitch, and roll where
//! objects stand on both sides), and the mean of the ratio finds `C / H` and nothing more. So either the
//! sizes are trusted and give the camera's height, or the height is trusted and gives the sizes.
//! Each object's own size is unknown within its class: one more unknown per object, with the class's spread.

use crate::{drive::Sightings, drive_fit::Fit, mount_estimate::MountEstimate};
use roadwatch_core::RigCamera;
use roadwatch_locate::BoxNoise;

/// Fewer boxes or objects than these say more about themselves than about the mount.
pub(crate) const LEAST_BOXES: usize = 20;
pub(crate) const LEAST_TRACKS: usize = 3;
/// A roll that is less certain than this is not observable here, radians (0.4 degrees).
const ROLL_LIMIT_RAD: f64 = 0.007;
/// A pitch that is less certain than this is not observable, radians (1.5 degrees).
const PITCH_LIMIT_RAD: f64 = 0.026;
/// A height that is less certain than this share says nothing that was not known before.
const SCALE_LIMIT: f64 = 0.15;
/// Median disagreements of distances: as little as noise makes, and more than sizes within a class explain.
const FINE_DISAGREEMENT: f64 = 0.03;
/// The fit weighs objects and the disagreement counts boxes: this much worse is no worse.
const WORSENED: f64 = 1.25;
const WORST_DISAGREEMENT: f64 = 0.2;

/// What is believed, where boxes tell only the ratio of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trust {
    /// The sizes of classes: the camera's height is found.
    Sizes,
    /// The camera's height: how much larger or smaller objects are than their classes is found.
    Height,
}

/// How a drive is read.
#[derive(Clone, Copy, Debug)]
pub struct DriveOptions {
    /// What is believed.
    pub trust: Trust,
    /// Noise of the boxes' edges.
    pub noise: BoxNoise,
    /// Standard deviation of the vehicle's pitch against the road under an object, radians.
    pub slope_std_rad: f64,
    /// Standard deviation of the mean height of the objects met, as a share of their classes' mean height.
    pub mean_size_std: f64,
}

impl DriveOptions {
    /// Springs let a car pitch by a third of a degree in ordinary driving.
    pub const SLOPE_STD_RAD: f64 = 0.3 * std::f64::consts::PI / 180.0;
    /// Mean heights of new cars differ by about this between countries and decades (European Vehicle Market
    /// Statistics of the ICCT: 1.47 to 1.55 m).
    pub const MEAN_SIZE_STD: f64 = 0.03;
}

/// A mount found from a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveFit {
    /// The mount. Position along the ground and yaw are as they were: boxes say nothing about them.
    pub estimate: MountEstimate,
    /// Heights of objects over those of their classes, with its deviation; 1 and `None` where sizes are trusted.
    pub size_ratio: (f64, Option<f64>),
    /// Boxes used.
    pub boxes: usize,
    /// Different objects among them.
    pub tracks: usize,
    /// Median disagreement of the two distances, as a share: as the mount was, and as it is found.
    pub disagreement: [f64; 2],
}

/// A drive that tells no mount.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DriveError {
    /// Too little was seen.
    #[error(
        "{boxes} usable boxes of {tracks} objects are too few: {LEAST_BOXES} boxes of {LEAST_TRACKS} objects are needed"
    )]
    TooFew {
        /// Usable boxes.
        boxes: usize,
        /// Different objects.
        tracks: usize,
    },
    /// The configured mount cannot be the beginning.
    #[error(
        "the camera looks straight up or down, or is not above the ground: nothing stands below its horizon"
    )]
    NoGround,
    /// No mount explains most of them.
    #[error(
        "no mount near the one that is set makes the boxes agree ({percent} % off): their sizes or classes are not \
         what they are taken for, the ground is not flat, or the pitch is set wrong by more than 4 degrees"
    )]
    Disagreement {
        /// Median disagreement that remains, percent.
        percent: u32,
    },
    /// All boxes are alike.
    #[error(
        "the boxes do not determine pitch and height: too few objects at too few different distances; drive longer"
    )]
    Undetermined,
}

/// Finds the mount of `camera` over the ground at `ground_z_m`, beginning with the mount it has.
///
/// # Errors
/// When too little was seen, or it determines nothing.
pub fn mount_from_drive(
    camera: &RigCamera,
    ground_z_m: f64,
    sightings: &Sightings,
    options: &DriveOptions,
) -> Result<DriveFit, DriveError> {
    let fit = Fit::new(camera, ground_z_m, sightings.boxes(), options)?;
    let found = fit.solve(fit.search(), 3);
    let found = found.ok_or(DriveError::Undetermined)?;
    let with_roll = fit.deviations(&found).filter(|std| std[2] < ROLL_LIMIT_RAD);
    let (found, std) = match with_roll {
        Some(std) => (found, std),
        None => {
            let level = found.at.rows(0, 2).into_owned();
            let held = fit.solve(level, 2).ok_or(DriveError::Undetermined)?;
            let std = fit.deviations(&held).ok_or(DriveError::Undetermined)?;
            (held, std)
        }
    };
    if std[0] > PITCH_LIMIT_RAD || std[1] > SCALE_LIMIT {
        return Err(DriveError::Undetermined);
    }
    let result = fit.result(&found.at, &std);
    let [before, after] = result.disagreement;
    if after > WORSENED * before.max(FINE_DISAGREEMENT) || after > WORST_DISAGREEMENT {
        let percent = (100.0 * after).round() as u32;
        return Err(DriveError::Disagreement { percent });
    }
    Ok(result)
}
