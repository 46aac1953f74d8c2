//! Growing a forest with smartcore, and taking its trees out into one array.

use super::{Forest, LEAF, Node};
use crate::{
    recipe::Recipe,
    row::{LabelledRow, RowTable},
};
use serde::Deserialize;
use smartcore::{
    ensemble::random_forest_regressor::{RandomForestRegressor, RandomForestRegressorParameters},
    linalg::basic::matrix::DenseMatrix,
};
use std::f64::consts::FRAC_PI_2;

/// Trees grown between two words of progress.
const TREES_AT_A_TIME: usize = 5;
/// Fewer rows say nothing of a full turn.
const LEAST_ROWS: usize = 100;

/// To find out how far forests stray, one is grown without every so many-th row, and asked for those.
const HELD_OUT_EVERY: usize = 5;
/// Share of a Gaussian's errors within one standard deviation.
const WITHIN_ONE_SIGMA: f64 = 0.683;

/// How a forest is grown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForestOptions {
    /// Which features.
    pub recipe: Recipe,
    /// Pairs of trees.
    pub trees: usize,
    /// Most questions on the way to a leaf.
    pub depth: u16,
    /// Fewest rows in a leaf.
    pub leaf_rows: usize,
    /// Which samples are drawn.
    pub seed: u64,
}

impl Default for ForestOptions {
    /// Sixty trees are within a tenth of a degree of two hundred, leaves of four rows keep the file small.
    fn default() -> Self {
        Self {
            recipe: Recipe::Roadwatch,
            trees: 60,
            depth: 14,
            leaf_rows: 4,
            seed: 1,
        }
    }
}

/// Rows that no forest grows on.
#[derive(Debug, thiserror::Error)]
pub enum TrainingError {
    /// Too few.
    #[error("{0} rows are too few for a forest: {LEAST_ROWS} at least, better thousands")]
    FewRows(usize),
    /// smartcore refused.
    #[error("no forest grows on these rows: {0}")]
    Refused(String),
}

/// smartcore keeps its trees to itself; what it writes down of them is this.
#[derive(Deserialize)]
struct Grown {
    forest_regressor: GrownForest,
}

#[derive(Deserialize)]
struct GrownForest {
    trees: Vec<GrownTree>,
}

#[derive(Deserialize)]
struct GrownTree {
    nodes: Vec<GrownNode>,
}

#[derive(Clone, Copy, Deserialize)]
struct GrownNode {
    output: f64,
    split_feature: usize,
    split_value: Option<f64>,
    true_child: Option<usize>,
    false_child: Option<usize>,
}

impl Forest {
    /// Grows a forest, and before it another one on four rows of five, which tells how far forests stray on rows that
    /// they do not know. `grown` hears how many pairs of trees there are, of how many.
    ///
    /// # Errors
    /// See [`TrainingError`].
    pub fn grow(
        table: &RowTable,
        options: ForestOptions,
        mut grown: impl FnMut(usize, usize),
    ) -> Result<Self, TrainingError> {
        if table.rows.len() < LEAST_ROWS {
            return Err(TrainingError::FewRows(table.rows.len()));
        }
        let is_held = |at: usize| at % HELD_OUT_EVERY == HELD_OUT_EVERY - 1;
        let part = |held: bool| {
            let rows = table.rows.iter().enumerate();
            let rows = rows.filter(|(at, _)| is_held(*at) == held);
            RowTable {
                rows: rows.map(|(_, row)| row.clone()).collect(),
                ..table.clone()
            }
        };
        let total = 2 * options.trees;
        let known = Self::grow_on(&part(false), options, |trees| grown(trees, total))?;
        let deviation_scale = known.scale_on(&part(true));
        let forest = Self::grow_on(table, options, |trees| {
            grown(options.trees + trees, total);
        })?;
        Ok(Self {
            deviation_scale,
            ..forest
        })
    }

    /// What this forest's deviations have to be multiplied by for those rows; 1 where it turns all of them round.
    fn scale_on(&self, unknown: &RowTable) -> f64 {
        let mut features = Vec::new();
        let ratio = |labelled: &LabelledRow| {
            let found = self.turn(&labelled.row, &mut features);
            let off_rad = found.angle.apart_rad(labelled.angle);
            (off_rad <= FRAC_PI_2).then(|| off_rad / found.std_dev_rad.max(f64::EPSILON))
        };
        let mut ratios: Vec<f64> = unknown.rows.iter().filter_map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let at = (ratios.len() as f64 * WITHIN_ONE_SIGMA) as usize;
        ratios.get(at).copied().unwrap_or(1.0).max(f64::EPSILON)
    }

    fn grow_on(
        table: &RowTable,
        options: ForestOptions,
        mut grown: impl FnMut(usize),
    ) -> Result<Self, TrainingError> {
        let mut forest = Self {
            recipe: options.recipe,
            components: table.components.clone(),
            facing_bins: table.facing_bins,
            nodes: Vec::new(),
            roots: Vec::new(),
            deviation_scale: 1.0,
        };
        let features = forest.matrix(table)?;
        let aims = |of: fn(f64) -> f64| {
            let angle = |one: &LabelledRow| of(one.angle.radians());
            table.rows.iter().map(angle).collect::<Vec<f64>>()
        };
        let aims = [aims(f64::cos), aims(f64::sin)];
        while forest.roots.len() < options.trees {
            let before = forest.roots.len();
            let more = TREES_AT_A_TIME.min(options.trees - before);
            let [cosines, sines] = [&aims[0], &aims[1]].map(|aims| {
                let parameters = parameters(options, more, before as u64, table);
                trees(&features, aims, parameters)
            });
            for (cosine, sine) in cosines?.iter().zip(&sines?) {
                let roots = [cosine, sine].map(|tree| forest.plant(tree));
                forest.roots.push(roots);
            }
            grown(forest.roots.len());
        }
        Ok(forest)
    }

    fn matrix(&self, table: &RowTable) -> Result<DenseMatrix<f64>, TrainingError> {
        let row = |labelled: &LabelledRow| {
            let mut features = Vec::new();
            self.recipe
                .features(&labelled.row, &self.components, &mut features);
            features
        };
        let rows: Vec<Vec<f64>> = table.rows.iter().map(row).collect();
        DenseMatrix::from_2d_vec(&rows).map_err(|error| TrainingError::Refused(error.to_string()))
    }

    /// Puts a tree into the array, children next to each other; gives its root.
    fn plant(&mut self, tree: &GrownTree) -> u32 {
        let root = self.nodes.len();
        let mut waiting = vec![(0, root)];
        self.nodes.push(leaf(tree.nodes[0].output));
        while let Some((from, to)) = waiting.pop() {
            let node = tree.nodes[from];
            let split = node.true_child.zip(node.false_child).zip(node.split_value);
            let Some(((yes, no), value)) = split else {
                continue;
            };
            let next = self.nodes.len();
            self.nodes.push(leaf(tree.nodes[yes].output));
            self.nodes.push(leaf(tree.nodes[no].output));
            self.nodes[to] = Node {
                feature: node.split_feature as u16,
                value: value as f32,
                next: next as u32,
            };
            waiting.extend([(yes, next), (no, next + 1)]);
        }
        root as u32
    }
}

fn leaf(answer: f64) -> Node {
    Node {
        feature: LEAF,
        value: answer as f32,
        next: 0,
    }
}

/// Cosine and sine draw the same samples, for they have the same seed.
fn parameters(
    options: ForestOptions,
    trees: usize,
    before: u64,
    table: &RowTable,
) -> RandomForestRegressorParameters {
    let mut features = Vec::new();
    options
        .recipe
        .features(&table.rows[0].row, &table.components, &mut features);
    RandomForestRegressorParameters::default()
        .with_n_trees(trees)
        .with_max_depth(options.depth)
        .with_min_samples_leaf(options.leaf_rows)
        // All of them: by default smartcore tries their square root, which is far worse in regression.
        .with_m(features.len())
        .with_seed(options.seed.wrapping_mul(1_000_003).wrapping_add(before))
}

fn trees(
    features: &DenseMatrix<f64>,
    aims: &Vec<f64>,
    parameters: RandomForestRegressorParameters,
) -> Result<Vec<GrownTree>, TrainingError> {
    let refused = |error: &dyn std::error::Error| TrainingError::Refused(error.to_string());
    let forest =
        RandomForestRegressor::fit(features, aims, parameters).map_err(|error| refused(&error))?;
    let written = serde_json::to_value(&forest).map_err(|error| refused(&error))?;
    let grown: Grown = serde_json::from_value(written).map_err(|error| refused(&error))?;
    Ok(grown.forest_regressor.trees)
}
