//! `sensor_msgs`: camera calibration, and the encoded image that a marker can carry.

use super::std_msgs::Header;
use serde::{Deserialize, Serialize};

/// A window of the image; all zero means the whole image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegionOfInterest {
    /// Left edge, pixels.
    pub x_offset: u32,
    /// Top edge, pixels.
    pub y_offset: u32,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// Whether a rectified window should be computed from it.
    pub do_rectify: bool,
}

/// Calibration of a camera.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraInfo {
    /// Capture time, optical frame.
    pub header: Header,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// `plumb_bob`, `rational_polynomial` or `equidistant`.
    pub distortion_model: String,
    /// Coefficients of the distortion.
    pub d: Vec<f64>,
    /// Intrinsics of the raw image, 3x3 row by row, pixels.
    pub k: [f64; 9],
    /// Rectification, 3x3 row by row.
    pub r: [f64; 9],
    /// Projection of the rectified image, 3x4 row by row, pixels.
    pub p: [f64; 12],
    /// Horizontal binning; 0 means none.
    pub binning_x: u32,
    /// Vertical binning; 0 means none.
    pub binning_y: u32,
    /// Window of the image.
    pub roi: RegionOfInterest,
}

/// An encoded image.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// Capture time, optical frame.
    pub header: Header,
    /// `jpeg`, `png`.
    pub format: String,
    /// The encoded bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

/// An image that is not encoded.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// Capture time, optical frame.
    pub header: Header,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// What the bytes mean: `rgb8`, `bgr8`, `mono8`, `bayer_rggb8`, …
    pub encoding: String,
    /// Whether the higher byte of a number comes first.
    pub is_bigendian: u8,
    /// Bytes from one row to the next.
    pub step: u32,
    /// The rows.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}
