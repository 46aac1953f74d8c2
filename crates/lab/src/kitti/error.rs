//! What can be wrong with a folder in KITTI's layout, said with file and line.

use roadwatch_camera::DatasetError;
use roadwatch_core::name::InvalidName;
use std::{io, path::PathBuf};

/// A folder in KITTI's layout that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum KittiError {
    /// A file or folder is not there, not ours to read, or not text.
    #[error(
        "`{}` cannot be read: KITTI's object layout is a folder with image_2, calib and label_2, which have one file \
         of the same number per image",
        file.display()
    )]
    Unreadable {
        /// The file or folder.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// No image at all.
    #[error("`{}` holds no image: expected .png or .jpg files such as 000007.png", folder.display())]
    NoImages {
        /// The folder.
        folder: PathBuf,
    },
    /// An image whose name is no number.
    #[error("`{}` has no number: KITTI's images are called 000007.png and so on", file.display())]
    ImageName {
        /// The image.
        file: PathBuf,
    },
    /// A file that is no image.
    #[error("the size of the image `{}` cannot be read", file.display())]
    Image {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: imagesize::ImageError,
    },
    /// A mistake in a file of `calib`.
    #[error("{}:{line}: {problem}", file.display())]
    Calibration {
        /// The file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        problem: CalibrationProblem,
    },
    /// A mistake in a file of `label_2`.
    #[error("{}:{line}: {problem}", file.display())]
    Label {
        /// The file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        problem: LabelProblem,
    },
    /// More different calibrations than a rig has cameras.
    #[error(
        "the images of `{}` have {count} different calibrations; at most 255 can be evaluated together: split the folder",
        folder.display()
    )]
    TooManyCalibrations {
        /// The folder.
        folder: PathBuf,
        /// How many.
        count: usize,
    },
    /// A camera cannot be called so.
    #[error(transparent)]
    Name(InvalidName),
    /// The images cannot be played.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
}

/// A mistake in a file of `calib`.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationProblem {
    /// Camera 2 is not calibrated.
    #[error(
        "no line `P2: ...` up to here: the 3x4 projection matrix of the left colour camera, row by row"
    )]
    NoP2,
    /// A word that is no finite number.
    #[error("P2: `{0}` is not a number")]
    Number(String),
    /// Not twelve numbers.
    #[error("P2 has {0} numbers: expected the 12 of a 3x4 projection matrix, row by row")]
    Count(usize),
    /// A focal length that no camera has.
    #[error("P2: {name} is {focal_px}: expected a focal length above 0, in pixels")]
    Focal {
        /// Which.
        name: &'static str,
        /// Its value.
        focal_px: f64,
    },
    /// Not a rectified camera's matrix.
    #[error(
        "P2 is not the matrix of a rectified camera: expected fx 0 cx · 0 fy cy · 0 0 1 in its first three columns"
    )]
    NotRectified,
}

/// A mistake in a line of `label_2`.
#[derive(Debug, thiserror::Error)]
pub enum LabelProblem {
    /// Too few fields.
    #[error("a label has 15 fields, this line has {found}: `{field}` and what follows are missing")]
    Missing {
        /// How many there are.
        found: usize,
        /// The first that is missing.
        field: &'static str,
    },
    /// A field that is no finite number.
    #[error("{field}: `{word}` is not a number")]
    Number {
        /// The field.
        field: &'static str,
        /// What it says.
        word: String,
    },
    /// A size that nothing has.
    #[error("{field} is {size}: expected metres above 0")]
    Size {
        /// The field.
        field: &'static str,
        /// Its value.
        size: f64,
    },
    /// A truncation that is no share.
    #[error("truncated is {0}: expected a share, 0 to 1")]
    Truncated(f64),
    /// An unknown level of occlusion.
    #[error(
        "occluded is {0}: expected 0 (visible), 1 (partly), 2 (largely occluded) or 3 (unknown)"
    )]
    Occluded(f64),
    /// A box without an area.
    #[error(
        "the box {left} {top} {right} {bottom} has no area: expected left < right and top < bottom"
    )]
    EmptyBox {
        /// Pixel.
        left: f64,
        /// Pixel.
        top: f64,
        /// Pixel.
        right: f64,
        /// Pixel.
        bottom: f64,
    },
}
