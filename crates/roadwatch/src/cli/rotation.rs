//! Arguments of `roadwatch rotation`.

use super::share;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// What to do with headings.
#[derive(Debug, Subcommand)]
pub enum RotationCommand {
    /// Take the rotational data frame out of labelled images: a row of key components per object, as CSV.
    Rows(RotationRowsArgs),
    /// Grow a forest on rows.
    Train(RotationTrainArgs),
    /// Hold forests against rows that they were not grown on: figures by angle, distance, height, and a plot.
    Evaluate(RotationEvaluateArgs),
}

/// Arguments of `rotation rows`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    roadwatch rotation rows pictures --model models/roadwatch_parts.onnx --features \
    models/roadwatch_detector.onnx -o rows.csv\n  \
    roadwatch rotation rows demo drive --model … --features … -o rows.csv --min-height-px 40")]
pub struct RotationRowsArgs {
    /// Labelled images: rig datasets (rig.toml, truth.jsonl), or pictures of the simulator (labels.jsonl).
    #[arg(required = true, value_name = "DIR")]
    pub data: Vec<PathBuf>,
    /// The key-component model.
    #[arg(long, value_name = "FILE")]
    pub model: PathBuf,
    /// The detector whose features it reads.
    #[arg(long, value_name = "FILE")]
    pub features: PathBuf,
    /// The rows' file (CSV).
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Least height of an object's box, pixels.
    #[arg(long, value_name = "PX", default_value_t = 20.0)]
    pub min_height_px: f64,
    /// Greatest hidden share, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, value_parser = share)]
    pub max_occluded: f64,
    /// Standard deviation that is added to each edge of a box, as a share of its height, as a detector's boxes have.
    #[arg(long, value_name = "SHARE", default_value_t = 0.03, value_parser = share)]
    pub edge_noise: f64,
    /// Draws that noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Which features a forest sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RecipeName {
    /// The paper's: columns of tyres, mirrors and plates from left to right.
    Paper,
    /// Every component by its name, scores, the box's shape, the model's direct look.
    Roadwatch,
}

/// Arguments of `rotation train`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  roadwatch rotation train rows.csv -o models/roadwatch_rotation.forest"
)]
pub struct RotationTrainArgs {
    /// Rows (CSV of `rotation rows`).
    pub rows: PathBuf,
    /// The forest's file.
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Which features the forest sees.
    #[arg(long, value_enum, default_value_t = RecipeName::Roadwatch)]
    pub recipe: RecipeName,
    /// Pairs of trees.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub trees: u16,
    /// Fewest rows in a leaf.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub leaf_rows: u16,
    /// Which samples are drawn.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Arguments of `rotation evaluate`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    roadwatch rotation evaluate unseen.csv ours.forest paper.forest --report out\n  \
    roadwatch rotation evaluate turntable.csv ours.forest --car-row row.csv --curve curve.json --report out")]
pub struct RotationEvaluateArgs {
    /// Rows that no forest was grown on (CSV of `rotation rows`).
    pub rows: PathBuf,
    /// Forests, side by side.
    #[arg(required = true, value_name = "FOREST")]
    pub forests: Vec<PathBuf>,
    /// Rows of cars that stand side by side and point the same way (scenario `car_row`), before and after each
    /// calibration; with --curve.
    #[arg(long, value_name = "FILE", requires = "curve")]
    pub car_row: Option<PathBuf>,
    /// The paper's position curve (`calibrate rotation`).
    #[arg(long, value_name = "FILE", requires = "car_row")]
    pub curve: Option<PathBuf>,
    /// Folder for rotation.json, rotation.md, rotation.png and car_rows.png.
    #[arg(long, value_name = "DIR")]
    pub report: PathBuf,
    /// Print the JSON instead of the tables.
    #[arg(long)]
    pub json: bool,
}
