//! One object's boxes share its unknown size: their common part says little, their differences much.

use crate::least_squares::{Normal, huber_cost, huber_weight};
use nalgebra::DVector;

/// Rounds of weights; each halves what is left of the error or better.
const ROUNDS: usize = 12;

/// What one box says.
pub(crate) struct Residual {
    /// Logarithm of its height over the predicted one.
    pub(crate) off: f64,
    /// Its slope by the parameters.
    pub(crate) slope: DVector<f64>,
    /// Its standard deviation apart from the object's size.
    pub(crate) std: f64,
}

/// The boxes of one object, and the size of the object (logarithm, over its class) that explains them best.
pub(crate) struct Track<'a> {
    residuals: &'a [Residual],
    spread: f64,
    effect: f64,
}

impl<'a> Track<'a> {
    /// `spread` is the standard deviation of sizes within the class, as a share.
    pub(crate) fn new(residuals: &'a [Residual], spread: f64) -> Self {
        let mut track = Self {
            residuals,
            spread,
            effect: 0.0,
        };
        for _ in 0..ROUNDS {
            let said = track.weights().map(|(weight, r)| (weight, weight * r.off));
            let (weights, sum) = said.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
            track.effect = sum / (weights + track.own_weight());
        }
        track
    }

    /// Each residual with its weight, one over its variance where it is no outlier.
    fn weights(&self) -> impl Iterator<Item = (f64, &'a Residual)> + use<'a> {
        let effect = self.effect;
        self.residuals.iter().map(move |r| {
            let weight = huber_weight((r.off - effect) / r.std);
            (weight / (r.std * r.std), r)
        })
    }

    /// How strongly the object's size is held to its class's.
    fn own_weight(&self) -> f64 {
        huber_weight(self.effect / self.spread) / (self.spread * self.spread)
    }

    /// Adds the cost at the best size; what that size absorbs is no information about the mount.
    pub(crate) fn add_to(&self, normal: &mut Normal) {
        let parameters = normal.gradient.len();
        let mut absorbed = DVector::zeros(parameters);
        let mut held = self.own_weight();
        normal.cost += huber_cost(self.effect / self.spread);
        for (weight, r) in self.weights() {
            normal.cost += huber_cost((r.off - self.effect) / r.std);
            normal.gradient += &r.slope * (weight * (r.off - self.effect));
            normal.information += &r.slope * r.slope.transpose() * weight;
            absorbed += &r.slope * weight;
            held += weight;
        }
        normal.information -= &absorbed * absorbed.transpose() / held;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn residual(off: f64) -> Residual {
        Residual {
            off,
            slope: DVector::from_vec(vec![1.0]),
            std: 0.05,
        }
    }

    #[test]
    fn many_boxes_of_one_object_are_worth_one_object() {
        let residuals: Vec<_> = (0..1000).map(|_| residual(0.1)).collect();
        let mut normal = Normal::zero(1);
        Track::new(&residuals, 0.13).add_to(&mut normal);
        let expected = 1.0 / (0.13 * 0.13);
        assert!((normal.information[(0, 0)] / expected - 1.0).abs() < 0.01);
    }

    #[test]
    fn the_size_that_explains_the_boxes_is_found_beside_an_outlier() {
        let residuals: Vec<_> = [0.1, 0.11, 0.09, 0.1, 3.0].map(residual).into();
        let track = Track::new(&residuals, 0.13);
        assert!((track.effect - 0.1).abs() < 0.03, "{}", track.effect);
    }
}
