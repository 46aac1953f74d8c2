//! Chessboards and ChArUco boards: where their corners are on the board, and in a picture.

use opencv::{
    aruco::{self, CharucoBoard, Dictionary},
    calib3d::{CALIB_CB_ACCURACY, CALIB_CB_NORMALIZE_IMAGE, find_chessboard_corners_sb},
    core::{Mat, Point2f, Ptr, Size, Vector},
    imgcodecs::{IMREAD_COLOR, IMREAD_IGNORE_ORIENTATION, imread},
    imgproc::{COLOR_BGR2GRAY, cvt_color_def},
    prelude::*,
};
use roadwatch_core::{ImageSize, Pixels, camera_model::Pixel};
use std::{fmt, path::Path};

/// A ChArUco board may be partly hidden; fewer corners than this hold a view badly.
const LEAST_CHARUCO_CORNERS: usize = 8;

/// What is printed on a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoardKind {
    /// Black and white squares.
    Chessboard,
    /// A chessboard with a marker in every white square.
    Charuco {
        /// Side of a marker, metres.
        marker_m: f64,
        /// The markers' dictionary, as OpenCV numbers it.
        dictionary: i32,
    },
}

/// A calibration board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Board {
    /// What is printed on it.
    pub kind: BoardKind,
    /// Columns: of inner corners for a chessboard, of squares for ChArUco.
    pub columns: u32,
    /// Rows, likewise.
    pub rows: u32,
    /// Side of a square, metres.
    pub square_m: f64,
}

/// The corners of a board in one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Corners {
    /// Where each is on the board, metres.
    pub board_m: Vec<[f64; 2]>,
    /// Where each is in the picture, in the same order.
    pub pixels: Vec<Pixel>,
}

/// Why a picture has no corners.
#[derive(Debug, thiserror::Error)]
pub enum NoCorners {
    /// The board is not found.
    #[error("no board of this size is found")]
    NotSeen,
    /// Only some of a ChArUco board's corners.
    #[error("only {0} corners are found; {LEAST_CHARUCO_CORNERS} are needed")]
    Few(usize),
    /// OpenCV fails.
    #[error("OpenCV fails on it")]
    OpenCv(#[from] opencv::Error),
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.kind {
            BoardKind::Chessboard => "chessboard with inner corners",
            BoardKind::Charuco { .. } => "ChArUco board with squares",
        };
        write!(f, "{what} {} x {}", self.columns, self.rows)
    }
}

impl Board {
    /// OpenCV's number of a dictionary called such as `5x5_100`; `None` when there is none.
    #[must_use]
    pub fn dictionary(name: &str) -> Option<i32> {
        let (bits, count) = name.split_once('_')?;
        let bits = ["4x4", "5x5", "6x6", "7x7"]
            .iter()
            .position(|b| *b == bits)?;
        let count = ["50", "100", "250", "1000"]
            .iter()
            .position(|c| *c == count)?;
        i32::try_from(4 * bits + count).ok()
    }

    /// The board's corners in a picture, to a fraction of a pixel.
    ///
    /// # Errors
    /// When the board is not found, or too little of it.
    pub fn find(&self, picture: &Pixels) -> Result<Corners, NoCorners> {
        let grey = grey(picture)?;
        match self.kind {
            BoardKind::Chessboard => self.find_chessboard(&grey),
            BoardKind::Charuco {
                marker_m,
                dictionary,
            } => self.find_charuco(&grey, marker_m, dictionary),
        }
    }

    fn find_chessboard(&self, grey: &Mat) -> Result<Corners, NoCorners> {
        let size = Size::new(self.columns as i32, self.rows as i32);
        let flags = CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_ACCURACY;
        let mut found = Vector::<Point2f>::new();
        if !find_chessboard_corners_sb(grey, size, &mut found, flags)? {
            return Err(NoCorners::NotSeen);
        }
        let numbers = 0..self.columns * self.rows;
        Ok(Corners {
            board_m: numbers
                .map(|number| self.corner_m(number, self.columns))
                .collect(),
            pixels: pixels(&found),
        })
    }

    fn find_charuco(
        &self,
        grey: &Mat,
        marker_m: f64,
        dictionary: i32,
    ) -> Result<Corners, NoCorners> {
        let dictionary: Ptr<Dictionary> = aruco::get_predefined_dictionary_i32(dictionary)?;
        let board = CharucoBoard::create(
            self.columns as i32,
            self.rows as i32,
            self.square_m as f32,
            marker_m as f32,
            &dictionary,
        )?;
        let mut markers = Vector::<Vector<Point2f>>::new();
        let mut ids = Vector::<i32>::new();
        aruco::detect_markers_def(grey, &dictionary, &mut markers, &mut ids)?;
        if ids.is_empty() {
            return Err(NoCorners::NotSeen);
        }
        let (mut found, mut numbers) = (Vector::<Point2f>::new(), Vector::<i32>::new());
        aruco::interpolate_corners_charuco_def(
            &markers,
            &ids,
            grey,
            &board,
            &mut found,
            &mut numbers,
        )?;
        if found.len() < LEAST_CHARUCO_CORNERS {
            return Err(NoCorners::Few(found.len()));
        }
        let numbers = numbers
            .iter()
            .filter_map(|number| u32::try_from(number).ok());
        Ok(Corners {
            board_m: numbers
                .map(|number| self.corner_m(number, self.columns - 1))
                .collect(),
            pixels: pixels(&found),
        })
    }

    /// Where the corner of a number is, rows of `columns` one after the other, metres.
    fn corner_m(&self, number: u32, columns: u32) -> [f64; 2] {
        [number % columns, number / columns].map(|step| f64::from(step) * self.square_m)
    }
}

/// Reads a picture as its sensor saw it.
///
/// # Errors
/// When the file is no picture that OpenCV reads.
pub fn read_picture(file: &Path) -> Result<Pixels, UnreadablePicture> {
    let mat = imread(file, IMREAD_COLOR | IMREAD_IGNORE_ORIENTATION)?;
    if mat.empty() {
        return Err(UnreadablePicture::NotAPicture);
    }
    let size = ImageSize {
        width_px: mat.cols() as u32,
        height_px: mat.rows() as u32,
    };
    Ok(Pixels::new(size, mat.data_bytes()?.to_vec())?)
}

/// A file that is no picture.
#[derive(Debug, thiserror::Error)]
pub enum UnreadablePicture {
    /// Of another kind, or broken.
    #[error("not a picture that can be read")]
    NotAPicture,
    /// Its pixels are not there.
    #[error(transparent)]
    Pixels(#[from] roadwatch_core::DecodeError),
    /// OpenCV fails.
    #[error("OpenCV fails on it")]
    OpenCv(#[from] opencv::Error),
}

fn grey(picture: &Pixels) -> Result<Mat, opencv::Error> {
    let flat = Mat::from_slice(picture.bgr())?;
    let colour = flat.reshape(3, picture.size().height_px as i32)?;
    let mut grey = Mat::default();
    cvt_color_def(&colour, &mut grey, COLOR_BGR2GRAY)?;
    Ok(grey)
}

fn pixels(points: &Vector<Point2f>) -> Vec<Pixel> {
    let points = points.iter();
    points
        .map(|point| Pixel::new(f64::from(point.x), f64::from(point.y)))
        .collect()
}
