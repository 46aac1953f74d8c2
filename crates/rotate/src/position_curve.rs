//! The paper's calibration (its section IV, Fig. 13.2): by how much what a crop shows is off from the heading, as a
//! curve of where the object stands across the camera, taken from objects at one distance.

use crate::{angle::RayAngle, forest::Forest, row::RowTable};
use nalgebra::{Matrix4, Vector4};
use roadwatch_core::angle::wrapped;
use serde::{Deserialize, Serialize};
use std::{
    f64::consts::FRAC_PI_2,
    fs, io,
    path::{Path, PathBuf},
};

/// The distance whose curve stands for all ("30 m in the Y axis", section IV), metres.
pub const MEAN_LOC_Y_M: f64 = 30.0;
/// Coefficients of the curve: a cubic follows the arc tangent to a fifth of a degree over 60 degrees of view.
const TERMS: usize = 4;
/// Of LocX, so that powers stay near one, metres.
const UNIT_M: f64 = 10.0;
/// Fewer rows make no curve.
const LEAST_ROWS: usize = 20;
/// Rows that stray more than this count less (Huber), radians: two degrees, a good forest's error.
const HUBER_RAD: f64 = 0.035;
/// Rounds of weighing.
const ROUNDS: usize = 12;

/// Rotation bias against LocX: `bias = observation angle - heading against the camera's own direction`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionCurve {
    /// LocY of the objects it was taken from, metres.
    pub loc_y_m: f64,
    /// Least and greatest LocX among them, metres; beyond, the curve stays as it is there.
    pub loc_x_m: [f64; 2],
    /// Bias in degrees: of the powers 0 to 3 of LocX in units of 10 m.
    pub bias_deg: [f64; TERMS],
    /// Rows that it was fitted to.
    pub rows: usize,
    /// Rows left out because they were turned round.
    pub turned_round: usize,
    /// Root of the mean weighted squared distance of rows from it, degrees.
    pub rms_deg: f64,
}

/// What was off in one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// Where, metres to the right of the optical axis.
    pub loc_x_m: f64,
    /// By how much the observation angle exceeds the heading, radians.
    pub bias_rad: f64,
}

/// Rows that make no curve, or a file that holds none.
#[derive(Debug, thiserror::Error)]
pub enum PositionCurveError {
    /// Too few rows at that distance.
    #[error(
        "{found} rows are {loc_y_m} m ahead, within {within_m} m; {LEAST_ROWS} or more make a curve"
    )]
    FewRows {
        /// How many.
        found: usize,
        /// The distance, metres.
        loc_y_m: f64,
        /// On both sides of it, metres.
        within_m: f64,
    },
    /// All at one place.
    #[error("the rows stand in too few places across the camera for a curve")]
    OnePlace,
    /// The disk.
    #[error("cannot read or write the curve `{}`", file.display())]
    Disk {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// Another file.
    #[error("`{}` is not a curve of `roadwatch calibrate rotation`", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: serde_json::Error,
    },
}

impl PositionCurve {
    /// Fits the curve to what a forest says of rows within `within_m` of `loc_y_m` ahead; gives what it was fitted to
    /// as well. Rows more than a quarter turn off are turned round, which no curve of the place can mend.
    ///
    /// # Errors
    /// With too few rows there, or all at one place.
    pub fn fit(
        table: &RowTable,
        forest: &Forest,
        (loc_y_m, within_m): (f64, f64),
    ) -> Result<(Self, Vec<Bias>), PositionCurveError> {
        let mut features = Vec::new();
        let near = |ahead_m: f64| (ahead_m - loc_y_m).abs() <= within_m;
        let rows = table.rows.iter().filter(|row| near(row.place.x()));
        let (mut biases, mut turned_round) = (Vec::new(), 0);
        for labelled in rows {
            let found = forest.turn(&labelled.row, &mut features).angle;
            if found.apart_rad(labelled.angle) > FRAC_PI_2 {
                turned_round += 1;
                continue;
            }
            let heading = labelled.angle.seen_along(labelled.ray());
            biases.push(Bias {
                loc_x_m: -labelled.place.y(),
                bias_rad: wrapped(found.radians() - heading.radians()),
            });
        }
        if biases.len() < LEAST_ROWS {
            return Err(PositionCurveError::FewRows {
                found: biases.len(),
                loc_y_m,
                within_m,
            });
        }
        let (bias, rms_rad) = fitted(&biases).ok_or(PositionCurveError::OnePlace)?;
        let places = biases.iter().map(|bias| bias.loc_x_m);
        let curve = Self {
            loc_y_m,
            loc_x_m: [
                places.clone().fold(f64::INFINITY, f64::min),
                places.fold(f64::NEG_INFINITY, f64::max),
            ],
            bias_deg: bias.map(f64::to_degrees).into(),
            rows: biases.len(),
            turned_round,
            rms_deg: rms_rad.to_degrees(),
        };
        Ok((curve, biases))
    }

    /// What stands in for the ray angle of an object at LocX, against the camera's own direction: the bias, undone.
    /// The same at every distance, as the paper has it.
    #[must_use]
    pub fn ray(&self, loc_x_m: f64) -> RayAngle {
        let [least, greatest] = self.loc_x_m;
        let bias_deg = powers(loc_x_m.clamp(least, greatest)).dot(&Vector4::from(self.bias_deg));
        RayAngle::new(-bias_deg.to_radians())
    }

    /// Writes the curve as JSON.
    ///
    /// # Errors
    /// When the disk does not take it.
    pub fn write(&self, file: &Path) -> Result<(), PositionCurveError> {
        let text = format!("{:#}\n", serde_json::json!(self));
        fs::write(file, text).map_err(|cause| PositionCurveError::Disk {
            file: file.to_owned(),
            cause,
        })
    }

    /// Reads what [`Self::write`] wrote.
    ///
    /// # Errors
    /// When the file is absent, or holds no curve.
    pub fn read(file: &Path) -> Result<Self, PositionCurveError> {
        let text = fs::read_to_string(file).map_err(|cause| PositionCurveError::Disk {
            file: file.to_owned(),
            cause,
        })?;
        serde_json::from_str(&text).map_err(|cause| PositionCurveError::Content {
            file: file.to_owned(),
            cause,
        })
    }
}

fn powers(loc_x_m: f64) -> Vector4<f64> {
    let x = loc_x_m / UNIT_M;
    Vector4::new(1.0, x, x * x, x * x * x)
}

/// Robust least squares: coefficients, and the weighted root mean square that is left, radians.
fn fitted(biases: &[Bias]) -> Option<(Vector4<f64>, f64)> {
    let mut weights = vec![1.0; biases.len()];
    let mut last = None;
    for _ in 0..ROUNDS {
        let (mut information, mut pull) = (Matrix4::zeros(), Vector4::zeros());
        for (bias, weight) in biases.iter().zip(&weights) {
            let powers = powers(bias.loc_x_m);
            information += powers * powers.transpose() * *weight;
            pull += powers * (bias.bias_rad * weight);
        }
        let coefficients = information.cholesky()?.solve(&pull);
        let (mut squares, mut sum) = (0.0, 0.0);
        for (bias, weight) in biases.iter().zip(&mut weights) {
            let off = wrapped(bias.bias_rad - powers(bias.loc_x_m).dot(&coefficients));
            squares += *weight * off * off;
            sum += *weight;
            *weight = (HUBER_RAD / off.abs().max(f64::MIN_POSITIVE)).min(1.0);
        }
        last = Some((coefficients, (squares / sum).sqrt()));
    }
    last.filter(|(coefficients, _)| coefficients.iter().all(|number| number.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cars in a row 30 m ahead, a tenth of them turned into nonsense.
    fn row() -> Vec<Bias> {
        let places = (-60..=60).map(|step| f64::from(step) / 5.0);
        let bias = |(loc_x_m, number): (f64, u32)| Bias {
            loc_x_m,
            bias_rad: match number % 10 {
                0 => 1.2,
                _ => (loc_x_m / MEAN_LOC_Y_M).atan() + 0.02,
            },
        };
        places.zip(0..).map(bias).collect()
    }

    #[test]
    fn a_row_of_cars_gives_its_arc_tangent_and_the_estimators_own_bias() {
        let (bias, _) = fitted(&row()).expect("a curve");
        for loc_x_m in [-12.0, -5.0, 0.0, 7.0, 12.0] {
            let expected = (loc_x_m / MEAN_LOC_Y_M).atan() + 0.02;
            let off = (powers(loc_x_m).dot(&bias) - expected).abs().to_degrees();
            assert!(off < 0.5, "{off} at {loc_x_m}");
        }
    }

    #[test]
    fn beyond_its_ends_the_curve_stays_as_it_is_there() {
        let curve = PositionCurve {
            loc_y_m: 30.0,
            loc_x_m: [-10.0, 10.0],
            bias_deg: [1.0, 18.0, 0.0, 0.0],
            rows: 50,
            turned_round: 0,
            rms_deg: 1.0,
        };
        assert!((curve.ray(10.0).radians().to_degrees() + 19.0).abs() < 1e-9);
        assert_eq!(curve.ray(40.0), curve.ray(10.0));
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("curve.json");
        curve.write(&file).expect("written");
        assert_eq!(PositionCurve::read(&file).expect("read"), curve);
        fs::write(&file, "{}").expect("written");
        let refused = PositionCurve::read(&file)
            .expect_err("no curve")
            .to_string();
        assert!(refused.contains("is not a curve of `roadwatch calibrate rotation`"));
    }

    #[test]
    fn all_in_one_place_is_no_curve() {
        let one = Bias {
            loc_x_m: 3.0,
            bias_rad: 0.1,
        };
        assert!(fitted(&[one; 50]).is_none());
    }
}
