//! Lens distortion on the normalised image plane (z = 1), forwards and back.

use nalgebra::{Matrix2, Vector2};

/// Newton steps of the inverse; quadratic convergence needs 3-5 on real lenses.
const MAX_STEPS: usize = 20;
/// Residual at which the inverse has converged: 1e-12 on the plane is below 1e-8 px at any real focal length.
const TOLERANCE: f64 = 1e-12;
/// Step of the numeric Jacobian, about the cube root of machine precision.
const DIFFERENCE: f64 = 1e-6;

/// How a lens bends rays, in OpenCV's conventions and ROS's `distortion_model` names.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Distortion {
    /// An ideal pinhole, or images that are rectified already.
    #[default]
    None,
    /// Brown-Conrady, `plumb_bob` (5) or `rational_polynomial` (8): k1 k2 p1 p2 k3 k4 k5 k6.
    BrownConrady([f64; 8]),
    /// Kannala-Brandt four-term fisheye, `equidistant`: k1 k2 k3 k4.
    Fisheye([f64; 4]),
}

/// A distortion model's name or its number of coefficients is not one this crate knows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "distortion model `{model}` with {count} coefficients is unknown: expected `none`, `plumb_bob` (5), \
     `rational_polynomial` (8) or `equidistant` (4)"
)]
pub struct UnknownDistortion {
    /// The name given.
    pub model: String,
    /// The number of coefficients given.
    pub count: usize,
}

impl Distortion {
    /// The model that ROS calls `model`, with its coefficients in ROS's order.
    ///
    /// # Errors
    /// When the name, or the number of coefficients for that name, is unknown.
    pub fn from_ros(model: &str, coefficients: &[f64]) -> Result<Self, UnknownDistortion> {
        let unknown = || UnknownDistortion {
            model: model.to_owned(),
            count: coefficients.len(),
        };
        match model {
            "none" | "" => Ok(Self::None),
            "plumb_bob" | "rational_polynomial" if matches!(coefficients.len(), 4 | 5 | 8) => {
                let mut all = [0.0; 8];
                all[..coefficients.len()].copy_from_slice(coefficients);
                Ok(Self::BrownConrady(all))
            }
            "equidistant" | "fisheye" => coefficients
                .try_into()
                .map(Self::Fisheye)
                .map_err(|_| unknown()),
            _ => Err(unknown()),
        }
    }

    /// ROS's name and coefficients of this model, as `sensor_msgs/CameraInfo` carries them.
    #[must_use]
    pub fn to_ros(&self) -> (&'static str, Vec<f64>) {
        match self {
            Self::None => ("plumb_bob", vec![0.0; 5]),
            Self::BrownConrady(k) if k[5..] == [0.0; 3] => ("plumb_bob", k[..5].to_vec()),
            Self::BrownConrady(k) => ("rational_polynomial", k.to_vec()),
            Self::Fisheye(k) => ("equidistant", k.to_vec()),
        }
    }

    /// Where the ideal point `(x/z, y/z)` really lands on the plane.
    #[must_use]
    pub fn distort(&self, ideal: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::None => ideal,
            Self::BrownConrady(k) => brown_conrady(k, ideal),
            Self::Fisheye(k) => {
                let radius = ideal.norm();
                if radius < f64::EPSILON {
                    return ideal;
                }
                ideal * (fisheye_angle(k, radius.atan()) / radius)
            }
        }
    }

    /// The ideal point that lands on `distorted`; `None` where the model has no inverse
    /// (outside the field of view it was fitted on).
    #[must_use]
    pub fn undistort(&self, distorted: Vector2<f64>) -> Option<Vector2<f64>> {
        match self {
            Self::None => Some(distorted),
            Self::BrownConrady(_) => self.invert_by_newton(distorted),
            Self::Fisheye(k) => invert_fisheye(k, distorted),
        }
    }

    fn invert_by_newton(&self, distorted: Vector2<f64>) -> Option<Vector2<f64>> {
        let mut guess = distorted;
        for _ in 0..MAX_STEPS {
            let residual = self.distort(guess) - distorted;
            if residual.norm() < TOLERANCE {
                return Some(guess);
            }
            let column = |axis: Vector2<f64>| {
                (self.distort(guess + axis) - self.distort(guess - axis)) / (2.0 * DIFFERENCE)
            };
            let jacobian = Matrix2::from_columns(&[
                column(Vector2::new(DIFFERENCE, 0.0)),
                column(Vector2::new(0.0, DIFFERENCE)),
            ]);
            // Where the determinant turns negative the model folds back on itself.
            if jacobian.determinant() <= 0.0 {
                return None;
            }
            guess -= jacobian.try_inverse()? * residual;
        }
        None
    }
}

fn brown_conrady(k: &[f64; 8], p: Vector2<f64>) -> Vector2<f64> {
    let [k1, k2, p1, p2, k3, k4, k5, k6] = *k;
    let (x, y) = (p.x, p.y);
    let r2 = p.norm_squared();
    let radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
    Vector2::new(
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    )
}

fn fisheye_angle(k: &[f64; 4], theta: f64) -> f64 {
    let t2 = theta * theta;
    theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))))
}

fn invert_fisheye(k: &[f64; 4], distorted: Vector2<f64>) -> Option<Vector2<f64>> {
    let target = distorted.norm();
    if target < f64::EPSILON {
        return Some(distorted);
    }
    let mut theta = target;
    for _ in 0..MAX_STEPS {
        let residual = fisheye_angle(k, theta) - target;
        if residual.abs() < TOLERANCE {
            break;
        }
        let t2 = theta * theta;
        let slope =
            1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
        if slope <= 0.0 {
            return None;
        }
        theta -= residual / slope;
    }
    // At 90 degrees and beyond a point has no place on the plane z = 1.
    let converged = (fisheye_angle(k, theta) - target).abs() < TOLERANCE.sqrt();
    (converged && (0.0..std::f64::consts::FRAC_PI_2).contains(&theta))
        .then(|| distorted * (theta.tan() / target))
}
