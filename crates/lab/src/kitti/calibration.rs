//! A file of `calib`: the projection matrix of camera 2.

use super::error::{CalibrationProblem, KittiError};
use roadwatch_core::Intrinsics;
use std::{fs, path::Path};

const KEY: &str = "P2";

/// How one image was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Calibration {
    /// Of camera 2.
    pub(super) intrinsics: Intrinsics,
    /// Its optical centre in the rectified frame of camera 0 (x right, y down, z ahead), metres.
    pub(super) optical_center_m: [f64; 3],
}

impl Calibration {
    /// # Errors
    /// When the file cannot be read, has no P2, or P2 is no camera.
    pub(super) fn read(file: &Path) -> Result<Self, KittiError> {
        let text = fs::read_to_string(file).map_err(|cause| KittiError::Unreadable {
            file: file.to_owned(),
            cause,
        })?;
        let wrong = |line, problem| KittiError::Calibration {
            file: file.to_owned(),
            line,
            problem,
        };
        for (line, text) in (1..).zip(text.lines()) {
            if let Some(numbers) = text
                .trim()
                .strip_prefix(KEY)
                .and_then(|rest| rest.strip_prefix(':'))
            {
                return Self::parse(numbers).map_err(|problem| wrong(line, problem));
            }
        }
        Err(wrong(text.lines().count(), CalibrationProblem::NoP2))
    }

    /// `P2 = K [I | t]`, row by row; the optical centre is at `-t`.
    fn parse(text: &str) -> Result<Self, CalibrationProblem> {
        let numbers = text.split_whitespace().map(|word| {
            let number: Option<f64> = word.parse().ok();
            let finite = number.filter(|number| number.is_finite());
            finite.ok_or_else(|| CalibrationProblem::Number(word.to_owned()))
        });
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        let &[fx, skew, cx, px, p10, fy, cy, py, p20, p21, p22, pz] = numbers.as_slice() else {
            return Err(CalibrationProblem::Count(numbers.len()));
        };
        for (name, focal_px) in [("fx", fx), ("fy", fy)] {
            if focal_px <= 0.0 {
                return Err(CalibrationProblem::Focal { name, focal_px });
            }
        }
        if [skew, p10, p20, p21, p22] != [0.0, 0.0, 0.0, 0.0, 1.0] {
            return Err(CalibrationProblem::NotRectified);
        }
        Ok(Self {
            intrinsics: Intrinsics { fx, fy, cx, cy },
            optical_center_m: [-(px - cx * pz) / fx, -(py - cy * pz) / fy, -pz],
        })
    }
}
