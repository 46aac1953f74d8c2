//! Pictures of a board: which can be used, and why others cannot.

use crate::board::{Board, Corners, NoCorners};
use roadwatch_core::{ImageSize, Pixels};

/// A view of a video whose corners moved by less than this share of the image's width since a used one tells
/// nothing new.
const LEAST_MOVE_SHARE: f64 = 0.02;

/// A picture in which the board was found.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardView {
    /// What the picture is called.
    pub name: String,
    /// The corners.
    pub corners: Corners,
}

/// Why a picture is not used.
#[derive(Debug, thiserror::Error)]
pub enum Unused {
    /// It cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// The board is not found in it.
    #[error(transparent)]
    NoCorners(#[from] NoCorners),
    /// It shows what another shows.
    #[error("nearly the same view as {0}")]
    Similar(String),
    /// It does not fit the others.
    #[error("its corners are {0:.2} px off, far more than in the other pictures")]
    Outlier(f64),
}

impl Unused {
    /// The kind of reason, to count many pictures by.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Unreadable(_) => "cannot be read",
            Self::NoCorners(_) => "show no board",
            Self::Similar(_) => "show what another shows",
            Self::Outlier(_) => "do not fit the others",
        }
    }
}

/// A picture that is not used.
#[derive(Debug)]
pub struct UnusedView {
    /// What the picture is called.
    pub name: String,
    /// Why.
    pub why: Unused,
}

/// Pictures of different sizes: intrinsics belong to one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{name} is {found}, the pictures before it are {expected}: a camera is calibrated at one image size"
)]
pub struct OtherSize {
    /// The picture.
    pub name: String,
    /// Its size.
    pub found: ImageSize,
    /// The others'.
    pub expected: ImageSize,
}

/// Whether views that are nearly alike are all used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alike {
    /// Somebody chose the pictures.
    UseAll,
    /// A video shows the same view many times.
    UseFirst,
}

/// The views of a board seen so far.
#[derive(Debug)]
pub struct BoardViews {
    board: Board,
    alike: Alike,
    /// Size of the pictures; `None` before the first.
    pub size: Option<ImageSize>,
    /// Views with corners.
    pub used: Vec<BoardView>,
    /// The others.
    pub unused: Vec<UnusedView>,
}

impl BoardViews {
    /// No view yet.
    #[must_use]
    pub fn new(board: Board, alike: Alike) -> Self {
        Self {
            board,
            alike,
            size: None,
            used: Vec::new(),
            unused: Vec::new(),
        }
    }

    /// Looks for the board in a picture.
    ///
    /// # Errors
    /// When it is of another size than those before.
    pub fn push(&mut self, name: &str, picture: &Pixels) -> Result<(), OtherSize> {
        let expected = *self.size.get_or_insert(picture.size());
        if picture.size() != expected {
            return Err(OtherSize {
                name: name.to_owned(),
                found: picture.size(),
                expected,
            });
        }
        let found = self.board.find(picture).map_err(Unused::from);
        let found = found.and_then(|corners| match self.like(&corners, expected) {
            Some(other) => Err(Unused::Similar(other)),
            None => Ok(corners),
        });
        match found {
            Ok(corners) => self.used.push(BoardView {
                name: name.to_owned(),
                corners,
            }),
            Err(why) => self.skip(name, why),
        }
        Ok(())
    }

    /// Notes a picture that is not used.
    pub fn skip(&mut self, name: &str, why: Unused) {
        self.unused.push(UnusedView {
            name: name.to_owned(),
            why,
        });
    }

    /// The used view that shows nearly the same; `None` where there is none, or where that does not matter.
    fn like(&self, corners: &Corners, size: ImageSize) -> Option<String> {
        if self.alike == Alike::UseAll {
            return None;
        }
        let least_px = LEAST_MOVE_SHARE * f64::from(size.width_px);
        let is_like = |view: &&BoardView| {
            let (before, now) = (&view.corners.pixels, &corners.pixels);
            let moved: f64 = before.iter().zip(now).map(|(a, b)| (a - b).norm()).sum();
            view.corners.board_m == corners.board_m && moved < least_px * now.len() as f64
        };
        self.used.iter().find(is_like).map(|view| view.name.clone())
    }
}
