//! Whether covariances are honest: errors against the spread that was admitted.

use crate::{
    sample::{Deviation, Estimate},
    score::{mean, share},
};
use serde::Serialize;

/// The errors along and across the ray, in standard deviations of the estimate. Every figure is `None` without
/// samples.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct NeesScore {
    /// Number of samples.
    pub n: usize,
    /// Mean of `error^2 / variance` along the ray (the normalised estimation error squared, one dimension:
    /// 1 is honest, more is too sure; Bar-Shalom, Li and Kirubarajan 2001, section 5.4).
    pub radial: Option<f64>,
    /// The same across the ray.
    pub tangential: Option<f64>,
    /// Share of errors within one standard deviation, both directions together; 0.683 of a Gaussian.
    pub share_1_sigma: Option<f64>,
    /// Within two; 0.954 of a Gaussian.
    pub share_2_sigma: Option<f64>,
    /// Within one, along the ray.
    pub share_1_sigma_radial: Option<f64>,
    /// Within two, along the ray.
    pub share_2_sigma_radial: Option<f64>,
    /// Within one, across the ray.
    pub share_1_sigma_tangential: Option<f64>,
    /// Within two, across the ray.
    pub share_2_sigma_tangential: Option<f64>,
}

impl NeesScore {
    /// Scores estimates.
    pub(crate) fn of<'a>(estimates: impl Iterator<Item = &'a Estimate>) -> Self {
        let (radial, tangential): (Vec<_>, Vec<_>) = estimates
            .map(|estimate| (estimate.radial, estimate.tangential))
            .unzip();
        let both = [radial.as_slice(), &tangential].concat();
        Self {
            n: radial.len(),
            radial: nees(&radial),
            tangential: nees(&tangential),
            share_1_sigma: share_within(&both, 1.0),
            share_2_sigma: share_within(&both, 2.0),
            share_1_sigma_radial: share_within(&radial, 1.0),
            share_2_sigma_radial: share_within(&radial, 2.0),
            share_1_sigma_tangential: share_within(&tangential, 1.0),
            share_2_sigma_tangential: share_within(&tangential, 2.0),
        }
    }
}

fn nees(deviations: &[Deviation]) -> Option<f64> {
    mean(
        deviations
            .iter()
            .map(|deviation| deviation.sigmas().powi(2)),
    )
}

/// Share of the errors within so many standard deviations; `None` of nothing.
pub(crate) fn share_within(deviations: &[Deviation], sigmas: f64) -> Option<f64> {
    let within = deviations.iter().filter(|d| d.sigmas() <= sigmas);
    share(within.count(), deviations.len())
}

#[cfg(test)]
mod tests {
    use crate::{
        made::{CAR_TRUTH, camera, location},
        sample::{Estimator, Sample, Target},
        score::Figures,
    };
    use nalgebra::{Matrix3, Rotation3, Vector3};
    use roadwatch_core::space::{Covariance, Point};
    use std::{f64::consts::FRAC_PI_4, sync::Arc};

    /// A car straight ahead and to the left by 45 degrees, found 2 m too far and 0.5 m to the left, by an
    /// estimator that admits 1 m along the ray and 2 m across.
    fn slanted() -> Sample {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), FRAC_PI_4);
        let center = turn * Vector3::new(20.0, 0.0, 0.7);
        let found = turn * Vector3::new(22.0, 0.5, 0.7);
        let object = crate::truth::TruthObject {
            center: Point::new(center.x, center.y, center.z),
            ..CAR_TRUTH.clone()
        };
        let spread = turn * Matrix3::from_diagonal(&Vector3::new(1.0, 4.0, 1.0)) * turn.inverse();
        let target = Arc::new(Target::new(&object, &camera(), true));
        let answer = roadwatch_core::Location {
            covariance: Covariance::new(spread),
            ..location(Point::new(found.x, found.y, found.z))
        };
        Sample::judge(Estimator::Published, &target, Some((&answer, None)))
    }

    #[test]
    fn errors_are_taken_apart_along_and_across_the_ray() {
        let near =
            |value: Option<f64>, expected: f64| (value.unwrap_or(f64::NAN) - expected).abs() < 1e-9;
        let nees = Figures::of(&[slanted()]).nees;
        assert!(near(nees.radial, 4.0), "{nees:?}");
        assert!(near(nees.tangential, 0.0625), "{nees:?}");
        assert_eq!(nees.share_1_sigma, Some(0.5));
        assert_eq!(nees.share_1_sigma_radial, Some(0.0));
        assert_eq!(nees.share_1_sigma_tangential, Some(1.0));
        assert_eq!(nees.share_2_sigma, Some(1.0));
    }
}
