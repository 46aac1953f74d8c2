//! Arguments of `roadwatch models`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

/// What to do with models.
#[derive(Debug, Subcommand)]
pub enum ModelsCommand {
    /// Print the models that are known by name: licence, decode head, and whether they are here.
    List(ModelsListArgs),
    /// Fetch a model by name, check it, and print the path for `detector.model`.
    Fetch(ModelsFetchArgs),
    /// Open a model and say its head, classes, provider and speed.
    Verify(ModelsVerifyArgs),
}

/// Arguments of `models list`.
#[derive(Debug, Args)]
#[command(
    after_help = "Fetched models are looked for in $XDG_DATA_HOME/roadwatch/models, or in \
    ~/.local/share/roadwatch/models where that is not set."
)]
pub struct ModelsListArgs {
    /// Print everything that is known of them as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `models fetch`.
#[derive(Debug, Args)]
#[command(
    after_help = "Its licence is printed before anything is fetched. Many networks are AGPL-3.0, which binds \
    what you ship or serve with them; those under Apache-2.0 do not.\n\n\
    A fetch that breaks off goes on where it was when run again. The file gets its name only when it is whole and \
    its sha256 is the registry's. What is still coming is called FILE.part.\n\n\
    Examples:\n  \
    roadwatch models fetch yolox_s\n  \
    roadwatch models fetch yolov8n --to models\n  \
    roadwatch models fetch yolov5s --url https://mirror.example/yolov5s.onnx --accept-unverified"
)]
pub struct ModelsFetchArgs {
    /// The model's name: `roadwatch models list` has them.
    pub name: String,
    /// The folder to put it into; made where it is missing. [default: $XDG_DATA_HOME/roadwatch/models, or
    /// ~/.local/share/roadwatch/models]
    #[arg(long, value_name = "DIR")]
    pub to: Option<PathBuf>,
    /// Fetch it from here instead of from where it is published; the registry's sha256 is checked all the same.
    #[arg(long, value_name = "URL")]
    pub url: Option<String>,
    /// Take what comes where the registry knows no sha256. Its size and sha256 are printed: compare them with
    /// those of somebody you trust.
    #[arg(long)]
    pub accept_unverified: bool,
}

/// Arguments of `models verify`.
#[derive(Debug, Args)]
pub struct ModelsVerifyArgs {
    /// The ONNX file.
    pub model: PathBuf,
    /// Runs to time.
    #[arg(long, default_value_t = 20)]
    pub runs: u32,
    /// Threads inside one run; 0 for all cores.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Input size for models that leave theirs open, `WIDTHxHEIGHT`.
    #[arg(long, value_name = "WxH")]
    pub input_size: Option<String>,
}
