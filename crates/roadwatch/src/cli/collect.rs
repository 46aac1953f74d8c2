//! Arguments of `roadwatch collect`.

use super::RunArgs;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `collect`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    roadwatch collect config/demo.toml --pace lossless -o field --every 10\n  \
    roadwatch collect vehicle.toml -o field --on-object --on-disagreement 0.2 --budget-mb 20000\n\n\
    The folder is a rig dataset (docs/evaluation.md) with what was said of it in estimates.jsonl. When truth arrives,\n\
    put it in as truth.jsonl; `evaluate`, `table build` and `rotation rows` then take the folder.")]
pub struct CollectArgs {
    /// As for `run`.
    #[command(flatten)]
    pub run: RunArgs,
    /// The folder to write the dataset to; it must be empty or not exist.
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Keep every N-th round of the rig. Without this and the next two, every round is kept.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub every: Option<u64>,
    /// Keep rounds with an object that none before had.
    #[arg(long)]
    pub on_object: bool,
    /// Keep rounds in which two methods put an object at distances that differ by more than this share.
    #[arg(long, value_name = "SHARE", value_parser = super::share)]
    pub on_disagreement: Option<f64>,
    /// End when so many megabytes are written.
    #[arg(long, value_name = "MB", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub budget_mb: u64,
}
