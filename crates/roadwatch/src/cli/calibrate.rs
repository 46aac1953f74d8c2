//! Arguments of `roadwatch calibrate`.

use clap::{ArgGroup, Args, Subcommand, ValueEnum};
use roadwatch_calibrate::KnownObject;
use roadwatch_rotate::position_curve::MEAN_LOC_Y_M;
use std::path::PathBuf;

/// What to calibrate. Nothing here changes a file of yours: what was found is printed as keys to paste.
#[derive(Debug, Subcommand)]
pub enum CalibrateCommand {
    /// Measure a focal value with an object of known size at a known distance: F = P * D / W (eq. 1).
    Focal(CalibrateFocalArgs),
    /// Find a camera's lens from pictures of a chessboard or ChArUco board; write ROS camera_info YAML.
    Camera(Box<CalibrateCameraArgs>),
    /// Find how a camera is mounted: from points on the ground, from lines on the road, or from a drive.
    Mount(Box<CalibrateMountArgs>),
    /// Fit the paper's curve of rotation bias against LocX, from rows of cars at one distance (Fig. 13.2).
    Rotation(CalibrateRotationArgs),
}

/// Arguments of `calibrate focal`.
#[derive(Debug, Args)]
#[command(
    after_help = "A car 1.4 m high, 50 m ahead of the camera, is 55 pixels high in a full-HD image:\n  \
    roadwatch calibrate focal --measurement 55,50,1.4 --image-height-px 1080\n\n\
    Several measurements show how far they agree:\n  \
    roadwatch calibrate focal --measurement 55,50,1.4 --measurement 92,30,1.4 --image-height-px 1080\n\n\
    With an image and a box, P is the box's height:\n  \
    roadwatch calibrate focal --image car.jpg --box 470,260,560,315 --distance-m 50 --size-m 1.4 --picture focal.png"
)]
pub struct CalibrateFocalArgs {
    /// Height in the image (pixels), distance along the optical axis (m), real height (m); may be repeated.
    #[arg(long, value_name = "PX,M,M", value_parser = known_object, requires = "image_height_px", required_unless_present = "image")]
    pub measurement: Vec<KnownObject>,
    /// Height of the images that were measured in, pixels: a focal value belongs to an image size.
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(1..=16_384))]
    pub image_height_px: Option<u32>,
    /// An image of the known object.
    #[arg(long, value_name = "FILE", requires_all = ["box_px", "distance_m", "size_m"])]
    pub image: Option<PathBuf>,
    /// Its box in that image, `x_min,y_min,x_max,y_max` in pixels.
    #[arg(
        long = "box",
        value_name = "X,Y,X,Y",
        value_delimiter = ',',
        num_args = 1,
        requires = "image"
    )]
    pub box_px: Vec<f32>,
    /// Its distance, metres.
    #[arg(long, value_name = "M", requires = "image")]
    pub distance_m: Option<f64>,
    /// Its real height, metres.
    #[arg(long, value_name = "M", requires = "image")]
    pub size_m: Option<f64>,
    /// Name of the camera, for the keys to paste.
    #[arg(long, value_name = "NAME", default_value = "front")]
    pub camera: String,
    /// Draw the box with P, D, W and F into this picture.
    #[arg(long, value_name = "FILE", requires = "image")]
    pub picture: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `calibrate camera`.
#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("source").required(true).args(["images", "video", "drive", "live"]),
    after_help = "Show the board at all distances, in all corners of the image, and tilted. About 20 pictures do; \
    12 good ones suffice. --board counts inner corners: a board of 9 x 7 squares has 8 x 6.\n\n\
    Examples:\n  \
    roadwatch calibrate camera --board 8x6 --square-m 0.108 --images pictures -o front.yaml --picture front.png\n  \
    roadwatch calibrate camera --board 8x6 --square-m 0.108 --video board.mp4 --fisheye -o left.yaml\n  \
    roadwatch calibrate camera --board 8x6 --square-m 0.108 --live /dev/video0 -o front.yaml\n  \
    roadwatch calibrate camera --charuco 5x7 --square-m 0.04 --marker-m 0.03 --dictionary 5x5_100 --images 'p/*.png' -o cam.yaml\n\n\
    The daemon reads what is written: camera_info = \"file:///etc/roadwatch/front.yaml\" in a [[camera]] table."
)]
pub struct CalibrateCameraArgs {
    /// A chessboard's inner corners, columns x rows.
    #[arg(long, value_name = "CxR", value_parser = board_size, required_unless_present = "charuco")]
    pub board: Option<(u32, u32)>,
    /// A ChArUco board's squares, columns x rows, instead of a chessboard.
    #[arg(long, value_name = "CxR", value_parser = board_size, conflicts_with = "board", requires = "marker_m")]
    pub charuco: Option<(u32, u32)>,
    /// Side of a square, metres.
    #[arg(long, value_name = "M", value_parser = side)]
    pub square_m: f64,
    /// Side of a ChArUco marker, metres.
    #[arg(long, value_name = "M", value_parser = side, requires = "charuco")]
    pub marker_m: Option<f64>,
    /// Dictionary of a ChArUco board's markers, such as 4x4_50, 5x5_100, 6x6_250.
    #[arg(
        long,
        value_name = "NAME",
        default_value = "5x5_100",
        requires = "charuco"
    )]
    pub dictionary: String,
    /// A folder of pictures, or a pattern such as 'pictures/left*.png'.
    #[arg(long, value_name = "DIR|GLOB")]
    pub images: Option<String>,
    /// A video.
    #[arg(long, value_name = "FILE")]
    pub video: Option<PathBuf>,
    /// A rig dataset, with --camera.
    #[arg(long, value_name = "DATASET", requires = "camera")]
    pub drive: Option<PathBuf>,
    /// A camera that runs: a device or an address. Move the board; views that differ are taken until there are
    /// enough. Ctrl-C ends earlier, with the views so far.
    #[arg(long, value_name = "/dev/videoN|URL")]
    pub live: Option<String>,
    /// With --live: how many different views are enough.
    #[arg(long, value_name = "N", default_value_t = 25, requires = "live", value_parser = clap::value_parser!(u32).range(12..=1000))]
    pub views: u32,
    /// Name of the camera.
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Look at every n-th frame of a video or dataset.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// Fit an equidistant (fisheye) lens instead of plumb_bob.
    #[arg(long)]
    pub fisheye: bool,
    /// The camera_info YAML to write.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw all corners and their residuals over one of the pictures.
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Whose boxes are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BoxesFrom {
    /// The configured detector's.
    Detector,
    /// The labels' (truth.jsonl), with the sizes that they give.
    Truth,
}

/// What is believed, where boxes tell only the ratio of the two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TrustedPart {
    /// Mean sizes of classes (`[locate]`): the camera's height is found.
    Sizes,
    /// The camera's height as it is set: pitch and roll are found, and how large objects really are.
    Height,
}

/// How much of the mount is looked for from points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolvedPart {
    /// Yaw, pitch, roll (2 points or more).
    Angles,
    /// And the height (3 points or more).
    Height,
    /// And the whole position (4 points or more).
    Position,
}

/// Arguments of `calibrate mount`.
#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("evidence").required(true).args(["points", "lines", "drive"]),
    after_help = "From marks on the ground (u,v in pixels; x,y in metres of base_link):\n  \
    roadwatch calibrate mount --points marks.csv --rig rig.toml --camera front --image front.jpg --picture mount.png\n\n\
    From lane markings, parallel to the vehicle (u1,v1,u2,v2 in pixels); two borders of one lane give the height:\n  \
    roadwatch calibrate mount --lines lanes.csv --lane-width-m 3.5 --rig rig.toml --camera front\n\n\
    From a drive on flat roads with traffic, all cameras at once:\n  \
    roadwatch calibrate mount --drive ../shared/data/pandaset-dev --config config/pandaset.toml\n\n\
    A height from a drive is as good as the mean size of the objects met (class sizes in [locate]); where a tape \
    measure knows better, say --trust height."
)]
pub struct CalibrateMountArgs {
    /// Points of known place: CSV with columns u,v,x,y and optionally z.
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Line segments along the vehicle's x axis on the ground: CSV with columns u1,v1,u2,v2.
    #[arg(long, value_name = "FILE")]
    pub lines: Option<PathBuf>,
    /// A drive: a rig dataset.
    #[arg(long, value_name = "DATASET", requires = "config", conflicts_with_all = ["rig", "image"])]
    pub drive: Option<PathBuf>,
    /// The rig: a `rig.toml` with the camera's lens, and the mount to begin with.
    #[arg(long, value_name = "FILE", required_unless_present = "config")]
    pub rig: Option<PathBuf>,
    /// The rig, and with --drive the detector and the sizes of classes: a configuration.
    #[arg(long, value_name = "CONFIG", conflicts_with = "rig")]
    pub config: Option<PathBuf>,
    /// The camera. With --drive: all of them, where none is named.
    #[arg(long, value_name = "NAME", required_unless_present = "drive")]
    pub camera: Option<String>,
    /// Height of the ground plane in base_link, metres. [default: the configuration's, or 0]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub ground_z_m: Option<f64>,
    /// With --points: what is looked for.
    #[arg(long, value_enum, default_value_t = SolvedPart::Height)]
    pub solve: SolvedPart,
    /// With --lines: distance of the two lines that the segments lie on, metres.
    #[arg(long, value_name = "M", value_parser = side, requires = "lines")]
    pub lane_width_m: Option<f64>,
    /// With --drive: whose boxes.
    #[arg(long, value_enum, default_value_t = BoxesFrom::Detector)]
    pub boxes: BoxesFrom,
    /// With --drive: what is believed.
    #[arg(long, value_enum, default_value_t = TrustedPart::Sizes)]
    pub trust: TrustedPart,
    /// With --drive: look only at these classes; repeat or separate by commas.
    #[arg(
        long,
        value_name = "CLASS",
        value_delimiter = ',',
        default_value = "car"
    )]
    pub class: Vec<String>,
    /// With --drive: use only the first frames of each camera.
    #[arg(long, value_name = "N")]
    pub frames: Option<u64>,
    /// An image of the camera, to draw the picture over.
    #[arg(long, value_name = "FILE")]
    pub image: Option<PathBuf>,
    /// Draw horizon and ground before and after. With several cameras their names are added.
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `calibrate rotation`.
#[derive(Debug, Args)]
#[command(
    after_help = "What a crop shows is the angle to the viewing ray, so cars that point the same way look different. \
    The daemon adds the exact ray where the camera's pose is known, which it always is; the curve is the paper's way:\n  \
    roadwatch calibrate rotation rows.csv --forest models/roadwatch_rotation.forest -o curve.json --picture curve.png\n\n\
    Rows come from `roadwatch rotation rows`. position_curve = \"curve.json\" in [rotation] puts it in force."
)]
pub struct CalibrateRotationArgs {
    /// Rows (CSV of `rotation rows`).
    pub rows: PathBuf,
    /// The forest whose bias is found.
    #[arg(long, value_name = "FILE")]
    pub forest: PathBuf,
    /// Distance ahead whose curve stands for all, metres.
    #[arg(long, value_name = "M", default_value_t = MEAN_LOC_Y_M, value_parser = side)]
    pub loc_y_m: f64,
    /// Take rows this much nearer and farther, metres.
    #[arg(long, value_name = "M", default_value_t = 5.0, value_parser = side)]
    pub within_m: f64,
    /// The curve's file (JSON).
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Draw rows and curve.
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

fn known_object(text: &str) -> Result<KnownObject, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    match numbers.as_deref() {
        Some(&[height_px, distance_m, size_m]) => Ok(KnownObject {
            height_px,
            distance_m,
            size_m,
        }),
        _ => Err("expected pixels, metres, metres, like 55,50,1.4".to_owned()),
    }
}

fn board_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(columns, rows)| {
        let range = 2..=100;
        let side = |text: &str| text.parse().ok().filter(|side| range.contains(side));
        Some((side(columns)?, side(rows)?))
    });
    sides.ok_or_else(|| "expected columns x rows, like 8x6".to_owned())
}

fn side(text: &str) -> Result<f64, String> {
    let side: Option<f64> = text.parse().ok();
    side.filter(|side| (0.001..=100.0).contains(side))
        .ok_or_else(|| "expected metres, 0.001 to 100".to_owned())
}
