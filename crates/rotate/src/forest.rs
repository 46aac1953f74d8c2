//! The forest: from a row of key components to an observation angle with its deviation.

mod file;
mod training;

use crate::{angle::ObservationAngle, recipe::Recipe, row::Row};
pub use file::ForestFileError;
use roadwatch_core::angle::wrapped;
use std::f64::consts::{FRAC_PI_2, PI};
pub use training::{ForestOptions, TrainingError};

/// A node that is a leaf has no feature.
const LEAF: u16 = u16::MAX;

/// One node; trees are read far more often than grown, so all of them lie in one array.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    /// The feature that decides, or [`LEAF`].
    feature: u16,
    /// What it is compared with; the answer in a leaf.
    value: f32,
    /// Where to go on when the feature is at most the value; the other child is the next number.
    next: u32,
}

/// Pairs of trees, for the cosine and the sine of the observation angle, grown from the same samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    recipe: Recipe,
    components: Vec<String>,
    facing_bins: usize,
    nodes: Vec<Node>,
    /// Roots of each pair.
    roots: Vec<[u32; 2]>,
    /// What the trees' spread is multiplied by: single trees stray more than their mean.
    deviation_scale: f64,
}

/// What a forest says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turned {
    /// The mean over the trees.
    pub angle: ObservationAngle,
    /// Spread of the trees on the mean's side of the circle, radians, scaled so that on rows that a forest was not
    /// grown on two errors of three are within it.
    pub std_dev_rad: f64,
    /// Share of the trees that point the other way: more than a right angle from the mean.
    pub flip_share: f64,
}

impl Forest {
    /// Which features it was grown on.
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        self.recipe
    }

    /// Names of the components it was grown on.
    #[must_use]
    pub fn components(&self) -> &[String] {
        &self.components
    }

    /// Directions it expects in [`Row::facing`].
    #[must_use]
    pub fn facing_bins(&self) -> usize {
        self.facing_bins
    }

    /// Pairs of trees.
    #[must_use]
    pub fn trees(&self) -> usize {
        self.roots.len()
    }

    /// The angle of a row of the components that it was grown on. `features` is used again from row to row.
    #[must_use]
    pub fn turn(&self, row: &Row, features: &mut Vec<f64>) -> Turned {
        self.recipe.features(row, &self.components, features);
        let answers = || {
            self.roots
                .iter()
                .map(|root| root.map(|tree| f64::from(self.answer(tree, features))))
        };
        let (cos, sin) = answers().fold((0.0, 0.0), |sum, [cos, sin]| (sum.0 + cos, sum.1 + sin));
        let mean = sin.atan2(cos);
        let (mut variance, mut flipped) = (0.0, 0.0);
        for [cos, sin] in answers() {
            let apart = wrapped(sin.atan2(cos) - mean);
            // A tree between two answers gives a short vector: as wide as that says, at most a uniform angle.
            let length = cos.hypot(sin).clamp(f64::EPSILON, 1.0);
            let own = (-2.0 * length.ln()).min(PI * PI / 3.0);
            if apart.abs() > FRAC_PI_2 {
                flipped += 1.0;
            } else {
                variance += apart * apart + own;
            }
        }
        let trees = self.roots.len() as f64;
        Turned {
            angle: ObservationAngle::new(mean),
            std_dev_rad: self.deviation_scale * (variance / (trees - flipped).max(1.0)).sqrt(),
            flip_share: flipped / trees,
        }
    }

    fn answer(&self, root: u32, features: &[f64]) -> f32 {
        let mut at = root as usize;
        loop {
            let node = &self.nodes[at];
            if node.feature == LEAF {
                return node.value;
            }
            let goes_on = features[usize::from(node.feature)] <= f64::from(node.value);
            at = node.next as usize + usize::from(!goes_on);
        }
    }
}
