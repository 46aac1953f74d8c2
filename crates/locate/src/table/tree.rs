//! A bounding-volume tree over rows, eight children a node, that finds the row of least score exactly.
//!
//! Bounds are the sum of eq. 7 before its division by three, in the same order of operations as scores.
//! Every operation is monotone under rounding, so a node's bound never exceeds the sum of a row inside
//! it. A node is skipped only where its bound is strictly greater than any sum that could still matter,
//! so equal scores are all looked at and the lowest row index wins, as in a scan.

use super::{TableRow, query::TableQuery};

/// Children of a node and rows of a leaf: eight `f32` are two SSE registers or one AVX register.
const FAN_OUT: usize = 8;
/// Pads leaves; never a row, because a table holds fewer rows than this.
const NO_ROW: u32 = u32::MAX;
/// Pads what is empty. Two such differences overflow to infinity, which no limit admits; infinity itself
/// would become NaN under a weight of zero.
const FAR: f32 = f32::MAX;
/// Only for the shape of the tree, not for its answers: pixels that a metre of depth is worth.
const BUILD_PX_PER_METRE: f32 = 40.0;

/// Sums above `limit * SUM_PER_SCORE` have scores above the limit: three, and more than the rounding of
/// one division and one product, which is 2^-23.
const SUM_PER_SCORE: f32 = 3.000_002;

type Lanes = [f32; FAN_OUT];

/// Rows of one leaf, column by column.
#[derive(Clone, Debug)]
struct Leaf {
    x: Lanes,
    y: Lanes,
    d: Lanes,
    row: [u32; FAN_OUT],
}

/// Tight bounds of a node's eight children, column by column; empty children have inverted bounds.
#[derive(Clone, Debug)]
struct Bounds {
    min: [Lanes; 3],
    max: [Lanes; 3],
}

/// What a search keeps of the rows it is offered.
pub(super) trait Collect {
    /// Rows of a greater score than this are of no interest.
    fn limit(&self) -> f32;
    /// Takes a row of a score not greater than the limit.
    fn offer(&mut self, score: f32, row: u32);
}

/// The greatest bound that can still matter; finite, so that empty children never do.
fn bound_limit(found: &impl Collect) -> f32 {
    (found.limit() * SUM_PER_SCORE).min(f32::MAX)
}

/// The tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    leaves: Vec<Leaf>,
    /// Level 0 bounds the leaves, the last level has one node; empty where there is no row.
    levels: Vec<Vec<Bounds>>,
}

impl Tree {
    /// A tree over the rows whose indices are given.
    pub(super) fn new(rows: &[TableRow], mut chosen: Vec<u32>) -> Self {
        if chosen.is_empty() {
            return Self::default();
        }
        order(rows, &mut chosen);
        let leaves: Vec<Leaf> = chosen
            .chunks(FAN_OUT)
            .map(|chunk| leaf(rows, chunk))
            .collect();
        let extents: Vec<_> = leaves.iter().map(Leaf::extent).collect();
        let mut levels = vec![level(&extents)];
        while levels[levels.len() - 1].len() > 1 {
            let extents: Vec<_> = levels[levels.len() - 1]
                .iter()
                .map(Bounds::extent)
                .collect();
            levels.push(level(&extents));
        }
        Self { leaves, levels }
    }

    /// Offers every row that can matter to `found`, nearest parts of the tree first.
    pub(super) fn search(&self, query: &TableQuery, found: &mut impl Collect) {
        if let Some(top) = self.levels.len().checked_sub(1) {
            self.visit(query, top, 0, found);
        }
    }

    /// Visits the children of a node, nearest first, until the nearest one left cannot matter.
    fn visit(&self, query: &TableQuery, level: usize, node: usize, found: &mut impl Collect) {
        let mut bounds = self.levels[level][node].sums(query);
        loop {
            let lane = nearest_lane(&bounds);
            if bounds[lane] > bound_limit(found) {
                return;
            }
            bounds[lane] = f32::INFINITY;
            let child = node * FAN_OUT + lane;
            match level.checked_sub(1) {
                Some(below) => self.visit(query, below, child, found),
                None => self.leaves[child].offer_to(query, found),
            }
        }
    }
}

fn nearest_lane(bounds: &Lanes) -> usize {
    let mut nearest = 0;
    for lane in 1..FAN_OUT {
        if bounds[lane] < bounds[nearest] {
            nearest = lane;
        }
    }
    nearest
}

impl Leaf {
    fn offer_to(&self, query: &TableQuery, found: &mut impl Collect) {
        for (score, row) in self.scores(query).into_iter().zip(self.row) {
            if score <= found.limit() {
                found.offer(score, row);
            }
        }
    }

    fn scores(&self, query: &TableQuery) -> Lanes {
        std::array::from_fn(|lane| query.score_at(self.x[lane], self.y[lane], self.d[lane]))
    }

    fn extent(&self) -> ([f32; 3], [f32; 3]) {
        let filled = self.row.iter().filter(|&&row| row != NO_ROW).count();
        let columns = [self.x, self.y, self.d];
        (
            columns.map(|column| {
                column[..filled]
                    .iter()
                    .copied()
                    .fold(f32::INFINITY, f32::min)
            }),
            columns.map(|column| {
                column[..filled]
                    .iter()
                    .copied()
                    .fold(f32::NEG_INFINITY, f32::max)
            }),
        )
    }
}

impl Bounds {
    fn sums(&self, query: &TableQuery) -> Lanes {
        let [x, y, d] = [query.center_x_px, query.center_y_px, query.distance_m];
        std::array::from_fn(|lane| {
            query.sum_of(
                outside(self.min[0][lane], x, self.max[0][lane]),
                outside(self.min[1][lane], y, self.max[1][lane]),
                outside(self.min[2][lane], d, self.max[2][lane]),
            )
        })
    }

    fn extent(&self) -> ([f32; 3], [f32; 3]) {
        (
            self.min
                .map(|lanes| lanes.into_iter().fold(f32::INFINITY, f32::min)),
            self.max
                .map(|lanes| lanes.into_iter().fold(f32::NEG_INFINITY, f32::max)),
        )
    }
}

/// How far `at` lies outside `min..=max`, zero inside. Written with comparisons, because `f32::max`
/// looks for NaN and there is none here.
fn outside(min: f32, at: f32, max: f32) -> f32 {
    let (below, above) = (min - at, at - max);
    let farther = if below > above { below } else { above };
    if farther > 0.0 { farther } else { 0.0 }
}

fn leaf(rows: &[TableRow], chunk: &[u32]) -> Leaf {
    let column = |value: fn(&TableRow) -> f32| {
        let mut lanes = [FAR; FAN_OUT];
        for (lane, &row) in lanes.iter_mut().zip(chunk) {
            *lane = value(&rows[row as usize]);
        }
        lanes
    };
    let mut row = [NO_ROW; FAN_OUT];
    row[..chunk.len()].copy_from_slice(chunk);
    Leaf {
        x: column(|row| row.center_x_px),
        y: column(|row| row.center_y_px),
        d: column(|row| row.distance_m),
        row,
    }
}

fn level(extents: &[([f32; 3], [f32; 3])]) -> Vec<Bounds> {
    extents
        .chunks(FAN_OUT)
        .map(|children| {
            let mut bounds = Bounds {
                min: [[FAR; FAN_OUT]; 3],
                max: [[-FAR; FAN_OUT]; 3],
            };
            for (lane, (min, max)) in children.iter().enumerate() {
                for axis in 0..3 {
                    bounds.min[axis][lane] = min[axis];
                    bounds.max[axis][lane] = max[axis];
                }
            }
            bounds
        })
        .collect()
}

/// Puts rows that are near each other side by side: halves the widest axis again and again, at
/// multiples of a power of eight, so that eight consecutive nodes are one node of the next level.
fn order(rows: &[TableRow], chosen: &mut [u32]) {
    if chosen.len() <= FAN_OUT {
        return;
    }
    let key = widest_axis(rows, chosen);
    let mut block = FAN_OUT;
    while block * FAN_OUT <= chosen.len() / 2 {
        block *= FAN_OUT;
    }
    let middle = (chosen.len() / 2).next_multiple_of(block);
    chosen.select_nth_unstable_by(middle, |&a, &b| {
        key(&rows[a as usize]).total_cmp(&key(&rows[b as usize]))
    });
    let (left, right) = chosen.split_at_mut(middle);
    order(rows, left);
    order(rows, right);
}

fn widest_axis(rows: &[TableRow], chosen: &[u32]) -> fn(&TableRow) -> f32 {
    let axes: [fn(&TableRow) -> f32; 3] = [
        |row| row.center_x_px,
        |row| row.center_y_px,
        |row| row.distance_m * BUILD_PX_PER_METRE,
    ];
    let width = |axis: fn(&TableRow) -> f32| {
        let (mut min, mut max) = (f32::INFINITY, f32::NEG_INFINITY);
        for &row in chosen {
            let value = axis(&rows[row as usize]);
            min = min.min(value);
            max = max.max(value);
        }
        max - min
    };
    let mut widest = axes[0];
    for axis in axes {
        if width(axis) > width(widest) {
            widest = axis;
        }
    }
    widest
}
