//! Eq. 1 over several measurements.

use roadwatch_core::MeasuredFocal;

/// One measurement: an object of known height, seen at a known distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownObject {
    /// P: how high it appears, pixels.
    pub height_px: f64,
    /// D: its distance along the optical axis (`depth_m`), metres.
    pub distance_m: f64,
    /// W: its real height, metres.
    pub size_m: f64,
}

/// A measurement that eq. 1 cannot take.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FocalError {
    /// No measurement at all.
    #[error("no measurement")]
    None,
    /// A number that is not above zero.
    #[error("measurement {index}: {what} is {value}; expected a number above 0")]
    NotPositive {
        /// Its place, from 1.
        index: usize,
        /// Which number.
        what: &'static str,
        /// What was given.
        value: f64,
    },
}

/// Focal values of all measurements, and what they come to.
#[derive(Clone, Debug, PartialEq)]
pub struct FocalFit {
    /// The mean, with the image height that it belongs to.
    pub focal: MeasuredFocal,
    /// `F = P * D / W` of each measurement, pixels.
    pub each_px: Vec<f64>,
    /// Standard deviation among them, pixels; `None` for one measurement.
    pub spread_px: Option<f64>,
}

impl FocalFit {
    /// Eq. 1 for each measurement in an image `image_height_px` high.
    ///
    /// # Errors
    /// Without a measurement, or when a number is not finite and above zero.
    pub fn new(measurements: &[KnownObject], image_height_px: u32) -> Result<Self, FocalError> {
        for (at, known) in measurements.iter().enumerate() {
            check(at + 1, known)?;
        }
        let each_px: Vec<f64> = measurements
            .iter()
            .map(|known| {
                let (p, d, w) = (known.height_px, known.distance_m, known.size_m);
                MeasuredFocal::from_known_object(p, d, w, image_height_px).focal_px
            })
            .collect();
        if each_px.is_empty() {
            return Err(FocalError::None);
        }
        let count = each_px.len() as f64;
        let focal_px = each_px.iter().sum::<f64>() / count;
        let squares: f64 = each_px.iter().map(|each| (each - focal_px).powi(2)).sum();
        Ok(Self {
            focal: MeasuredFocal {
                focal_px,
                image_height_px,
            },
            spread_px: (each_px.len() > 1).then(|| (squares / (count - 1.0)).sqrt()),
            each_px,
        })
    }
}

fn check(index: usize, known: &KnownObject) -> Result<(), FocalError> {
    let numbers = [
        ("the height in pixels", known.height_px),
        ("the distance", known.distance_m),
        ("the real height", known.size_m),
    ];
    let wrong = numbers
        .into_iter()
        .find(|(_, value)| !(value.is_finite() && *value > 0.0));
    wrong.map_or(Ok(()), |(what, value)| {
        Err(FocalError::NotPositive { index, what, value })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(height_px: f64, distance_m: f64, size_m: f64) -> KnownObject {
        KnownObject {
            height_px,
            distance_m,
            size_m,
        }
    }

    #[test]
    fn the_papers_measurement_gives_its_focal_value_without_a_spread() {
        let fit = FocalFit::new(&[known(55.0, 50.0, 1.4)], 1080).expect("a fit");
        assert!((fit.focal.focal_px - 1964.28).abs() < 0.01);
        assert_eq!(fit.spread_px, None);
    }

    #[test]
    fn several_measurements_give_their_mean_and_their_spread() {
        let fit = FocalFit::new(&[known(50.0, 40.0, 2.0), known(55.0, 40.0, 2.0)], 540);
        let fit = fit.expect("a fit");
        assert_eq!(fit.each_px, [1000.0, 1100.0]);
        assert_eq!(fit.focal.focal_px, 1050.0);
        assert!((fit.spread_px.expect("two") - 70.71).abs() < 0.01);
    }

    #[test]
    fn what_cannot_be_is_named_with_its_place() {
        let refused = FocalFit::new(&[known(50.0, 40.0, 2.0), known(50.0, -4.0, 2.0)], 540);
        let expected = "measurement 2: the distance is -4; expected a number above 0";
        assert_eq!(refused.expect_err("negative").to_string(), expected);
        assert_eq!(FocalFit::new(&[], 540), Err(FocalError::None));
    }
}
