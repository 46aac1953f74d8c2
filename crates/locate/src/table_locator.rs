//! Location by look-up table: asks the index and says how sure the answer is.

use crate::{
    box_noise::BoxNoise,
    estimate::Estimate,
    sizes::ClassSize,
    table::{
        ExpectedDistance, LocationTable, Neighbour, OtherCamera, OtherSize, Split, TableIndex,
        TableQuery, Weight,
    },
};
use nalgebra::{Matrix2, Vector2};
use roadwatch_core::{
    BoxPx, RigCamera,
    rig::LooksVertical,
    space::{BaseLink, CameraGround, Covariance, Point, Transform},
};
use std::sync::Arc;

/// Rows whose disagreement tells how ambiguous an answer is: two cells' worth of headings.
const NEIGHBOURS: usize = 16;
/// Edges are moved by this many standard deviations for the slope: rows are a grid step apart, and a
/// small move would often find the same row.
const SLOPE_STD_DEVS: f64 = 2.0;
/// A moved box keeps at least this height, pixels.
const MIN_HEIGHT_PX: f32 = 0.5;
/// How high the ground under an object may lie, standard deviation, metres: a road's camber.
const GROUND_STD_M: f64 = 0.05;

/// Nearer than this no depth is told apart, metres.
const NEAREST_M: f32 = 1.0;

/// Which rows a query looks at, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SplitMode {
    /// [`Split::Axis`] at the camera's principal point.
    #[default]
    Axis,
    /// [`Split::Literal`], as the paper prints it.
    Literal,
}

/// Where the expected distance `d_` of a query comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum QueryDistance {
    /// The numbers fitted to the table's silhouettes, see [`ExpectedDistance`].
    #[default]
    Fitted,
    /// Plain eq. 2 with the class's height, as the paper has it.
    Literal,
}

/// How a table is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableOptions {
    /// Which half of the table.
    pub split: SplitMode,
    /// What a metre is worth in the score.
    pub weight: Weight,
    /// Where `d_` comes from.
    pub distance: QueryDistance,
    /// A score over this is no match, pixels of an image
    /// [`crate::table::DEFAULT_WEIGHT_WIDTH_PX`] wide; see [`Weight::limit_scale`] for other
    /// widths and for [`Weight::BoxWidth`].
    pub score_limit_px: f32,
}

impl Default for TableOptions {
    /// 150 pixels: with the default weight and with box width, 22 m of depth, more than box noise makes
    /// inside the table.
    fn default() -> Self {
        Self {
            split: SplitMode::default(),
            weight: Weight::default(),
            distance: QueryDistance::default(),
            score_limit_px: 150.0,
        }
    }
}

/// A table that does not go with a camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableMismatch {
    /// Another camera's, or an older calibration's.
    #[error(transparent)]
    OtherCamera(#[from] OtherCamera),
    /// The camera looks straight up or down.
    #[error(transparent)]
    LooksVertical(#[from] LooksVertical),
    /// Of objects of another size than is configured.
    #[error(transparent)]
    OtherSize(#[from] OtherSize),
}

/// One camera's table, indexed, with what places its answers in base_link.
#[derive(Clone, Debug)]
pub struct TableLocator {
    camera: RigCamera,
    base_from_ground: Transform<BaseLink, CameraGround>,
    index: TableIndex,
    options: TableOptions,
}

impl TableLocator {
    /// Indexes a table for a camera.
    ///
    /// # Errors
    /// When the table is another camera's.
    pub fn new(
        camera: &RigCamera,
        ground_z_m: f64,
        table: Arc<LocationTable>,
        options: TableOptions,
    ) -> Result<Self, TableMismatch> {
        table.check_camera(camera, ground_z_m)?;
        let split = match options.split {
            SplitMode::Axis => Split::axis(camera),
            SplitMode::Literal => Split::literal(camera),
        };
        Ok(Self {
            base_from_ground: camera.base_from_ground(ground_z_m)?,
            camera: camera.clone(),
            index: TableIndex::new(table, split),
            options,
        })
    }

    /// The table.
    #[must_use]
    pub fn table(&self) -> &LocationTable {
        self.index.table()
    }

    /// The question that a box of a class asks; `None` where the lens model has no ray through it.
    #[must_use]
    pub fn query(&self, class: &ClassSize, box_px: &BoxPx) -> Option<TableQuery> {
        let model = &self.camera.model;
        let center = box_px.center();
        let expected = match self.options.distance {
            QueryDistance::Fitted => self.table().header().expected,
            QueryDistance::Literal => ExpectedDistance::literal(class.size.height_m),
        };
        let distance_m = expected.depth_m(model, box_px)?;
        Some(TableQuery {
            center_x_px: center.x as f32,
            center_y_px: center.y as f32,
            distance_m: distance_m as f32,
            px_per_metre: self.options.weight.px_per_metre(box_px, model.size),
        })
    }

    /// Places a box where its row says; the centre is half the group's height above the ground. `None`
    /// when there is no match (docs/method.md, section 3).
    ///
    /// The covariance adds up: box noise and the spread of real heights, each by asking again with the
    /// box moved; how far the rows that match nearly as well are from the published one; what the row
    /// leaves unexplained of the expected distance, which is large past the table's edge; the cells' size.
    #[must_use]
    pub fn locate(&self, class: &ClassSize, box_px: &BoxPx, noise: &BoxNoise) -> Option<Estimate> {
        let query = self.query(class, box_px)?;
        let rows = self.index.nearest_rows::<NEIGHBOURS>(&query);
        let best = rows[0].filter(|best| best.score <= self.score_limit_px(box_px))?;
        let place = self.place(best);
        let unexplained = self.unexplained(best, &query);
        let header = self.table().header();
        let cell = Matrix2::identity() * f64::from(header.grid.step_m).powi(2) / 12.0;
        let flat = self.noise(class, (box_px, noise), place + unexplained)?
            + self.disagreement(&rows, place)
            + outer(unexplained)
            + cell;
        let up_m = header.group.size.height_m / 2.0;
        let up_std_m = GROUND_STD_M.hypot(class.std_dev.height_m / 2.0);
        let mut covariance = flat.to_homogeneous();
        covariance[(2, 2)] = up_std_m.powi(2);
        let in_ground = Point::<CameraGround>::new(place.x, place.y, up_m);
        Some(Estimate {
            position: self.base_from_ground * in_ground,
            covariance: self.base_from_ground * Covariance::<CameraGround>::new(covariance),
        })
    }

    /// Where a row stands, in camera-ground space.
    fn place(&self, neighbour: Neighbour) -> Vector2<f64> {
        let row = self.index.row(neighbour);
        Vector2::new(f64::from(row.loc_y_m), f64::from(-row.loc_x_m))
    }

    fn score_limit_px(&self, box_px: &BoxPx) -> f32 {
        let scale = self
            .options
            .weight
            .limit_scale(box_px, self.camera.model.size);
        self.options.score_limit_px * scale
    }

    /// From a row's place along the ray to where the query's distance would be.
    fn unexplained(&self, best: Neighbour, query: &TableQuery) -> Vector2<f64> {
        let row_m = self.index.row(best).distance_m;
        self.place(best) * f64::from((query.distance_m - row_m) / row_m.max(NEAREST_M))
    }

    /// Of rows about the published place, which is not their mean.
    fn disagreement(&self, rows: &[Option<Neighbour>], published: Vector2<f64>) -> Matrix2<f64> {
        let places = rows.iter().flatten().map(|&row| self.place(row));
        let count = places.clone().count() as f64;
        places
            .map(|place| outer(place - published))
            .sum::<Matrix2<f64>>()
            / count
    }

    /// Of the box and of the object's real height, about `at`. Each cause counts by its greater side: on
    /// the side where the table ends, moved boxes have no row or the edge's. `None` where the lens model has
    /// no ray on either side.
    fn noise(
        &self,
        class: &ClassSize,
        (box_px, noise): (&BoxPx, &BoxNoise),
        at: Vector2<f64>,
    ) -> Option<Matrix2<f64>> {
        let edge_px = (noise.edge_std_px(box_px) * SLOPE_STD_DEVS) as f32;
        let center_px = (noise.center_std_px(box_px) * SLOPE_STD_DEVS) as f32;
        let taller = class.std_dev.height_m / class.size.height_m * SLOPE_STD_DEVS;
        let moved: [&dyn Fn(f32) -> (BoxPx, f64); 4] = [
            &|sign| (moved_aside(box_px, center_px * sign), 1.0),
            &|sign| (moved_edges(box_px, edge_px * sign, 0.0), 1.0),
            &|sign| (moved_edges(box_px, 0.0, edge_px * sign), 1.0),
            &|sign| (*box_px, 1.0 + taller * f64::from(sign)),
        ];
        let of_cause = |moved: &dyn Fn(f32) -> (BoxPx, f64)| {
            let sides = [-1.0, 1.0].map(|sign| self.place_of(class, moved(sign)));
            let shifts = sides.into_iter().flatten().map(|place| place - at);
            let greater = shifts.max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
            Some(outer(greater / SLOPE_STD_DEVS))
        };
        moved.into_iter().map(of_cause).sum()
    }

    /// Where the table puts a box of an object `taller` times as high as expected.
    fn place_of(&self, class: &ClassSize, (box_px, taller): (BoxPx, f64)) -> Option<Vector2<f64>> {
        let mut query = self.query(class, &box_px)?;
        query.distance_m *= taller as f32;
        Some(self.place(self.index.nearest(&query)?))
    }
}

fn outer(shift: Vector2<f64>) -> Matrix2<f64> {
    shift * shift.transpose()
}

fn moved_aside(box_px: &BoxPx, by_px: f32) -> BoxPx {
    BoxPx {
        x_min: box_px.x_min + by_px,
        x_max: box_px.x_max + by_px,
        ..*box_px
    }
}

fn moved_edges(box_px: &BoxPx, top_px: f32, bottom_px: f32) -> BoxPx {
    let y_min = box_px.y_min + top_px;
    BoxPx {
        y_min,
        y_max: (box_px.y_max + bottom_px).max(y_min + MIN_HEIGHT_PX),
        ..*box_px
    }
}
