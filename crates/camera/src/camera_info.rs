//! ROS's `camera_info` YAML: a camera's lens, as `camera_calibration` writes it and `camera_info_manager`
//! reads it.

mod check;
mod numbers;

use check::{File, check};
use numbers::matrix;
use roadwatch_core::CameraModel;
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Decimals of matrices, as ROS's tool prints them.
const DECIMALS: usize = 5;

/// A camera's lens, and the projection of its rectified image.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraInfo {
    /// The camera's name in the file.
    pub name: String,
    /// How it sees, before rectification.
    pub model: CameraModel,
    /// The 3x4 projection of the rectified image, row by row. Roadwatch looks at images as they are and does
    /// not use it.
    pub projection: [f64; 12],
}

/// A file that is no lens.
#[derive(Debug, thiserror::Error)]
pub enum CameraInfoError {
    /// Not there, or not readable.
    #[error("cannot read the camera_info `{}`", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// Not YAML, or a key is missing, unknown or of another type.
    #[error("`{}` is no camera_info: {what}", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// What is wrong, with its line.
        what: String,
    },
    /// A value that cannot be.
    #[error("{}:{line}: {key}: {what}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// The line of the key, from 1.
        line: usize,
        /// The key.
        key: &'static str,
        /// What is wrong and what is expected.
        what: String,
    },
}

impl CameraInfo {
    /// Reads a file.
    ///
    /// # Errors
    /// When it is not readable, not a `camera_info`, or says what no camera can be: a focal length that is not
    /// positive, matrices of other sizes, an unknown lens, a rectification that is no rotation.
    pub fn read(file: &Path) -> Result<Self, CameraInfoError> {
        let text = fs::read_to_string(file).map_err(|cause| CameraInfoError::Unreadable {
            file: file.to_owned(),
            cause,
        })?;
        let parsed: File =
            serde_saphyr::from_str(&text).map_err(|error| CameraInfoError::Malformed {
                file: file.to_owned(),
                what: error.to_string(),
            })?;
        check(parsed).map_err(|(key, what)| CameraInfoError::Value {
            file: file.to_owned(),
            line: line_of(&text, key),
            key,
            what,
        })
    }

    /// The file's text.
    #[must_use]
    pub fn to_yaml(&self) -> String {
        let k = &self.model.intrinsics;
        let camera = [k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0];
        let (lens, coefficients) = self.model.distortion.to_ros();
        let listed: Vec<_> = coefficients.iter().map(|k| format!("{k:.6}")).collect();
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let size = self.model.size;
        format!(
            "image_width: {}\nimage_height: {}\ncamera_name: {}\n\
             camera_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n\
             distortion_model: {lens}\n\
             distortion_coefficients:\n  rows: 1\n  cols: {}\n  data: [{}]\n\
             rectification_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n\
             projection_matrix:\n  rows: 3\n  cols: 4\n  data: {}\n",
            size.width_px,
            size.height_px,
            self.name,
            matrix(&camera, 3, DECIMALS),
            coefficients.len(),
            listed.join(", "),
            matrix(&identity, 3, DECIMALS),
            matrix(&self.projection, 4, DECIMALS),
        )
    }
}

/// The line of a key at the left margin; 1 where there is none.
fn line_of(text: &str, key: &str) -> usize {
    let is_key = |line: &str| {
        line.strip_prefix(key)
            .is_some_and(|rest| rest.starts_with(':'))
    };
    text.lines().position(is_key).map_or(1, |at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_core::{Distortion, ImageSize, Intrinsics};

    fn info() -> CameraInfo {
        CameraInfo {
            name: "front".to_owned(),
            model: CameraModel {
                size: ImageSize {
                    width_px: 960,
                    height_px: 540,
                },
                intrinsics: Intrinsics {
                    fx: 985.12345,
                    fy: 986.5,
                    cx: 480.25,
                    cy: 270.0,
                },
                distortion: Distortion::BrownConrady([
                    -0.25, 0.08, 0.001, -0.0005, 0.0, 0.0, 0.0, 0.0,
                ]),
            },
            projection: [
                900.0, 0.0, 480.0, 0.0, 0.0, 910.0, 270.0, 0.0, 0.0, 0.0, 1.0, 0.0,
            ],
        }
    }

    fn parsed(text: &str) -> Result<CameraInfo, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("front.yaml");
        fs::write(&file, text).expect("written");
        let place = format!("{}/", folder.path().display());
        CameraInfo::read(&file).map_err(|error| error.to_string().replace(&place, ""))
    }

    #[test]
    fn what_is_written_is_read_back() {
        assert_eq!(parsed(&info().to_yaml()), Ok(info()));
    }

    #[test]
    fn the_text_is_laid_out_as_ros_lays_it_out() {
        let expected = "camera_matrix:\n  rows: 3\n  cols: 3\n  \
             data: [985.12345,   0.     , 480.25   ,\n           \
             0.     , 986.5    , 270.     ,\n           \
             0.     ,   0.     ,   1.     ]\ndistortion_model: plumb_bob\n";
        let text = info().to_yaml();
        assert!(text.contains(expected), "{text}");
        assert!(text.contains("data: [-0.250000, 0.080000, 0.001000, -0.000500, 0.000000]"));
    }

    #[test]
    fn each_mistake_is_said_with_its_line() {
        let text = info().to_yaml();
        for (from, to, expected) in [
            (
                "[985.12345",
                "[-985.1",
                "front.yaml:4: camera_matrix: fx is -985.1: expected a focal length above 0",
            ),
            (
                "  rows: 3\n  cols: 4",
                "  rows: 3\n  cols: 3",
                "front.yaml:21: projection_matrix: expected 3 x 4 with 12 numbers, found 3 x 3 with 12",
            ),
            (
                "plumb_bob",
                "barrel",
                "front.yaml:10: distortion_model: distortion model `barrel`",
            ),
            (
                "[1., 0., 0.",
                "[1., 0.3, 0.",
                "front.yaml:15: rectification_matrix: not a rotation",
            ),
            (
                "image_width: 960",
                "image_width: 0",
                "front.yaml:1: image_width: 0 is out of range",
            ),
            (
                "cols: 5",
                "cols: 4",
                "front.yaml:11: distortion_coefficients: 1 x 4 numbers are announced, 5",
            ),
            (
                "image_height: 540\n",
                "",
                "`front.yaml` is no camera_info: ",
            ),
        ] {
            assert!(text.contains(from), "{from} in {text}");
            let complaint = parsed(&text.replace(from, to)).expect_err(to);
            assert!(complaint.starts_with(expected), "{complaint}");
        }
    }
}
