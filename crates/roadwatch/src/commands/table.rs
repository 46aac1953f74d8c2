//! `roadwatch table`.

use super::{output::say, progress::Progress};
use crate::{
    cli::{TableBuildArgs, TableInspectArgs, TableQueryArgs},
    failure::Failure,
};
use anyhow::{Context as _, anyhow};
use roadwatch_camera::read_rig_file;
use roadwatch_core::{BoxPx, ObjectClass, RigCamera, SizeLwh};
use roadwatch_lab::{LabelledTableSpec, Truth, TruthFilter, table_from_labels};
use roadwatch_locate::{
    ClassSizes, GridSpec, HullSpec, LocationTable, SizeGroup, TableIndex, TableQuery, Weight,
    build_table,
    table::{CsvOrigin, Split},
};
use std::{path::Path, sync::Arc};

/// The builder tells a share, not a count.
const PROGRESS_STEPS: u64 = 1000;

/// A rig dataset has its rig in this file.
const RIG_FILE: &str = "rig.toml";

/// Builds a table from a camera's calibration, from labelled images, or from a CSV.
///
/// # Errors
/// When the rig, the camera, the class, the labels or the grid will not do, or the file cannot be written.
pub fn build(args: &TableBuildArgs) -> Result<(), Failure> {
    let dataset = args.from_dataset.as_deref();
    let rig = dataset.map(|folder| folder.join(RIG_FILE));
    let rig = rig.as_ref().or(args.rig.as_ref());
    let camera = find_camera(
        rig.context("--rig or --from-dataset is missing")?,
        &args.camera,
    )?;
    let class = ObjectClass::new(&args.class);
    let sizes = ClassSizes::default();
    let known = sizes
        .get(&class)
        .with_context(|| format!("no size is known for class `{class}`"))?
        .size;
    let size = SizeLwh {
        length_m: args.length_m.unwrap_or(known.length_m),
        width_m: args.width_m.unwrap_or(known.width_m),
        height_m: args.height_m.unwrap_or(known.height_m),
    };
    let group = SizeGroup {
        classes: vec![class.clone()],
        size,
    };
    let table = match (dataset, &args.import) {
        (Some(folder), _) => label(args, &camera, group, folder)?,
        (None, Some(csv)) => {
            let origin = CsvOrigin {
                camera: &camera,
                ground_z_m: args.ground_z_m,
                group: &group,
            };
            LocationTable::read_csv(csv, origin).with_context(|| csv.display().to_string())?
        }
        (None, None) => project(args, &camera, group, &HullSpec::for_class(&class))?,
    };
    table.write(&args.out).map_err(anyhow::Error::from)?;
    say!(
        "{}: {} rows for camera {}",
        args.out.display(),
        table.rows().len(),
        camera.name
    );
    Ok(())
}

fn find_camera(rig: &Path, name: &str) -> Result<RigCamera, anyhow::Error> {
    let cameras = read_rig_file(rig)?;
    let known: Vec<_> = cameras
        .iter()
        .map(|camera| camera.name.to_string())
        .collect();
    let found = cameras
        .into_iter()
        .find(|camera| camera.name.as_str() == name);
    found.ok_or_else(|| {
        anyhow!(
            "{}: no camera `{name}`; the rig has {}",
            rig.display(),
            known.join(", ")
        )
    })
}

fn project(
    args: &TableBuildArgs,
    camera: &RigCamera,
    group: SizeGroup,
    hull: &HullSpec,
) -> Result<LocationTable, anyhow::Error> {
    let grid = grid(args);
    let mut progress = Progress::new(PROGRESS_STEPS, "per mille");
    let table = build_table(camera, args.ground_z_m, &grid, (group, hull), |share| {
        progress.set((f64::from(share) * PROGRESS_STEPS as f64) as u64);
    })?;
    progress.finish();
    Ok(table)
}

/// Makes a table of a dataset's labels, and says how many it used.
fn label(
    args: &TableBuildArgs,
    camera: &RigCamera,
    group: SizeGroup,
    folder: &Path,
) -> Result<LocationTable, anyhow::Error> {
    let truth = Truth::read(folder)?;
    let filter = TruthFilter {
        min_height_px: args.labels.min_height_px,
        max_occluded: args.labels.max_occluded,
        max_truncated: args.labels.max_truncated,
        classes: group.classes.iter().map(ToString::to_string).collect(),
    };
    let spec = LabelledTableSpec {
        camera,
        ground_z_m: args.ground_z_m,
        filter: &filter,
        size: group.size,
        grid: &grid(args),
    };
    let source = folder.display().to_string();
    let (table, counts) =
        table_from_labels(&spec, &truth, &source).with_context(|| source.clone())?;
    eprintln!("{source}: {counts}");
    if counts.silhouettes == 0 {
        eprintln!(
            "the labels have no `silhouette_px`: rows are of cuboids, which are higher than what detectors see, and will place objects too far"
        );
    }
    Ok(table)
}

fn grid(args: &TableBuildArgs) -> GridSpec {
    let defaults = GridSpec::default();
    GridSpec {
        step_m: args.step_m.unwrap_or(defaults.step_m),
        farthest_m: args.farthest_m.unwrap_or(defaults.farthest_m),
        lateral_m: args.lateral_m.unwrap_or(defaults.lateral_m),
        headings: args.headings.unwrap_or(defaults.headings),
        ..defaults
    }
}

/// Prints what a table is of.
///
/// # Errors
/// When the table cannot be read, or the CSV not written.
pub fn inspect(args: &TableInspectArgs) -> Result<(), Failure> {
    let table = LocationTable::read(&args.table).map_err(anyhow::Error::from)?;
    let header = table.header();
    let classes: Vec<_> = header
        .group
        .classes
        .iter()
        .map(ObjectClass::as_str)
        .collect();
    let size = header.group.size;
    say!("table     {}", args.table.display());
    say!("camera    {}, {}", header.camera, header.image_size);
    say!("made      {}", header.made);
    say!(
        "objects   {}, {} x {} x {} m",
        classes.join(", "),
        size.length_m,
        size.width_m,
        size.height_m
    );
    say!("rows      {}", table.rows().len());
    say!("grid      {} m", header.grid.step_m);
    let rows = table.rows();
    print_range("LocX", rows.iter().map(|row| row.loc_x_m))?;
    print_range("LocY", rows.iter().map(|row| row.loc_y_m))?;
    print_range("Distance", rows.iter().map(|row| row.distance_m))?;
    if let Some(csv) = &args.export {
        table
            .write_csv(csv)
            .with_context(|| csv.display().to_string())?;
        say!("exported  {}", csv.display());
    }
    Ok(())
}

fn print_range(name: &str, metres: impl Iterator<Item = f32>) -> Result<(), Failure> {
    let range = metres.fold(
        (f32::INFINITY, f32::NEG_INFINITY),
        |(least, most), value| (least.min(value), most.max(value)),
    );
    say!("{name:<10}{:.1} to {:.1} m", range.0, range.1);
    Ok(())
}

/// Prints the row that a box matches best. Halves are split at the middle of the image, as the paper has it.
///
/// # Errors
/// When the table cannot be read, or nothing matches.
pub fn query(args: &TableQueryArgs) -> Result<(), Failure> {
    let &[x_min, y_min, x_max, y_max] = args.box_px.as_slice() else {
        return Err(anyhow!("--box: expected four numbers of pixels, like 470,260,560,330").into());
    };
    let box_px = BoxPx::new(x_min, y_min, x_max, y_max)
        .context("--box: expected corners with an area between them")?;
    let table = LocationTable::read(&args.table).map_err(anyhow::Error::from)?;
    let image = table.header().image_size;
    let center = box_px.center();
    let query = TableQuery {
        center_x_px: center.x as f32,
        center_y_px: center.y as f32,
        distance_m: args.distance_m,
        px_per_metre: args
            .weight
            .unwrap_or_else(|| Weight::default().px_per_metre(&box_px, image)),
    };
    let split = Split::Literal {
        image_width_px: image.width_px as f32,
    };
    let index = TableIndex::new(Arc::new(table), split);
    let found = index
        .nearest(&query)
        .context("no row of that half matches")?;
    let row = index.row(found);
    say!("LocX      {:.2} m", row.loc_x_m);
    say!("LocY      {:.2} m", row.loc_y_m);
    say!("Distance  {:.2} m", row.distance_m);
    say!("score     {:.2} px (row {})", found.score, found.row);
    Ok(())
}
