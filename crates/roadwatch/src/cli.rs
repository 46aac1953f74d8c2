//! The command line.

mod calibrate;
mod collect;
mod evaluate;
mod export;
mod models;
mod rotation;
mod study;
mod table;

pub use calibrate::{
    BoxesFrom, CalibrateCameraArgs, CalibrateCommand, CalibrateFocalArgs, CalibrateMountArgs,
    CalibrateRotationArgs, SolvedPart, TrustedPart,
};
pub use collect::CollectArgs;
pub use evaluate::{EvaluateArgs, FormatName};
pub use export::{ExportCommand, ExportFramesArgs, ExportGltfArgs, ExportSceneArgs, RecordingArgs};
pub use models::{ModelsCommand, ModelsFetchArgs, ModelsListArgs, ModelsVerifyArgs};
pub use rotation::{
    RecipeName, RotationCommand, RotationEvaluateArgs, RotationRowsArgs, RotationTrainArgs,
};
pub use study::{StudyArgs, StudyBoxes};
pub use table::{TableBuildArgs, TableCommand, TableInspectArgs, TableQueryArgs};

use crate::{commands, failure::Failure, node::RosoutTap};
use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum, error::ErrorKind};
use roadwatch_ros::RosArgs;
use std::{ffi::OsString, io::IsTerminal as _, net::SocketAddr, path::PathBuf, process::ExitCode};
use tracing_subscriber::{EnvFilter, layer::SubscriberExt as _, util::SubscriberInitExt as _};

/// The middleware warns of what is normal here (no ROS installation) and reports errors on every clean
/// exit, so it is heard only when asked.
const DEFAULT_LOG: &str = "warn,ros2_client=off,rustdds=off";
const QUIET_MIDDLEWARE: &str = "ros2_client=off,rustdds=off";

/// Real-time multi-camera perception: camera images in, poses with 3D boxes out over ROS 2.
///
/// Start with `roadwatch run config/demo.toml`, and see what it would do with `roadwatch graph`.
#[derive(Debug, Parser)]
#[command(name = "roadwatch", version, arg_required_else_help = true)]
pub struct Cli {
    /// Log level: error, warn, info, debug, trace, or a filter such as `roadwatch_ros=debug`.
    #[arg(long, global = true, default_value = DEFAULT_LOG, value_name = "FILTER")]
    pub log: String,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the daemon until its sources end or it is told to stop (SIGINT, SIGTERM).
    Run(RunArgs),
    /// Check a configuration and everything it names; print every mistake with file, line and key.
    Check(ConfigArgs),
    /// Print the cameras, stages, queues and topics a configuration gives.
    Graph(ConfigArgs),
    /// Calibration: focal values, lenses, mounts.
    #[command(subcommand)]
    Calibrate(CalibrateCommand),
    /// Look-up tables: build, inspect, query.
    #[command(subcommand)]
    Table(TableCommand),
    /// Run the pipeline over a labelled dataset and score every method side by side.
    Evaluate(EvaluateArgs),
    /// Run the daemon and keep what its cameras see as a dataset, with what was said of it.
    Collect(Box<CollectArgs>),
    /// Make something of a recording: JSON lines, data frames, a 3D scene.
    #[command(subcommand)]
    Export(ExportCommand),
    /// Headings from key components: rows, forests, and how good they are.
    #[command(subcommand)]
    Rotation(RotationCommand),
    /// Repeat the paper's studies on simulated drives whose truth is exact.
    Study(StudyArgs),
    /// Detector models: list, fetch, verify.
    #[command(subcommand)]
    Models(ModelsCommand),
}

/// A configuration file.
#[derive(Debug, Args)]
pub struct ConfigArgs {
    /// The configuration file (TOML).
    pub config: PathBuf,
    /// ROS 2's own.
    #[command(flatten)]
    pub ros: RosArguments,
}

/// What launch files and `ros2 run` pass on.
#[derive(Debug, Args)]
pub struct RosArguments {
    /// ROS 2's own arguments, up to `--` or the end: -r __node:=NAME, -r __ns:=/NAMESPACE, -r TOPIC:=OTHER,
    /// -p KEY:=VALUE (any key of the configuration), --params-file FILE.yaml, --log-level LEVEL.
    #[arg(
        long = "ros-args",
        value_name = "ROS",
        num_args = 0..,
        allow_hyphen_values = true,
        value_terminator = "--"
    )]
    tokens: Vec<String>,
}

impl RosArguments {
    /// Read; a mistake ends the program as other wrong arguments do.
    pub fn read(&self) -> RosArgs {
        RosArgs::parse(&self.tokens).unwrap_or_else(|error| {
            let what = format!("--ros-args: {error}");
            Cli::command()
                .error(ErrorKind::ValueValidation, what)
                .exit()
        })
    }
}

/// What happens when frames come faster than they are worked off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Pace {
    /// Frames come at recorded speed; the newest wins, drops are counted.
    Realtime,
    /// Sources wait; nothing is dropped; the same input gives the same output.
    Lossless,
}

/// Arguments of `run`.
#[derive(Debug, Args)]
#[command(
    args_override_self = true,
    after_help = "Examples:\n  \
    roadwatch run config/demo.toml\n  \
    roadwatch run config/pandaset.toml --pace lossless --bag out\n  \
    roadwatch run config/pandaset.toml --pace lossless --score --pictures pictures\n  \
    roadwatch run config/pandaset.toml --loop --speed 2\n  \
    roadwatch run config/demo.toml --loop --scene-stream 127.0.0.1:7600"
)]
pub struct RunArgs {
    /// The configuration file (TOML).
    pub config: PathBuf,
    /// What happens when frames come faster than they are worked off.
    #[arg(long, value_enum, default_value_t = Pace::Realtime)]
    pub pace: Pace,
    /// Record everything published into this folder (MCAP and metadata.yaml); it must not exist or be empty.
    #[arg(long, value_name = "OUT")]
    pub bag: Option<PathBuf>,
    /// Record the cameras' images, too: such a bag can be a camera's source again (`bag` and `topic` in its table).
    #[arg(long, requires = "bag")]
    pub bag_images: bool,
    /// Begin another file of the bag when one has so many megabytes of messages.
    #[arg(long, value_name = "MB", requires = "bag", value_parser = clap::value_parser!(u64).range(1..))]
    pub bag_split_mb: Option<u64>,
    /// Begin another file of the bag after so many seconds.
    #[arg(long, value_name = "SECS", requires = "bag", value_parser = clap::value_parser!(u64).range(1..))]
    pub bag_split_secs: Option<u64>,
    /// Offer the scene as JSON lines on this address, whatever the configuration says; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS")]
    pub scene_stream: Option<SocketAddr>,
    /// Draw the fullest round of the run into this folder: views.png, every camera with its 3D boxes, and
    /// scene.png, the scene from above.
    #[arg(long, value_name = "DIR")]
    pub pictures: Option<PathBuf>,
    /// Compare what was published with the labels of the dataset (truth.jsonl), and say at the end how far off
    /// it was.
    #[arg(long, conflicts_with = "repeat")]
    pub score: bool,
    /// Begin recordings anew when they end; stamps keep rising.
    #[arg(long = "loop")]
    pub repeat: bool,
    /// End after this many frames of each camera.
    #[arg(long, value_name = "N")]
    pub frames: Option<u64>,
    /// Play recordings this many times as fast as recorded (realtime pace only).
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub speed: f64,
    /// Take images, rig and stamps from this rig dataset instead of the configured one.
    #[arg(long, value_name = "DIR")]
    pub dataset: Option<PathBuf>,
    /// Print the final counts and latencies as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// ROS 2's own.
    #[command(flatten)]
    pub ros: RosArguments,
}

fn share(text: &str) -> Result<f64, String> {
    let share: Option<f64> = text.parse().ok();
    share
        .filter(|share| (0.0..=1.0).contains(share))
        .ok_or_else(|| "expected a share, 0 to 1".to_owned())
}

/// Runs the command that the arguments name, and gives the process's exit code.
pub fn main_with(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = Cli::try_parse_from(arguments);
    let cli = match cli {
        Ok(cli) => cli,
        Err(error) => error.exit(),
    };
    let rosout = RosoutTap::default();
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false);
    tracing_subscriber::registry()
        .with(EnvFilter::new(log_filter(&cli)))
        .with(lines)
        .with(rosout.clone())
        .init();
    match run(cli.command, &rosout) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            failure.exit_code()
        }
    }
}

/// What is logged: ROS's level, where one was given, in the place of the default.
fn log_filter(cli: &Cli) -> String {
    let ros = match &cli.command {
        Command::Run(args) => Some(&args.ros),
        Command::Collect(args) => Some(&args.run.ros),
        Command::Check(args) | Command::Graph(args) => Some(&args.ros),
        _ => None,
    };
    match ros.and_then(|ros| ros.read().log_level) {
        Some(level) => format!("{},{QUIET_MIDDLEWARE}", level.as_str()),
        None => cli.log.clone(),
    }
}

fn run(command: Command, rosout: &RosoutTap) -> Result<(), Failure> {
    match command {
        Command::Run(args) => commands::run::run(&args, rosout),
        Command::Check(args) => commands::check::run(&args),
        Command::Graph(args) => commands::graph::run(&args),
        Command::Calibrate(command) => commands::calibrate::run(&command),
        Command::Table(TableCommand::Build(args)) => commands::table::build(&args),
        Command::Table(TableCommand::Inspect(args)) => commands::table::inspect(&args),
        Command::Table(TableCommand::Query(args)) => commands::table::query(&args),
        Command::Evaluate(args) => commands::evaluate::run(&args),
        Command::Collect(args) => commands::collect::run(&args, rosout),
        Command::Export(command) => commands::export::run(&command),
        Command::Rotation(command) => commands::rotation::run(&command),
        Command::Study(args) => commands::study::run(&args),
        Command::Models(ModelsCommand::List(args)) => commands::models::list(&args),
        Command::Models(ModelsCommand::Fetch(args)) => commands::models::fetch(&args),
        Command::Models(ModelsCommand::Verify(args)) => commands::models::verify(&args),
    }
}
