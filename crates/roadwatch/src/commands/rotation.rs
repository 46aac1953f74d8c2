//! `roadwatch rotation`.

use super::{output::say, progress::Progress};
use crate::{
    cli::{RecipeName, RotationCommand, RotationEvaluateArgs, RotationRowsArgs, RotationTrainArgs},
    config::{Environment, detector::runtime_places},
    failure::Failure,
};
use anyhow::Context as _;
use roadwatch_lab::{RotationReport, RowFilter, RowsFrom};
use roadwatch_onnx::{Runtime, SessionOptions};
use roadwatch_rotate::{
    ComponentNetwork, Forest, ForestOptions, PositionCurve, Recipe, RowTable, estimator::RowReader,
};
use std::{num::NonZero, path::Path, thread::available_parallelism};

/// Rows, forests, and how good they are.
///
/// # Errors
/// Files that cannot be used or written.
pub fn run(command: &RotationCommand) -> Result<(), Failure> {
    match command {
        RotationCommand::Rows(args) => rows(args),
        RotationCommand::Train(args) => train(args),
        RotationCommand::Evaluate(args) => evaluate(args),
    }
}

fn rows(args: &RotationRowsArgs) -> Result<(), Failure> {
    let runtime = Runtime::load(&runtime_places(&Environment::of_process()));
    let runtime = runtime.context("no rows without ONNX Runtime")?;
    let options = SessionOptions {
        threads: available_parallelism().map_or(1, NonZero::get),
        spinning: false,
    };
    let network = ComponentNetwork::open(&runtime, (&args.model, &args.features), options);
    let mut reader = RowReader::new(network.context("the model cannot be used")?);
    let filter = RowFilter {
        min_height_px: args.min_height_px,
        max_occluded: args.max_occluded,
        edge_noise: args.edge_noise,
        seed: args.seed,
        ..RowFilter::default()
    };
    let mut rows = RowsFrom::new(&mut reader, &filter);
    for folder in &args.data {
        eprintln!("looking at {}", folder.display());
        let mut progress = None;
        let added = rows.add(folder, |done, total| {
            let bar = progress.get_or_insert_with(|| Progress::new(total, "images"));
            bar.set(done);
        });
        added.with_context(|| format!("no rows of `{}`", folder.display()))?;
        if let Some(bar) = progress {
            bar.finish();
        }
    }
    let table = rows.finish();
    table.write(&args.out).context("the rows are not kept")?;
    say!("{}: {} rows", args.out.display(), table.rows.len());
    Ok(())
}

fn train(args: &RotationTrainArgs) -> Result<(), Failure> {
    let table = read_rows(&args.rows)?;
    let options = ForestOptions {
        recipe: match args.recipe {
            RecipeName::Paper => Recipe::Paper,
            RecipeName::Roadwatch => Recipe::Roadwatch,
        },
        trees: args.trees.into(),
        leaf_rows: args.leaf_rows.into(),
        seed: args.seed,
        ..ForestOptions::default()
    };
    eprintln!(
        "growing {} trees on {} rows",
        options.trees,
        table.rows.len()
    );
    let mut progress = None;
    let forest = Forest::grow(&table, options, |grown, total| {
        let bar = progress.get_or_insert_with(|| Progress::new(total as u64, "trees"));
        bar.set(grown as u64);
    });
    if let Some(bar) = progress {
        bar.finish();
    }
    let forest = forest.context("no forest")?;
    forest.write(&args.out).context("the forest is not kept")?;
    say!(
        "{}: {} trees, recipe {}",
        args.out.display(),
        forest.trees(),
        forest.recipe()
    );
    Ok(())
}

fn evaluate(args: &RotationEvaluateArgs) -> Result<(), Failure> {
    let table = read_rows(&args.rows)?;
    let mut forests = Vec::with_capacity(args.forests.len());
    for file in &args.forests {
        let forest = read_forest(file, &table)?;
        let name = file
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        forests.push((name.unwrap_or_default(), forest));
    }
    let mut report = RotationReport::new(&table, &forests);
    if let (Some(rows), Some(curve)) = (&args.car_row, &args.curve) {
        let rows = read_rows(rows)?;
        for ((_, forest), file) in forests.iter().zip(&args.forests) {
            check_model(file, forest, &rows)?;
        }
        let curve = PositionCurve::read(curve).map_err(anyhow::Error::from)?;
        report = report.with_car_rows((&rows, &curve), &forests);
    }
    report
        .write(&args.report)
        .context("the report is not kept")?;
    if args.json {
        say!("{:#}", report.to_json());
    } else {
        say!("{}", report.to_markdown());
    }
    eprintln!("written to {}", args.report.display());
    Ok(())
}

/// A forest that was grown on the components of these rows.
///
/// # Errors
/// When it cannot be read, or was grown on rows of another model.
pub(super) fn read_forest(file: &Path, table: &RowTable) -> Result<Forest, Failure> {
    let forest = Forest::read(file).context("nothing was evaluated")?;
    check_model(file, &forest, table)?;
    Ok(forest)
}

fn check_model(file: &Path, forest: &Forest, table: &RowTable) -> Result<(), Failure> {
    if forest.components() == table.components && forest.facing_bins() == table.facing_bins {
        return Ok(());
    }
    let what = format!("`{}` was grown on rows of another model", file.display());
    Err(anyhow::anyhow!(what).into())
}

fn read_rows(file: &Path) -> Result<RowTable, Failure> {
    let read = RowTable::read(file);
    Ok(read.with_context(|| format!("`{}` cannot be used", file.display()))?)
}
