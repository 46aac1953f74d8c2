//! Tables from labelled images: the boxes of objects whose places are known.

use super::{
    CalibrationHash, GridSpec, LocationTable, SizeGroup, TableBuildError, TableHeader, TableRow,
    distance_fit::DistanceFit, expected::terms, row_of,
};
use roadwatch_core::{
    BoxPx, ImageSize, RigCamera,
    space::{BaseLink, CameraGround, Point, Transform},
};

/// An object in an image, and where it really was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledBox {
    /// As a detector would see it: of the silhouette where that is known, clipped to the image, pixels.
    pub box_px: BoxPx,
    /// Centre of the object.
    pub center: Point<BaseLink>,
}

/// What the boxes of a labelled table are of.
#[derive(Clone, Copy, Debug)]
pub struct LabelledOrigin<'a> {
    /// The camera that saw them.
    pub camera: &'a RigCamera,
    /// Height of the ground plane in base_link, metres.
    pub ground_z_m: f64,
    /// Whom the table locates, and as how large they are published.
    pub group: &'a SizeGroup,
    /// The cells behind `Loc`; what stands off the grid gives no row. Headings and visible share are not used.
    pub grid: &'a GridSpec,
}

impl LabelledOrigin<'_> {
    /// How many of the boxes stand off the grid.
    ///
    /// # Errors
    /// As of [`LabelledOrigin::build`].
    pub fn count_off_grid(&self, boxes: &[LabelledBox]) -> Result<usize, TableBuildError> {
        Ok(boxes.len() - self.rows(boxes)?.len())
    }

    /// One row per box, in order of (`Loc`, `Distance`, `Center_x`, `Center_y`, …); equal rows once.
    ///
    /// Columns mean what they mean in [`super::build_table`], but LocX and LocY are where the object was, not
    /// the middle of its cell. The expected distance is fitted to the boxes that touch no edge of the image;
    /// where they leave it open, it is eq. 2's. `made` goes into the header.
    ///
    /// # Errors
    /// When the optical axis is within 20 degrees of vertical, the grid is impossible, or no box stands on it.
    pub fn build(
        &self,
        boxes: &[LabelledBox],
        made: String,
    ) -> Result<LocationTable, TableBuildError> {
        let mut rows = self.rows(boxes)?;
        rows.sort_by(|(a, _), (b, _)| {
            a.loc
                .cmp(&b.loc)
                .then_with(|| total_order(&sorted_columns(a), &sorted_columns(b)))
        });
        rows.dedup_by(|(a, _), (b, _)| a == b);
        let header = TableHeader {
            camera: self.camera.name.clone(),
            image_size: self.camera.model.size,
            calibration: CalibrationHash::of(self.camera, self.ground_z_m),
            expected: self.fit(&rows).solve_near_literal(self.group.size.height_m),
            made,
            grid: self.grid.grid(),
            group: self.group.clone(),
        };
        let rows = rows.into_iter().map(|(row, _)| row).collect();
        Ok(LocationTable::new(header, rows)?)
    }

    fn rows(&self, boxes: &[LabelledBox]) -> Result<Vec<(TableRow, BoxPx)>, TableBuildError> {
        self.grid.check()?;
        let base_from_ground = self.camera.base_from_ground(self.ground_z_m)?;
        let rows = boxes
            .iter()
            .filter_map(|label| Some((self.row(label, base_from_ground)?, label.box_px)));
        Ok(rows.collect())
    }

    /// `None` off the grid, and behind the camera.
    fn row(
        &self,
        label: &LabelledBox,
        base_from_ground: Transform<BaseLink, CameraGround>,
    ) -> Option<TableRow> {
        let place = base_from_ground.inverse() * label.center;
        let (loc_x_m, loc_y_m) = (-place.y(), place.x());
        let cell = self.grid.cell(loc_x_m, loc_y_m)?;
        let depth_m = self.camera.depth_m(label.center);
        (depth_m > 0.0).then(|| row_of(&label.box_px, depth_m, (loc_x_m, loc_y_m), cell))
    }

    fn fit(&self, rows: &[(TableRow, BoxPx)]) -> DistanceFit {
        let model = &self.camera.model;
        let mut fit = DistanceFit::default();
        let whole = rows
            .iter()
            .filter(|(_, box_px)| is_whole(box_px, model.size));
        for (row, box_px) in whole {
            if let Some(terms) = terms(model, box_px) {
                fit.add(terms, f64::from(row.distance_m));
            }
        }
        fit
    }
}

/// A box that touches an edge of the image may go on beyond it.
fn is_whole(box_px: &BoxPx, size: ImageSize) -> bool {
    box_px.x_min > 0.0
        && box_px.y_min > 0.0
        && box_px.x_max < size.width_px as f32
        && box_px.y_max < size.height_px as f32
}

fn sorted_columns(row: &TableRow) -> [f32; 6] {
    [
        row.distance_m,
        row.center_x_px,
        row.center_y_px,
        row.area_px2,
        row.loc_x_m,
        row.loc_y_m,
    ]
}

fn total_order(a: &[f32], b: &[f32]) -> std::cmp::Ordering {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| a.total_cmp(b))
        .find(|order| order.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}
