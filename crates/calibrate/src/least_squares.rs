//! Damped least squares (Levenberg and Marquardt) with Huber's weights, for a handful of parameters.

use nalgebra::{DMatrix, DVector};

/// Residuals beyond this many standard deviations pull linearly only: 95 % efficiency on normal noise
/// (Huber, Robust Estimation of a Location Parameter, 1964).
pub(crate) const HUBER: f64 = 1.345;
const MAX_STEPS: usize = 60;
/// Damping at the start, and what a refused or an accepted step changes it by (Marquardt 1963).
const DAMPING: f64 = 1e-3;
const DAMPING_FACTOR: f64 = 8.0;
const MOST_DAMPING: f64 = 1e12;
/// A step that lowers the cost by less than this share is the last.
const CONVERGED: f64 = 1e-10;

/// The cost at a place, with its slope and the information (half the second derivative, as Gauss and Newton
/// approximate it).
pub(crate) struct Normal {
    pub(crate) cost: f64,
    pub(crate) information: DMatrix<f64>,
    pub(crate) gradient: DVector<f64>,
}

impl Normal {
    pub(crate) fn zero(parameters: usize) -> Self {
        Self {
            cost: 0.0,
            information: DMatrix::zeros(parameters, parameters),
            gradient: DVector::zeros(parameters),
        }
    }

    /// Of independent residuals in standard deviations, with slopes by differences of `steps`. `None` where
    /// a residual has no value.
    pub(crate) fn of_residuals(
        at: &DVector<f64>,
        steps: &[f64],
        residuals: &dyn Fn(&DVector<f64>) -> Option<Vec<f64>>,
    ) -> Option<Self> {
        let here = residuals(at)?;
        let slopes = slopes(at, steps, residuals)?;
        let mut normal = Self::zero(at.len());
        for (index, &residual) in here.iter().enumerate() {
            let weight = huber_weight(residual);
            let slope = slopes.row(index).transpose();
            normal.cost += huber_cost(residual);
            normal.information += &slope * slope.transpose() * weight;
            normal.gradient += slope * (weight * residual);
        }
        Some(normal)
    }
}

/// The weight that a residual in standard deviations keeps.
pub(crate) fn huber_weight(residual: f64) -> f64 {
    (HUBER / residual.abs()).min(1.0)
}

/// Half its square, linear beyond [`HUBER`].
pub(crate) fn huber_cost(residual: f64) -> f64 {
    let size = residual.abs();
    if size <= HUBER {
        size * size / 2.0
    } else {
        HUBER * (size - HUBER / 2.0)
    }
}

/// One column per parameter; `None` where a residual has no value within a step.
fn slopes(
    at: &DVector<f64>,
    steps: &[f64],
    residuals: &dyn Fn(&DVector<f64>) -> Option<Vec<f64>>,
) -> Option<DMatrix<f64>> {
    let columns: Option<Vec<DVector<f64>>> = steps
        .iter()
        .enumerate()
        .map(|(parameter, &step)| {
            let moved = |by: f64| {
                let mut place = at.clone();
                place[parameter] += by;
                residuals(&place).map(DVector::from_vec)
            };
            Some((moved(step)? - moved(-step)?) / (2.0 * step))
        })
        .collect();
    Some(DMatrix::from_columns(&columns?))
}

/// Where the cost is least.
pub(crate) struct Minimum {
    pub(crate) at: DVector<f64>,
    pub(crate) normal: Normal,
}

impl Minimum {
    /// Inverse of the information; `None` when a parameter is not determined.
    pub(crate) fn covariance(&self) -> Option<DMatrix<f64>> {
        let inverse = self.normal.information.clone().try_inverse()?;
        let sound = inverse.diagonal().iter().all(|&v| v.is_finite() && v > 0.0);
        sound.then_some(inverse)
    }
}

/// Goes downhill from `start`; `None` when there is no value there.
pub(crate) fn minimise(
    start: DVector<f64>,
    normal: &dyn Fn(&DVector<f64>) -> Option<Normal>,
) -> Option<Minimum> {
    let mut here = Minimum {
        normal: normal(&start)?,
        at: start,
    };
    let mut damping = DAMPING;
    for _ in 0..MAX_STEPS {
        let Some(next) = step(&here, damping, normal) else {
            damping *= DAMPING_FACTOR;
            if damping > MOST_DAMPING {
                break;
            }
            continue;
        };
        let gained = here.normal.cost - next.normal.cost;
        let is_last = gained <= CONVERGED * here.normal.cost;
        here = next;
        damping /= DAMPING_FACTOR;
        if is_last {
            break;
        }
    }
    Some(here)
}

/// One damped step; `None` when it leads nowhere lower.
fn step(
    here: &Minimum,
    damping: f64,
    normal: &dyn Fn(&DVector<f64>) -> Option<Normal>,
) -> Option<Minimum> {
    let mut damped = here.normal.information.clone();
    for at in 0..damped.nrows() {
        damped[(at, at)] += damping * damped[(at, at)].max(f64::MIN_POSITIVE);
    }
    let by = damped.cholesky()?.solve(&here.normal.gradient);
    let at = &here.at - by;
    let normal = normal(&at).filter(|normal| normal.cost <= here.normal.cost)?;
    Some(Minimum { at, normal })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlier_does_not_pull_a_line_away() {
        let points: Vec<(f64, f64)> = (0..20)
            .map(|x| (f64::from(x), 3.0 + 0.5 * f64::from(x)))
            .chain([(5.0, 400.0)])
            .collect();
        let residuals = |at: &DVector<f64>| {
            let all = points.iter().map(|(x, y)| y - at[0] - at[1] * x);
            Some(all.collect::<Vec<_>>())
        };
        let normal = |at: &DVector<f64>| Normal::of_residuals(at, &[1e-4, 1e-4], &residuals);
        let found = minimise(DVector::from_vec(vec![0.0, 0.0]), &normal).expect("a minimum");
        assert!((found.at[0] - 3.0).abs() < 0.3 && (found.at[1] - 0.5).abs() < 0.02);
        assert!(found.covariance().expect("determined")[(1, 1)] < 0.01);
    }

    #[test]
    fn what_is_not_determined_has_no_covariance() {
        let residuals = |at: &DVector<f64>| Some(vec![at[0] + at[1] - 1.0]);
        let normal = |at: &DVector<f64>| Normal::of_residuals(at, &[1e-4, 1e-4], &residuals);
        let found = minimise(DVector::from_vec(vec![0.0, 0.0]), &normal).expect("a minimum");
        assert!(found.covariance().is_none());
    }
}
