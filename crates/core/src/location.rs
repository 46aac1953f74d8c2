//! Where an object is: position, covariance, and how we know.

use crate::{
    camera_model::Pixel,
    detection::Detection,
    ground::{GroundReading, SlopeEvidence},
    space::{BaseLink, Covariance, Point},
};
use arrayvec::ArrayVec;
use std::{f64::consts::PI, fmt, sync::Arc, time::Duration};

/// Length, width and height of an object, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeLwh {
    /// Along the heading.
    pub length_m: f64,
    /// Across the heading.
    pub width_m: f64,
    /// Up.
    pub height_m: f64,
}

/// How a location was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    /// Triangle similarity with a measured focal value (docs/method.md, eq. 1 and 2).
    TriangleMeasuredF,
    /// Triangle similarity with `fy` of the intrinsics (eq. 2).
    TriangleFy,
    /// Look-up table (eq. 3-7).
    Table,
    /// Bottom edge of the box on the ground plane.
    Ground,
    /// All four edges of the box, the ground and the class's hull together.
    Fused,
}

impl Method {
    /// Every method, in the order of reports.
    pub const ALL: [Self; 5] = [
        Self::TriangleMeasuredF,
        Self::TriangleFy,
        Self::Table,
        Self::Ground,
        Self::Fused,
    ];

    /// The method's name in configuration, messages and reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::TriangleMeasuredF => "triangle_measured_f",
            Self::TriangleFy => "triangle_fy",
            Self::Table => "table",
            Self::Ground => "ground",
            Self::Fused => "fused",
        }
    }

    /// The method of that name, `None` when there is none.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.as_str() == name)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Where one object is.
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    /// Centre of the object's box in base_link, metres.
    pub position: Point<BaseLink>,
    /// Covariance of `position`, square metres.
    pub covariance: Covariance<BaseLink>,
    /// Component of the camera-to-centre vector along the optical axis, metres.
    pub depth_m: f64,
    /// Horizontal distance from the camera's foot to the centre, metres.
    pub range_m: f64,
    /// Assumed size of the object.
    pub size: SizeLwh,
    /// How it was found.
    pub method: Method,
    /// The headings that the box's shape allows, likeliest first; empty where the method says nothing of
    /// them.
    pub headings: HeadingCandidates,
    /// What the box says of the ground below the object; `None` where the method says nothing of it.
    pub ground: Option<GroundReading>,
    /// True when this is an earlier location kept because this frame gave none (docs/method.md, section 3).
    pub held: bool,
}

/// What earlier frames and other objects say, before a detection is located.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// About this object; `None` when it was never located.
    pub object: Option<Prior>,
    /// About the ground, by all objects but this one.
    pub slopes: SlopeEvidence,
}

/// What earlier frames say about a detection, before it is located.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// The last location that was measured, not held.
    pub location: Location,
    /// The last heading; `None` when none was ever found.
    pub heading: Option<KeptHeading>,
    /// Capture time since `location` was measured.
    pub age: Duration,
}

/// A heading found in an earlier frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptHeading {
    /// The heading, its deviation grown by what may have turned since.
    pub heading: Heading,
    /// Capture time since it was found.
    pub age: Duration,
}

/// A key component of an object, such as a tyre or a number plate.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenComponent {
    /// What it is, by the name that the model has for it.
    pub name: Arc<str>,
    /// Where it is in the image.
    pub position_px: Pixel,
    /// How sure the model is, 0 to 1.
    pub score: f32,
}

/// What one frame says of an object's direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotation {
    /// Which way it points.
    pub heading: Heading,
    /// What was found of it.
    pub components: Vec<SeenComponent>,
}

/// Which way an object points, in base_link axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// About z, counter-clockwise, zero along the vehicle's forward axis (REP-103), radians in -pi..=pi.
    pub yaw_rad: f64,
    /// Standard deviation, radians, if it is not turned round.
    pub std_dev_rad: f64,
    /// How likely the object points the other way instead, 0 to 0.5: front and back look much alike.
    pub flip_probability: f64,
}

impl Heading {
    /// Variance of the yaw, square radians, the chance of a flip included.
    #[must_use]
    pub fn variance_rad2(&self) -> f64 {
        let flipped = self.flip_probability;
        self.std_dev_rad.powi(2) + flipped * (1.0 - flipped) * PI * PI
    }
}

/// One heading that a box's shape allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingCandidate {
    /// Which way, and how sharply the box says so.
    pub heading: Heading,
    /// Its probability among the candidates of one location, which sum to 1.
    pub weight: f64,
}

/// Front and back look alike to a box, and so do a turn to the left and one to the right of the ray: four.
pub const MAX_HEADING_CANDIDATES: usize = 4;

/// The headings that a box's shape allows, likeliest first.
pub type HeadingCandidates = ArrayVec<HeadingCandidate, MAX_HEADING_CANDIDATES>;

/// A detection with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// What was seen.
    pub detection: Detection,
    /// Where it is.
    pub location: Location,
    /// What other objects said of the ground when it was located.
    pub slopes: SlopeEvidence,
}

/// A located object with its heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Oriented {
    /// What and where.
    pub located: Located,
    /// `None` when nothing says which way it points; never invented. One of an earlier frame where this one was
    /// not asked or gave none.
    pub heading: Option<KeptHeading>,
    /// The key components that were found in this frame.
    pub components: Vec<SeenComponent>,
}
