//! The vocabulary every Roadwatch crate shares: types, seam traits, camera geometry, the rig, time.
//!
//! Nothing here opens a file, reads a clock, waits, or knows ROS. Pixel positions have the centre of the
//! top-left pixel at (0, 0) and its corner at (-0.5, -0.5), so scaling an image by `s` maps a column `x`
//! to `(x + 0.5) * s - 0.5`. Boxes are measured by edges instead, see [`BoxPx`].

pub mod angle;
pub mod camera_model;
pub mod detection;
pub mod distortion;
pub mod ego;
mod error_chain;
pub mod frame;
pub mod ground;
pub mod location;
pub mod mount;
pub mod name;
pub mod object_class;
pub mod rig;
pub mod scene;
pub mod seam;
pub mod space;
pub mod time;

pub use camera_model::{CameraModel, ImageSize, Intrinsics};
pub use detection::{BoxPx, Detection, Score};
pub use distortion::Distortion;
pub use ego::{Ego, EgoKnowledge, EgoMotion};
pub use error_chain::error_chain;
pub use frame::{CameraId, DecodeError, DecodeImage, Frame, Image, PerFrame, Pixels};
pub use ground::{GroundReading, SlopeEvidence};
pub use location::{
    Heading, HeadingCandidate, HeadingCandidates, KeptHeading, Known, Located, Location, Method,
    Oriented, Prior, Rotation, SeenComponent, SizeLwh,
};
pub use mount::Mount;
pub use name::CameraName;
pub use object_class::ObjectClass;
pub use rig::{MeasuredFocal, Rig, RigCamera};
pub use scene::{Motion, Phase, Scene, SceneObject, Track, TrackId};
pub use seam::{
    Clock, DetectError, Detector, FrameSource, Locator, Output, Perceived, Reidentifier,
    RotationError, RotationEstimator, Round, Sink, SinkError, SourceError,
};
pub use time::Timestamp;
