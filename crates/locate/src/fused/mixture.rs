//! From many explanations of a box to one place, its covariance, and the headings that are left.

use super::fit::Explanation;
use arrayvec::ArrayVec;
use nalgebra::{Matrix2, Vector2};
use roadwatch_core::{Heading, HeadingCandidate, HeadingCandidates};
use std::f64::consts::PI;

/// Headings tried, evenly over half a turn: front and back cast the same outline.
pub(super) const HEADINGS: usize = 8;
/// The box as it is, and three hidden edges, for each heading.
pub(super) const MOST_EXPLANATIONS: usize = 4 * HEADINGS;
/// An explanation that costs more than the best one by this is a millionth as likely.
const GREATEST_COST: f64 = 28.0;
/// A side of the ray less likely than this has no heading.
const LEAST_WEIGHT: f64 = 0.02;

/// Explanations with weights that sum to 1.
pub(super) struct Mixture {
    weighted: ArrayVec<(f64, Explanation), MOST_EXPLANATIONS>,
}

impl Mixture {
    /// `None` of nothing.
    pub(super) fn new(explanations: &[Explanation]) -> Option<Self> {
        let costs = explanations.iter().map(|of| of.cost);
        let least = costs.min_by(f64::total_cmp)?;
        let weighted = explanations
            .iter()
            .filter(|of| of.cost - least < GREATEST_COST);
        let weighted = weighted.map(|of| (of.scale * (0.5 * (least - of.cost)).exp(), *of));
        let mut weighted: ArrayVec<_, MOST_EXPLANATIONS> = weighted.collect();
        let sum: f64 = weighted.iter().map(|(weight, _)| weight).sum();
        for (weight, _) in &mut weighted {
            *weight /= sum;
        }
        (sum > 0.0).then_some(Self { weighted })
    }

    /// The likeliest of all.
    pub(super) fn best(&self) -> Option<&Explanation> {
        let weighted = self.weighted.iter();
        let best = weighted.max_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, explanation)| explanation)
    }

    /// Mean and covariance of the place, metres.
    pub(super) fn place(&self) -> (Vector2<f64>, Matrix2<f64>) {
        let parts = || self.weighted.iter();
        let mean: Vector2<f64> = parts().map(|(weight, of)| of.place * *weight).sum();
        let covariance = parts().map(|(weight, of)| {
            let apart = of.place - mean;
            (of.covariance + apart * apart.transpose()) * *weight
        });
        (mean, covariance.sum())
    }

    /// The likeliest heading on either side of the ray, which looks along `ray_rad`, each with its opposite.
    pub(super) fn headings(&self, ray_rad: f64) -> HeadingCandidates {
        let mut weights = [0.0; HEADINGS];
        for (weight, of) in &self.weighted {
            weights[of.heading] += weight;
        }
        let sides: [bool; HEADINGS] =
            std::array::from_fn(|heading| wrapped(yaw_of(heading) - ray_rad, PI) >= 0.0);
        let found =
            [true, false].map(|side| self.heading_on(&sides.map(|of| of == side), &weights));
        let mut found = ArrayVec::from(found);
        found.retain(|(weight, _)| *weight >= LEAST_WEIGHT);
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let kept: f64 = found.iter().map(|(weight, _)| weight).sum();
        let both_ways = |(weight, heading): (f64, Heading)| {
            [0.0, PI].map(|turn| HeadingCandidate {
                heading: Heading {
                    yaw_rad: wrapped(heading.yaw_rad + turn, 2.0 * PI),
                    ..heading
                },
                weight: weight / kept / 2.0,
            })
        };
        found.into_iter().flat_map(both_ways).collect()
    }

    /// The weight of one side of the ray, and its best heading, with a deviation over all of the side.
    fn heading_on(&self, side: &[bool; HEADINGS], weights: &[f64; HEADINGS]) -> (f64, Heading) {
        let of_side = (0..HEADINGS).filter(|&heading| side[heading]);
        let best = of_side
            .max_by(|&a, &b| weights[a].total_cmp(&weights[b]))
            .unwrap_or(0);
        let explanations = self.weighted.iter().filter(|(_, of)| side[of.heading]);
        let at_best = explanations.clone().filter(|(_, of)| of.heading == best);
        let turns = at_best.map(|(weight, of)| weight * of.turn_rad);
        let yaw_rad = yaw_of(best) + turns.sum::<f64>() / weights[best];
        let mut sum = 0.0;
        let mut variance = 0.0;
        for (weight, of) in explanations {
            let apart = wrapped(yaw_of(of.heading) + of.turn_rad - yaw_rad, PI);
            sum += weight;
            variance += weight * (of.turn_std_rad * of.turn_std_rad + apart * apart);
        }
        let std_dev_rad = (variance / sum).sqrt();
        (
            sum,
            Heading {
                yaw_rad,
                std_dev_rad,
                // The opposite is a candidate of its own.
                flip_probability: 0.0,
            },
        )
    }
}

/// The yaw of a heading tried, radians in base_link.
pub(super) fn yaw_of(heading: usize) -> f64 {
    PI * heading as f64 / HEADINGS as f64
}

/// An angle in -period/2..=period/2.
pub(super) fn wrapped(angle_rad: f64, period: f64) -> f64 {
    angle_rad - period * (angle_rad / period).round()
}
