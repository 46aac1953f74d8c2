//! Arguments of `roadwatch table`.

use super::share;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// What to do with look-up tables.
#[derive(Debug, Subcommand)]
pub enum TableCommand {
    /// Build a camera's table from its calibration or from labelled images, or import a bare 7-column CSV.
    Build(Box<TableBuildArgs>),
    /// Say what a table is of, and optionally export its rows as CSV.
    Inspect(TableInspectArgs),
    /// Ask a table where a box is.
    Query(TableQueryArgs),
}

/// Arguments of `table build`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    roadwatch table build --rig ../shared/data/pandaset-dev/rig.toml --camera front -o front.rwtable\n  \
    roadwatch table build --from-dataset ../shared/data/pandaset-dev --camera front -o front.rwtable")]
pub struct TableBuildArgs {
    /// The rig: a `rig.toml` of a rig dataset.
    #[arg(long, value_name = "FILE", required_unless_present = "from_dataset")]
    pub rig: Option<PathBuf>,
    /// Take the rig and the rows from this rig dataset: one row for each labelled object (truth.jsonl) that is
    /// seen well, where it was, with the box of its silhouette or, where that is not labelled, of its cuboid.
    #[arg(
        long,
        value_name = "DIR",
        conflicts_with_all = ["rig", "import", "headings"]
    )]
    pub from_dataset: Option<PathBuf>,
    /// The camera's name in the rig.
    #[arg(long, value_name = "NAME")]
    pub camera: String,
    /// The table's file.
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// The class whose size and shape the table is for.
    #[arg(long, default_value = "car")]
    pub class: String,
    /// Length of the class, metres, where the configuration sets another than the built-in one.
    #[arg(long, value_name = "M", value_parser = size)]
    pub length_m: Option<f64>,
    /// Width of the class, metres, likewise.
    #[arg(long, value_name = "M", value_parser = size)]
    pub width_m: Option<f64>,
    /// Height of the class, metres, likewise.
    #[arg(long, value_name = "M", value_parser = size)]
    pub height_m: Option<f64>,
    /// Height of the ground plane in base_link, metres.
    #[arg(
        long,
        value_name = "M",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub ground_z_m: f64,
    /// Distance of neighbouring cells, metres.
    #[arg(long, value_name = "M")]
    pub step_m: Option<f64>,
    /// Greatest distance ahead, metres.
    #[arg(long, value_name = "M")]
    pub farthest_m: Option<f64>,
    /// Greatest distance to either side, metres.
    #[arg(long, value_name = "M")]
    pub lateral_m: Option<f64>,
    /// Headings per cell, over half a turn.
    #[arg(long, value_name = "N")]
    pub headings: Option<u32>,
    /// Take the rows from this CSV (Area,Center_x,Center_y,Distance,LocX,LocY,Loc) instead of building them.
    #[arg(long, value_name = "CSV")]
    pub import: Option<PathBuf>,
    /// Which labelled objects become rows.
    #[command(flatten)]
    pub labels: TableLabelArgs,
}

/// Which labelled objects become rows. The defaults are those of `evaluate`.
#[derive(Debug, Args)]
#[command(next_help_heading = "With --from-dataset")]
pub struct TableLabelArgs {
    /// Use only objects at least this high, pixels.
    #[arg(
        long,
        value_name = "PX",
        default_value_t = 20.0,
        conflicts_with_all = ["rig", "import"]
    )]
    pub min_height_px: f64,
    /// Use only objects hidden at most this much, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.3, value_parser = share, conflicts_with_all = ["rig", "import"])]
    pub max_occluded: f64,
    /// Use only objects at most this much outside the image, 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share, conflicts_with_all = ["rig", "import"])]
    pub max_truncated: f64,
}

/// Arguments of `table inspect`.
#[derive(Debug, Args)]
pub struct TableInspectArgs {
    /// The table's file.
    pub table: PathBuf,
    /// Write the rows as CSV.
    #[arg(long, value_name = "CSV")]
    pub export: Option<PathBuf>,
}

/// Arguments of `table query`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    roadwatch table query front.rwtable --box 470,260,560,330 --distance-m 18.5")]
pub struct TableQueryArgs {
    /// The table's file.
    pub table: PathBuf,
    /// The box, `x_min,y_min,x_max,y_max` in pixels.
    #[arg(
        long = "box",
        value_name = "X,Y,X,Y",
        value_delimiter = ',',
        num_args = 1,
        required = true
    )]
    pub box_px: Vec<f32>,
    /// Expected distance (eq. 2), metres.
    #[arg(long, value_name = "M")]
    pub distance_m: f32,
    /// Weight of the distance in the score, pixels per metre of this table's images.
    #[arg(long, value_name = "PX_PER_M")]
    pub weight: Option<f32>,
}

fn size(text: &str) -> Result<f64, String> {
    let size: Option<f64> = text.parse().ok();
    size.filter(|size| (0.01..=100.0).contains(size))
        .ok_or_else(|| "expected metres, 0.01 to 100".to_owned())
}
