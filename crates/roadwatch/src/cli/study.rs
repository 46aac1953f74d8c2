//! `roadwatch study`.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Whose boxes are located.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StudyBoxes {
    /// The labels': the box of each silhouette, as an ideal detector would see it.
    Truth,
    /// The detector's of a configuration.
    Detector,
}

/// Arguments of `study`.
#[derive(Debug, Args)]
#[command(
    after_help = "Make the datasets with the simulator, then study them:\n  \
    roadwatch-simulate scenario paper_x_path --frames 41 -o x_path\n  \
    roadwatch-simulate scenario long_path -o y_path\n  \
    roadwatch-simulate scenario grid -o grid\n  \
    roadwatch-simulate scenario vehicles -o vehicles\n  \
    roadwatch study x_path y_path grid vehicles --report study\n  \
    roadwatch study x_path y_path --boxes detector --config config/demo.toml\n\n\
    `./dev study` does all of it. docs/studies.md shows what comes out."
)]
pub struct StudyArgs {
    /// Rig datasets of one camera with exact labels. Which study fits is told by what moves how: a car across the
    /// axis, along it, all over a grid, or several vehicles.
    #[arg(required = true, value_name = "DATA")]
    pub data: Vec<PathBuf>,
    /// Folder for study.json, study.md and the plots; made if need be.
    #[arg(
        short = 'o',
        long,
        value_name = "DIR",
        default_value = "study",
        overrides_with = "report"
    )]
    pub report: PathBuf,
    /// Whose boxes are located.
    #[arg(long, value_enum, default_value_t = StudyBoxes::Truth)]
    pub boxes: StudyBoxes,
    /// The configuration whose detector looks at the images (--boxes detector).
    #[arg(long, value_name = "CONFIG", required_if_eq("boxes", "detector"))]
    pub config: Option<PathBuf>,
    /// Print study.json instead of study.md on standard output.
    #[arg(long)]
    pub json: bool,
}
