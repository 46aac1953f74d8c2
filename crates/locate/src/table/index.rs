//! Exact search: the row a scan would find, without the scan.

use super::{
    LocationTable, TableRow,
    query::TableQuery,
    tree::{Collect, Tree},
};
use roadwatch_core::RigCamera;
use std::sync::Arc;

/// Half-width of the band around LocX = 0 that both halves keep. A silhouette's middle strays from its
/// object's by up to about half a metre, a camera's roll and box noise move it by as much again.
const DEFAULT_GUARD_M: f32 = 2.0;

/// Which rows a query looks at (eq. 3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// As the paper prints it: `Center_x > width/2` keeps `LocX >= 0`, otherwise `LocX < 0`.
    Literal {
        /// Width of the image, pixels.
        image_width_px: f32,
    },
    /// Split where the azimuth is zero, with a band around LocX = 0 that belongs to both halves.
    Axis {
        /// The column of zero azimuth: the principal point.
        column_px: f32,
        /// Half-width of the shared band, metres.
        guard_m: f32,
    },
}

impl Split {
    /// The paper's split of a camera's image.
    #[must_use]
    pub fn literal(camera: &RigCamera) -> Self {
        Self::Literal {
            image_width_px: camera.model.size.width_px as f32,
        }
    }

    /// The split at a camera's principal point, which on real cameras is tens of pixels from the middle.
    #[must_use]
    pub fn axis(camera: &RigCamera) -> Self {
        Self::Axis {
            column_px: camera.model.intrinsics.cx as f32,
            guard_m: DEFAULT_GUARD_M,
        }
    }

    fn half_of(&self, center_x_px: f32) -> Half {
        let column_px = match self {
            Self::Literal { image_width_px } => image_width_px / 2.0,
            Self::Axis { column_px, .. } => *column_px,
        };
        if center_x_px > column_px {
            Half::Right
        } else {
            Half::Left
        }
    }

    fn keeps(&self, half: Half, loc_x_m: f32) -> bool {
        match (self, half) {
            (Self::Literal { .. }, Half::Right) => loc_x_m >= 0.0,
            (Self::Literal { .. }, Half::Left) => loc_x_m < 0.0,
            (Self::Axis { guard_m, .. }, Half::Right) => loc_x_m >= -guard_m,
            (Self::Axis { guard_m, .. }, Half::Left) => loc_x_m <= *guard_m,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    Left,
    Right,
}

/// A row and its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Index into [`LocationTable::rows`].
    pub row: u32,
    /// Eq. 7, pixels.
    pub score: f32,
}

impl Neighbour {
    /// Greater than every row of a table, and the score no row may exceed.
    const NONE: Self = Self {
        row: u32::MAX,
        score: f32::MAX,
    };

    fn comes_before(&self, other: &Self) -> bool {
        self.score < other.score || (self.score == other.score && self.row < other.row)
    }
}

/// A table with its index: one tree for each half of the image.
#[derive(Clone, Debug)]
pub struct TableIndex {
    table: Arc<LocationTable>,
    split: Split,
    left: Tree,
    right: Tree,
}

impl TableIndex {
    /// Indexes a table.
    #[must_use]
    pub fn new(table: Arc<LocationTable>, split: Split) -> Self {
        let half = |half| {
            let rows = (0_u32..).zip(table.rows());
            let kept = rows.filter(|(_, row)| split.keeps(half, row.loc_x_m));
            Tree::new(table.rows(), kept.map(|(at, _)| at).collect())
        };
        Self {
            left: half(Half::Left),
            right: half(Half::Right),
            split,
            table,
        }
    }

    /// The table.
    #[must_use]
    pub fn table(&self) -> &LocationTable {
        &self.table
    }

    /// The row a neighbour stands for.
    ///
    /// # Panics
    /// When the neighbour is another table's.
    #[must_use]
    pub fn row(&self, neighbour: Neighbour) -> &TableRow {
        &self.table.rows()[neighbour.row as usize]
    }

    /// The row of least score in the query's half, the lowest index among equals: exactly what
    /// [`TableIndex::scan`] finds. `None` for an empty half or a query that is not finite.
    #[must_use]
    pub fn nearest(&self, query: &TableQuery) -> Option<Neighbour> {
        self.nearest_rows::<1>(query)[0]
    }

    /// The `K` rows of least (score, index), in that order; `None` where the half has fewer.
    #[must_use]
    pub fn nearest_rows<const K: usize>(&self, query: &TableQuery) -> [Option<Neighbour>; K] {
        let mut found = Nearest([Neighbour::NONE; K]);
        if query.is_answerable() {
            match self.split.half_of(query.center_x_px) {
                Half::Left => self.left.search(query, &mut found),
                Half::Right => self.right.search(query, &mut found),
            }
        }
        found
            .0
            .map(|one| (one.row != Neighbour::NONE.row).then_some(one))
    }

    /// The paper's search: every row of the query's half. The reference for the index.
    #[must_use]
    pub fn scan(&self, query: &TableQuery) -> Option<Neighbour> {
        if !query.is_answerable() {
            return None;
        }
        let half = self.split.half_of(query.center_x_px);
        let mut best = Neighbour::NONE;
        for (at, row) in (0_u32..).zip(self.table.rows()) {
            let score = query.score(row);
            if score < best.score && self.split.keeps(half, row.loc_x_m) {
                best = Neighbour { row: at, score };
            }
        }
        (best.row != Neighbour::NONE.row).then_some(best)
    }
}

/// The best rows so far, best first.
struct Nearest<const K: usize>([Neighbour; K]);

impl<const K: usize> Collect for Nearest<K> {
    fn limit(&self) -> f32 {
        self.0[K - 1].score
    }

    fn offer(&mut self, score: f32, row: u32) {
        let offered = Neighbour { row, score };
        if !offered.comes_before(&self.0[K - 1]) {
            return;
        }
        let mut at = K - 1;
        while at > 0 && offered.comes_before(&self.0[at - 1]) {
            self.0[at] = self.0[at - 1];
            at -= 1;
        }
        self.0[at] = offered;
    }
}
