//! Pictures of what was perceived: each camera's view with its 3D boxes, and the scene from above.
//!
//! Nothing here decides where an object is: the pictures show what the pipeline published.

mod calibration_view;
mod camera_view;
mod canvas;
mod contact_sheet;
mod cuboid;
mod jpeg;
mod palette;
mod picture_sink;
mod scene_view;

pub use calibration_view::{MountEvidence, SeenAndPut, corners_view, focal_view, mount_view};
pub use camera_view::camera_view;
pub use canvas::{Canvas, DrawError};
pub use contact_sheet::contact_sheet;
pub use jpeg::jpeg;
pub use picture_sink::{PictureSink, SCENE_FILE, VIEWS_FILE};
pub use scene_view::scene_view;
