//! `roadwatch evaluate`.

use super::share;
use clap::{Args, ValueEnum};
use roadwatch_lab::DatasetFormat;
use std::path::PathBuf;

/// How a dataset is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormatName {
    /// rig.toml, frames.jsonl, truth.jsonl, and images or a clip per camera.
    Rig,
    /// KITTI's object layout: image_2, calib, label_2.
    Kitti,
}

impl From<FormatName> for DatasetFormat {
    fn from(name: FormatName) -> Self {
        match name {
            FormatName::Rig => Self::Rig,
            FormatName::Kitti => Self::Kitti,
        }
    }
}

/// Arguments of `evaluate`. The defaults of the filter are clean cars: well visible and not small.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    roadwatch evaluate --config config/pandaset.toml --report evaluation\n  \
    roadwatch evaluate --config config/pandaset.toml --dataset DRIVE --report evaluation --class car,truck\n  \
    roadwatch evaluate --config config/kitti.toml --format kitti --dataset kitti/training --min-height-px 25\n\n\
    docs/evaluation.md explains every figure.")]
pub struct EvaluateArgs {
    /// The configuration file (TOML).
    #[arg(long, value_name = "CONFIG")]
    pub config: PathBuf,
    /// Take images, rig and truth from this dataset, everything else from the configuration.
    #[arg(long, value_name = "DIR")]
    pub dataset: Option<PathBuf>,
    /// How that dataset is laid out; otherwise as the configuration says (rig.format).
    #[arg(long, value_enum, value_name = "FORMAT", requires = "dataset")]
    pub format: Option<FormatName>,
    /// Folder for report.json, report.md and the plots; made if need be.
    #[arg(
        short = 'o',
        long,
        alias = "out",
        value_name = "DIR",
        default_value = "evaluation"
    )]
    pub report: PathBuf,
    /// Score only objects at least this high, pixels. 20 is meant for images 960x540; take 40 at 1920x1080.
    #[arg(long, value_name = "PX", default_value_t = 20.0, value_parser = height_px)]
    pub min_height_px: f64,
    /// Score only objects hidden at most this much, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.3, value_parser = share)]
    pub max_occluded: f64,
    /// Score only objects at most this much outside the image, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share)]
    pub max_truncated: f64,
    /// Score only objects of these classes; repeat or separate by commas. What is detected as a car may be a
    /// labelled truck and the other way round.
    #[arg(
        long,
        value_name = "CLASS",
        value_delimiter = ',',
        default_value = "car"
    )]
    pub class: Vec<String>,
    /// Use only the first frames of each camera.
    #[arg(long, value_name = "N")]
    pub frames: Option<u64>,
    /// Print report.json instead of report.md on standard output.
    #[arg(long)]
    pub json: bool,
}

fn height_px(text: &str) -> Result<f64, String> {
    let height: Option<f64> = text.parse().ok();
    height
        .filter(|height| height.is_finite() && *height >= 0.0)
        .ok_or_else(|| "expected a number of pixels, 0 or more".to_owned())
}
