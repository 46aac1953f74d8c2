//! Tables from a camera's calibration, without images: silhouettes over a ground grid and headings.

use super::{
    CalibrationHash, Grid, InvalidTable, LocationTable, SizeGroup, TableHeader, TableRow,
    distance_fit::DistanceFit, expected::terms, row_of,
};
use crate::hull::{GroundPose, HullSpec, SilhouetteCamera};
use nalgebra::Vector3;
use roadwatch_core::{BoxPx, RigCamera, rig::LooksVertical, space::Point};
use std::f64::consts::PI;

/// The ground a table covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSpec {
    /// Between neighbouring cells, metres.
    pub step_m: f64,
    /// Least LocY, metres.
    pub nearest_m: f64,
    /// Greatest LocY, metres.
    pub farthest_m: f64,
    /// Greatest LocX to either side, metres.
    pub lateral_m: f64,
    /// Headings per cell, evenly over half a turn (front and back look alike).
    pub headings: u32,
    /// Only silhouettes with at least this share of their box inside the image become rows.
    pub visible_share: f32,
}

impl Default for GridSpec {
    /// One metre over what a passenger car's camera can tell apart: at 80 m a car is about 18 px high in
    /// a 960x540 image of a 50-degree lens, and a pixel is worth 4 m of depth.
    ///
    /// Eight headings, 22.5 degrees apart: from one to the next a car's outline moves along the ray by at
    /// most 0.6 m, so that any heading is within a third of the step of a row's. Sixteen gain nothing.
    fn default() -> Self {
        Self {
            step_m: 1.0,
            nearest_m: 1.0,
            farthest_m: 80.0,
            lateral_m: 60.0,
            headings: 8,
            visible_share: 0.9,
        }
    }
}

/// A grid that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("grid: {0}")]
pub struct InvalidGrid(&'static str);

/// Why there is no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableBuildError {
    /// The camera looks straight up or down.
    #[error(transparent)]
    LooksVertical(#[from] LooksVertical),
    /// The grid cannot be.
    #[error(transparent)]
    Grid(#[from] InvalidGrid),
    /// Nothing on the grid is in view, or the size is not a size.
    #[error("no table came out: {0}")]
    Table(#[from] InvalidTable),
}

impl GridSpec {
    /// Most rows a table may have; a hundred times what the default has, 280 MB.
    const MAX_ROWS: f64 = 1e7;

    pub(super) fn check(&self) -> Result<(), InvalidGrid> {
        let numbers = [self.step_m, self.nearest_m, self.farthest_m, self.lateral_m];
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(InvalidGrid(
                "every length must be a finite number of metres",
            ));
        }
        if self.step_m <= 0.0 {
            return Err(InvalidGrid("the step must be greater than zero"));
        }
        if self.farthest_m < self.nearest_m || self.lateral_m < 0.0 {
            return Err(InvalidGrid(
                "the farthest cell must not be nearer than the nearest",
            ));
        }
        if !(1..=360).contains(&self.headings) {
            return Err(InvalidGrid("1 to 360 headings are possible"));
        }
        let along = (self.farthest_m - self.nearest_m) / self.step_m + 1.0;
        let across = self.lateral_m * 2.0 / self.step_m + 1.0;
        if along * across * f64::from(self.headings) > Self::MAX_ROWS {
            return Err(InvalidGrid(
                "more than ten million rows: use a greater step",
            ));
        }
        Ok(())
    }

    fn side_columns(&self) -> u32 {
        (self.lateral_m / self.step_m).floor() as u32
    }

    fn rows(&self) -> u32 {
        ((self.farthest_m - self.nearest_m) / self.step_m).floor() as u32 + 1
    }

    /// The cell nearest to a place, as a row's `Loc`; `None` off the grid.
    pub(super) fn cell(&self, loc_x_m: f64, loc_y_m: f64) -> Option<u32> {
        let column = (loc_x_m / self.step_m).round() + f64::from(self.side_columns());
        let along = ((loc_y_m - self.nearest_m) / self.step_m).round();
        let columns = 2 * self.side_columns() + 1;
        let inside = (0.0..f64::from(columns)).contains(&column)
            && (0.0..f64::from(self.rows())).contains(&along);
        inside.then(|| along as u32 * columns + column as u32)
    }

    /// Column `side_columns` has LocX = 0, so that a mirrored camera has the mirrored table.
    pub(super) fn grid(&self) -> Grid {
        Grid {
            origin_loc_x_m: (-f64::from(self.side_columns()) * self.step_m) as f32,
            origin_loc_y_m: self.nearest_m as f32,
            step_m: self.step_m as f32,
            columns: 2 * self.side_columns() + 1,
        }
    }
}

/// Builds a camera's table for one size group.
///
/// Every cell of the grid gets one row for each heading at which enough of the silhouette is inside the
/// image; its box is clipped to the image, as a detector's is. `progress` is told the share of the
/// work done, in `0.0..=1.0`.
///
/// # Errors
/// When the optical axis is within 20 degrees of vertical, the grid is impossible, or nothing is in view.
pub fn build_table(
    camera: &RigCamera,
    ground_z_m: f64,
    spec: &GridSpec,
    (group, hull): (SizeGroup, &HullSpec),
    mut progress: impl FnMut(f32),
) -> Result<LocationTable, TableBuildError> {
    spec.check()?;
    let base_from_ground = camera.base_from_ground(ground_z_m)?;
    let caster = Caster {
        camera: SilhouetteCamera::new(
            camera.model,
            camera.base_from_optical.inverse() * base_from_ground,
        ),
        hull_points: hull.points(group.size),
        center_z_m: group.size.height_m / 2.0,
        spec,
    };
    let mut rows = Vec::new();
    let mut fit = DistanceFit::default();
    for along in 0..spec.rows() {
        caster.cast_row(along, &mut rows, |box_px, depth_m| {
            if let Some(terms) = terms(&camera.model, box_px) {
                fit.add(terms, depth_m);
            }
        });
        progress((along + 1) as f32 / spec.rows() as f32);
    }
    let header = TableHeader {
        camera: camera.name.clone(),
        image_size: camera.model.size,
        calibration: CalibrationHash::of(camera, ground_z_m),
        expected: fit.solve(group.size.height_m),
        made: format!(
            "silhouettes from calibration, {} m grid to {} m, {} headings, at least {} of the box in view",
            spec.step_m, spec.farthest_m, spec.headings, spec.visible_share
        ),
        grid: spec.grid(),
        group,
    };
    Ok(LocationTable::new(header, rows)?)
}

/// Casts silhouettes of one hull into one camera.
struct Caster<'a> {
    camera: SilhouetteCamera,
    hull_points: Vec<Vector3<f64>>,
    center_z_m: f64,
    spec: &'a GridSpec,
}

impl Caster<'_> {
    fn cast_row(&self, along: u32, rows: &mut Vec<TableRow>, mut seen: impl FnMut(&BoxPx, f64)) {
        let side = self.spec.side_columns();
        let loc_y_m = self.spec.nearest_m + f64::from(along) * self.spec.step_m;
        for column in 0..=2 * side {
            let loc_x_m = (f64::from(column) - f64::from(side)) * self.spec.step_m;
            let depth_m = self
                .camera
                .depth_m(Point::new(loc_y_m, -loc_x_m, self.center_z_m));
            if depth_m <= 0.0 {
                continue;
            }
            for heading in 0..self.spec.headings {
                let pose = GroundPose {
                    loc_x_m,
                    loc_y_m,
                    heading_rad: PI * f64::from(heading) / f64::from(self.spec.headings),
                };
                let Some((box_px, whole)) = self.cast(pose) else {
                    continue;
                };
                if whole {
                    seen(&box_px, depth_m);
                }
                let cell = along * (2 * side + 1) + column;
                rows.push(row_of(&box_px, depth_m, (loc_x_m, loc_y_m), cell));
            }
        }
    }

    fn cast(&self, pose: GroundPose) -> Option<(BoxPx, bool)> {
        let whole = self.camera.silhouette_px(&self.hull_points, pose)?;
        let (clipped, share) = self.camera.clip(whole)?;
        (share >= self.spec.visible_share).then_some((clipped, clipped == whole))
    }
}
