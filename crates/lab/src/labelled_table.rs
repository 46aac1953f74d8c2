//! Look-up tables from labelled frames: a simulator's, or real ones.

use crate::{
    matching::TruthFilter,
    truth::{Truth, TruthObject},
};
use roadwatch_core::{CameraName, ObjectClass, RigCamera, SizeLwh};
use roadwatch_locate::{
    GridSpec, LocationTable, SizeGroup,
    table::{LabelledBox, LabelledOrigin, TableBuildError},
};
use std::fmt;

/// Which labels become rows, and for whom.
#[derive(Clone, Copy, Debug)]
pub struct LabelledTableSpec<'a> {
    /// The camera that the table is for.
    pub camera: &'a RigCamera,
    /// Height of the ground plane in base_link, metres.
    pub ground_z_m: f64,
    /// Objects that become rows; its classes are the table's.
    pub filter: &'a TruthFilter,
    /// As how large the table's objects are published.
    pub size: SizeLwh,
    /// The cells behind `Loc`; what stands off the grid gives no row.
    pub grid: &'a GridSpec,
}

/// What became of a camera's labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LabelCounts {
    /// Labelled objects in the camera's images.
    pub labelled: usize,
    /// Of another class, and therefore left out.
    pub other_class: usize,
    /// Outside the image, or too low in it.
    pub too_small: usize,
    /// Hidden too much by others.
    pub hidden: usize,
    /// Too much outside the image.
    pub truncated: usize,
    /// Off the grid.
    pub off_grid: usize,
    /// Used with the box of their silhouette.
    pub silhouettes: usize,
    /// Used with their cuboid's box, because the labels do not have the silhouette's.
    pub cuboids: usize,
}

impl fmt::Display for LabelCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} labelled, left out {} of another class, {} too small, {} hidden, {} truncated, {} off the grid",
            self.labelled,
            self.other_class,
            self.too_small,
            self.hidden,
            self.truncated,
            self.off_grid
        )
    }
}

/// Why labels give no table.
#[derive(Debug, thiserror::Error)]
pub enum LabelledTableError {
    /// Not one object is left.
    #[error("no labelled object of camera `{camera}` is usable: {counts}")]
    NothingUsable {
        /// The camera.
        camera: CameraName,
        /// What became of them.
        counts: LabelCounts,
    },
    /// The camera, the grid or the size will not do.
    #[error(transparent)]
    Build(#[from] TableBuildError),
}

/// Builds a camera's table from labels: one row per usable object and image, from the box of its silhouette
/// or, where the labels have none, of its cuboid. `source` says in the header where the labels come from.
///
/// # Errors
/// When no object is usable, the camera looks straight up or down, or the grid is impossible.
pub fn table_from_labels(
    spec: &LabelledTableSpec<'_>,
    truth: &Truth,
    source: &str,
) -> Result<(LocationTable, LabelCounts), LabelledTableError> {
    let mut counts = LabelCounts::default();
    let mut boxes = Vec::new();
    for object in truth.of_camera(spec.camera.name.as_str()) {
        counts.labelled += 1;
        boxes.extend(usable(object, spec.filter, &mut counts));
    }
    let nothing_usable = |counts| LabelledTableError::NothingUsable {
        camera: spec.camera.name.clone(),
        counts,
    };
    if boxes.is_empty() {
        return Err(nothing_usable(counts));
    }
    let classes = spec.filter.classes.iter();
    let group = SizeGroup {
        classes: classes.map(|class| ObjectClass::new(class)).collect(),
        size: spec.size,
    };
    let origin = LabelledOrigin {
        camera: spec.camera,
        ground_z_m: spec.ground_z_m,
        group: &group,
        grid: spec.grid,
    };
    counts.off_grid = origin.count_off_grid(&boxes)?;
    if counts.off_grid == boxes.len() {
        return Err(nothing_usable(counts));
    }
    let table = origin.build(&boxes, made(spec, source, &counts))?;
    Ok((table, counts))
}

fn made(spec: &LabelledTableSpec<'_>, source: &str, counts: &LabelCounts) -> String {
    let TruthFilter {
        min_height_px,
        max_occluded,
        max_truncated,
        ..
    } = spec.filter;
    format!(
        "labels of {source}: {} boxes of silhouettes and {} of cuboids, at least {min_height_px} px high, at most \
         {max_occluded} hidden and {max_truncated} truncated, {} m grid; {counts}",
        counts.silhouettes, counts.cuboids, spec.grid.step_m
    )
}

/// The box that a label gives; `None`, and counted with its reason, for what the filter leaves out.
fn usable(
    object: &TruthObject,
    filter: &TruthFilter,
    counts: &mut LabelCounts,
) -> Option<LabelledBox> {
    let seen = object.seen_px().filter(|_| filter.admits(object));
    let Some(box_px) = seen else {
        *reason(object, filter, counts) += 1;
        return None;
    };
    if object.silhouette_px.is_some() {
        counts.silhouettes += 1;
    } else {
        counts.cuboids += 1;
    }
    Some(LabelledBox {
        box_px,
        center: object.center,
    })
}

/// The first reason for which a filter leaves an object out.
fn reason<'a>(
    object: &TruthObject,
    filter: &TruthFilter,
    counts: &'a mut LabelCounts,
) -> &'a mut usize {
    if !filter.classes.contains(&object.class) {
        &mut counts.other_class
    } else if object.occluded > filter.max_occluded {
        &mut counts.hidden
    } else if object.truncated > filter.max_truncated {
        &mut counts.truncated
    } else {
        &mut counts.too_small
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use roadwatch_core::{BoxPx, Mount, space::Point};

    fn camera() -> RigCamera {
        RigCamera {
            base_from_optical: Mount::ahead([1.0, 0.0, 1.8]).base_from_optical(),
            ..made::camera()
        }
    }

    fn car(x: f64, y: f64) -> TruthObject {
        TruthObject {
            id: "a".to_owned(),
            class: "car".to_owned(),
            label: None,
            size: None,
            yaw_rad: None,
            box_px: BoxPx::new(400.0, 250.0, 500.0, 310.0),
            silhouette_px: BoxPx::new(402.0, 256.0, 498.0, 308.0),
            visible_px: None,
            truncated: 0.0,
            occluded: 0.0,
            center: Point::new(x, y, 0.75),
        }
    }

    fn build(
        objects: Vec<TruthObject>,
    ) -> Result<(LocationTable, LabelCounts), LabelledTableError> {
        let truth = Truth::from_iter([((0, "front".to_owned()), objects)]);
        let spec = LabelledTableSpec {
            camera: &camera(),
            ground_z_m: 0.0,
            filter: &TruthFilter::default(),
            size: SizeLwh {
                length_m: 5.1,
                width_m: 1.9,
                height_m: 1.5,
            },
            grid: &GridSpec::default(),
        };
        table_from_labels(&spec, &truth, "a test")
    }

    #[test]
    fn a_row_says_what_was_labelled() {
        let (table, counts) = build(vec![car(21.3, -3.6)]).expect("a table");
        let row = table.rows()[0];
        assert_eq!((counts.labelled, counts.silhouettes), (1, 1));
        assert_eq!(row.area_px2, 96.0 * 52.0);
        assert_eq!((row.center_x_px, row.center_y_px), (449.5, 281.5));
        let near = |found: f32, expected: f32| (found - expected).abs() < 1e-4;
        assert!(near(row.distance_m, 20.3) && near(row.loc_y_m, 20.3) && near(row.loc_x_m, 3.6));
        let grid = table.header().grid;
        assert_eq!((row.loc % grid.columns, row.loc / grid.columns), (64, 19));
        assert!(table.header().made.contains("labels of a test: 1 boxes"));
    }

    #[test]
    fn every_object_left_out_is_counted_with_its_reason() {
        let low = TruthObject {
            box_px: BoxPx::new(0.0, 0.0, 40.0, 19.0),
            ..car(20.0, 0.0)
        };
        let outside = TruthObject {
            box_px: None,
            ..car(20.0, 0.0)
        };
        let bus = TruthObject {
            class: "bus".to_owned(),
            ..car(20.0, 0.0)
        };
        let hidden = TruthObject {
            occluded: 0.4,
            ..car(20.0, 0.0)
        };
        let truncated = TruthObject {
            truncated: 0.1,
            ..car(20.0, 0.0)
        };
        let left_out = vec![low, outside, bus, hidden, truncated, car(200.0, 0.0)];
        let refused = build(left_out.clone()).expect_err("nothing is usable");
        let expected = "no labelled object of camera `front` is usable: 6 labelled, left out 1 of another \
                        class, 2 too small, 1 hidden, 1 truncated, 1 off the grid";
        assert_eq!(refused.to_string(), expected);
        let (table, counts) = build([left_out, vec![car(20.0, 0.0)]].concat()).expect("a table");
        assert_eq!((table.rows().len(), counts.off_grid), (1, 1));
    }

    #[test]
    fn the_order_of_labels_does_not_matter_and_equal_ones_count_once() {
        let cars = [car(20.0, 1.0), car(12.0, 0.0), car(20.0, -1.0)];
        let backwards: Vec<_> = cars.iter().rev().chain(&cars).cloned().collect();
        let (table, _) = build(cars.to_vec()).expect("a table");
        let (again, _) = build(backwards).expect("a table");
        assert_eq!(table.rows(), again.rows());
        assert_eq!(table.rows().len(), 3);
    }
}
