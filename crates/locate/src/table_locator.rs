//! Location by look-up table: asks the index and says how sure the answer is.

use crate::{
    box_noise::BoxNoise,
    estimate::{Estimate, covariance_of_shifts},
    sizes::ClassSize,
    table::{
        ExpectedDistance, LocationTable, Neighbour, OtherCamera, Split, TableIndex, TableQuery,
        TableRow, Weight,
    },
};
use nalgebra::{Matrix2, Vector2, Vector3};
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
    /// A score over this is no match, pixels.
    pub score_limit_px: f32,
}

impl Default for TableOptions {
    /// 150 pixels: with the default weight, 22 m of depth, more than box noise makes inside the table.
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

    /// The row that looks most like a box; `None` when there is no match (METHOD.md, section 3).
    #[must_use]
    pub fn matching_row(&self, class: &ClassSize, box_px: &BoxPx) -> Option<(TableRow, Neighbour)> {
        let found = self.index.nearest(&self.query(class, box_px)?)?;
        (found.score <= self.options.score_limit_px).then(|| (*self.index.row(found), found))
    }

    /// Places a box where its row says; the centre is half the group's height above the ground.
    ///
    /// The covariance adds up: box noise and the spread of real heights, each by asking again with the
    /// box moved; the disagreement of the rows that match nearly as well; the cells' size.
    #[must_use]
    pub fn locate(&self, class: &ClassSize, box_px: &BoxPx, noise: &BoxNoise) -> Option<Estimate> {
        let query = self.query(class, box_px)?;
        let rows = self.index.nearest_rows::<NEIGHBOURS>(&query);
        let best = rows[0].filter(|best| best.score <= self.options.score_limit_px)?;
        let place = self.place(best);
        let header = self.table().header();
        let cell = Matrix2::identity() * f64::from(header.grid.step_m).powi(2) / 12.0;
        let flat = self.noise(class, box_px, noise) + self.disagreement(&rows) + cell;
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

    fn disagreement(&self, rows: &[Option<Neighbour>]) -> Matrix2<f64> {
        let places = || rows.iter().flatten().map(|&row| self.place(row));
        let count = places().count() as f64;
        let mean = places().sum::<Vector2<f64>>() / count;
        let outer = places().map(|place| (place - mean) * (place - mean).transpose());
        outer.sum::<Matrix2<f64>>() / count
    }

    fn noise(&self, class: &ClassSize, box_px: &BoxPx, noise: &BoxNoise) -> Matrix2<f64> {
        let edge_px = (noise.edge_std_px(box_px) * SLOPE_STD_DEVS) as f32;
        let center_px = (noise.center_std_px(box_px) * SLOPE_STD_DEVS) as f32;
        let taller = class.std_dev.height_m / class.size.height_m * SLOPE_STD_DEVS;
        let moved: [&dyn Fn(f32) -> (BoxPx, f64); 4] = [
            &|sign| (moved_aside(box_px, center_px * sign), 1.0),
            &|sign| (moved_edges(box_px, edge_px * sign, 0.0), 1.0),
            &|sign| (moved_edges(box_px, 0.0, edge_px * sign), 1.0),
            &|sign| (*box_px, 1.0 + taller * f64::from(sign)),
        ];
        let shifts = moved.into_iter().filter_map(|moved| {
            let (down, up) = (moved(-1.0), moved(1.0));
            let shift = self.place_of(class, down)? - self.place_of(class, up)?;
            let per_std_dev = shift / (2.0 * SLOPE_STD_DEVS);
            Some(Vector3::new(per_std_dev.x, per_std_dev.y, 0.0))
        });
        covariance_of_shifts(shifts).fixed_view::<2, 2>(0, 0).into()
    }

    /// Where the table puts a box of an object `taller` times as high as expected.
    fn place_of(&self, class: &ClassSize, (box_px, taller): (BoxPx, f64)) -> Option<Vector2<f64>> {
        let mut query = self.query(class, &box_px)?;
        query.distance_m *= taller as f32;
        Some(self.place(self.index.nearest(&query)?))
    }
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
