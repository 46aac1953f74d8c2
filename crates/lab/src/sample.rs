//! The table of samples: every estimate beside what was really there. All figures, groups and plots are made of
//! it by filtering.

use crate::{footprint::Footprint, truth::TruthObject};
use nalgebra::Vector2;
use roadwatch_core::{Heading, Location, Method, RigCamera};
use std::{f64::consts::PI, fmt, sync::Arc};

/// Whose answer a sample is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Estimator {
    /// The pipeline's own, by the methods that it was configured with.
    Published,
    /// What the frame by itself said, before it was put together with others.
    Single,
    /// One method's, on every object.
    By(Method),
}

impl Estimator {
    /// Its name in reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Single => "single",
            Self::By(method) => method.as_str(),
        }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A labelled object that is scored, in one image: the context of its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// The object, as its labels have it.
    pub object: TruthObject,
    /// Name of the camera.
    pub camera: String,
    /// Place of the camera in base_link, metres.
    pub foot: [f64; 2],
    /// True horizontal distance from the camera's foot to the centre (`range_m`), metres.
    pub range_m: f64,
    /// True component along the optical axis (`depth_m`), metres.
    pub depth_m: f64,
    /// True horizontal distance to the nearest surface, metres; `None` without a labelled size and heading.
    pub surface_m: Option<f64>,
    /// Whether a detection was taken for it.
    pub found: bool,
}

impl Target {
    /// An object in an image of `camera`.
    #[must_use]
    pub fn new(object: &TruthObject, camera: &RigCamera, found: bool) -> Self {
        let foot = camera.base_from_optical.origin();
        let footprint = object.size.map(|size| Footprint {
            center: object.center,
            size,
        });
        let surface =
            |(footprint, yaw_rad): (Footprint, f64)| footprint.distance_m(foot, Some(yaw_rad));
        Self {
            object: object.clone(),
            camera: camera.name.to_string(),
            foot: [foot.x(), foot.y()],
            range_m: camera.range_m(object.center),
            depth_m: camera.depth_m(object.center),
            surface_m: footprint.zip(object.yaw_rad).map(surface),
            found,
        }
    }
}

/// What an estimator said of a place, against the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Where in base_link, metres.
    pub place: [f64; 2],
    /// `range_m`, metres.
    pub range_m: f64,
    /// `depth_m`, metres.
    pub depth_m: f64,
    /// Distance to the nearest surface of the assumed cuboid, metres. Where no heading is known it is the mean
    /// over all headings.
    pub surface_m: f64,
    /// Error along the ray from the camera's foot to the true centre; positive when too far.
    pub radial: Deviation,
    /// Error across that ray; positive to the left.
    pub tangential: Deviation,
    /// Of the heading; `None` where the estimator or the truth has none.
    pub heading: Option<HeadingError>,
}

impl Estimate {
    /// Horizontal distance from the true centre, metres.
    #[must_use]
    pub fn location_error_m(&self) -> f64 {
        self.radial.error_m.hypot(self.tangential.error_m)
    }
}

/// An error along one direction, and what was expected of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// The error, metres.
    pub error_m: f64,
    /// One standard deviation along the same direction by the estimate's covariance, metres.
    pub std_dev_m: f64,
}

impl Deviation {
    /// The error in standard deviations; infinite when none was admitted.
    #[must_use]
    pub fn sigmas(&self) -> f64 {
        self.error_m.abs() / self.std_dev_m
    }
}

/// How far headings are off, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingError {
    /// Of the one heading that is held for the likeliest, 0 to 180.
    pub best_deg: f64,
    /// Of the nearest heading that the box allows, 0 to 180.
    pub folded_deg: f64,
    /// Whether somebody decided for the likeliest, and the box did not just allow it.
    pub decided: bool,
}

/// One estimator's answer for one object in one image.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Whose answer.
    pub estimator: Estimator,
    /// What was really there.
    pub target: Arc<Target>,
    /// The answer; `None` when it gave no place.
    pub estimate: Option<Estimate>,
}

impl Sample {
    /// Judges an answer; `heading` is the one that was decided for, `None` where the location's candidates are all
    /// that is known.
    #[must_use]
    pub fn judge(
        estimator: Estimator,
        target: &Arc<Target>,
        answer: Option<(&Location, Option<Heading>)>,
    ) -> Self {
        let estimate = answer.map(|(location, heading)| judge(target, location, heading));
        Self {
            estimator,
            target: Arc::clone(target),
            estimate,
        }
    }
}

fn judge(target: &Target, location: &Location, heading: Option<Heading>) -> Estimate {
    let best = heading.or_else(|| Some(location.headings.first()?.heading));
    let footprint = Footprint {
        center: location.position,
        size: location.size,
    };
    let [foot_x, foot_y] = target.foot;
    let (found, truth) = (location.position, target.object.center);
    let error = Vector2::new(found.x() - truth.x(), found.y() - truth.y());
    let ray = Vector2::new(truth.x() - foot_x, truth.y() - foot_y);
    // An object upon the camera has no direction; any will do.
    let radial = ray.try_normalize(f64::EPSILON).unwrap_or_else(Vector2::x);
    let tangential = Vector2::new(-radial.y, radial.x);
    let spread = location
        .covariance
        .matrix
        .fixed_view::<2, 2>(0, 0)
        .into_owned();
    let along = |direction: Vector2<f64>| Deviation {
        error_m: error.dot(&direction),
        std_dev_m: direction.dot(&(spread * direction)).max(0.0).sqrt(),
    };
    let foot = roadwatch_core::space::Point::new(foot_x, foot_y, 0.0);
    Estimate {
        place: [found.x(), found.y()],
        range_m: location.range_m,
        depth_m: location.depth_m,
        surface_m: footprint.distance_m(foot, best.map(|heading| heading.yaw_rad)),
        radial: along(radial),
        tangential: along(tangential),
        heading: heading_error(target.object.yaw_rad, location, heading),
    }
}

fn heading_error(
    true_yaw_rad: Option<f64>,
    location: &Location,
    heading: Option<Heading>,
) -> Option<HeadingError> {
    let true_yaw_rad = true_yaw_rad?;
    let off = |heading: &Heading| turn_deg(heading.yaw_rad, true_yaw_rad);
    let candidates = location.headings.iter().map(|candidate| candidate.heading);
    let known: Vec<f64> = heading
        .into_iter()
        .chain(candidates)
        .map(|h| off(&h))
        .collect();
    Some(HeadingError {
        best_deg: *known.first()?,
        folded_deg: known.iter().copied().fold(f64::INFINITY, f64::min),
        decided: heading.is_some(),
    })
}

/// The smaller angle between two headings, degrees, 0 to 180.
fn turn_deg(a_rad: f64, b_rad: f64) -> f64 {
    let turn = (a_rad - b_rad).rem_euclid(2.0 * PI);
    turn.min(2.0 * PI - turn).to_degrees()
}
