//! Arguments of `roadwatch export`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

/// What to make of a recording.
#[derive(Debug, Subcommand)]
pub enum ExportCommand {
    /// The scenes as JSON lines, as the daemon's scene stream offers them (docs/scene-stream.md).
    Scene(ExportSceneArgs),
    /// The locational and the rotational data frame, as Parquet and CSV, each with a plot.
    Frames(ExportFramesArgs),
    /// The scenes as an animated glTF file (.glb), for any viewer.
    Gltf(ExportGltfArgs),
}

/// The recording that is read.
#[derive(Debug, Args)]
pub struct RecordingArgs {
    /// The recording: a folder that `roadwatch run --bag` wrote, or an .mcap file.
    #[arg(long, value_name = "DIR")]
    pub bag: PathBuf,
    /// The scene's topic, where the recording holds those of several daemons.
    #[arg(long, value_name = "NAME")]
    pub topic: Option<String>,
}

/// Arguments of `export scene`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    roadwatch run config/demo.toml --pace lossless --bag drive && roadwatch export scene --bag drive -o scene.jsonl")]
pub struct ExportSceneArgs {
    /// What is read.
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// The file to write; it is replaced when all is written.
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
}

/// Arguments of `export frames`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    roadwatch export frames --bag drive -o frames\n\n\
    Writes locational.parquet, .csv and .png (trajectories from above), and rotational.parquet, .csv and .png\n\
    (headings over time). Columns and units: docs/data-frames.md.")]
pub struct ExportFramesArgs {
    /// What is read.
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// The folder to write to.
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Arguments of `export gltf`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    roadwatch export gltf --bag drive -o drive.glb\n\n\
    Opens in Blender, Windows' 3D viewer, three.js, model-viewer and others; press play.")]
pub struct ExportGltfArgs {
    /// What is read.
    #[command(flatten)]
    pub recording: RecordingArgs,
    /// The file to write (.glb); it is replaced when all is written.
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Leave out what is never nearer than this, metres.
    #[arg(long, value_name = "M", default_value_t = 100.0)]
    pub range_m: f64,
}
