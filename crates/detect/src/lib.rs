//! Finds objects in images with a YOLO network: letterbox, ONNX Runtime session, decode head,
//! non-maximum suppression.
//!
//! One [`YoloDetector`] serves all cameras. Boxes come back in the pixels of the image that went in;
//! nothing here knows metres.

pub mod class_names;
pub mod detector;
pub mod head;
pub mod letterbox;
pub mod network;
pub mod nms;
pub mod options;
mod rhythm;
mod workspace;

pub use class_names::COCO_CLASSES;
pub use detector::YoloDetector;
pub use head::{Family, Head, UnknownHead};
pub use network::{Network, NetworkError, NetworkOptions};
pub use options::{ClassFilter, DetectorError, DetectorOptions};
pub use roadwatch_onnx::{Runtime, RuntimeError};
