//! Still images played as a camera: a folder at a fixed rate, or files that each have their stamp.

use crate::{
    counted::{Counted, DecodeCount},
    frame_rate::FrameRate,
    natural_order::natural_order,
    player::Recording,
    span::Span,
    still_image::StillImage,
};
use roadwatch_core::{Image, ImageSize, SourceError, Timestamp};
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Which files of a folder are images.
const EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];

/// One image file and when it was captured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StampedFile {
    /// A JPEG or PNG file.
    pub file: PathBuf,
    /// When it was captured.
    pub stamp: Timestamp,
}

/// A folder or a list of images that cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum SequenceError {
    /// The folder is not there or not ours to read.
    #[error("`{}` cannot be read as a folder of images", folder.display())]
    Unreadable {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// No image in the folder.
    #[error("`{}` holds no image: expected .jpg, .jpeg or .png files", folder.display())]
    NoImages {
        /// The folder.
        folder: PathBuf,
    },
    /// A list of no images.
    #[error("a sequence needs at least one image")]
    Empty,
    /// A stamp is not later than the one before it.
    #[error(
        "the stamp {stamp} of `{}` is not later than {previous}, the one before it: put the images \
         in order of capture",
        file.display()
    )]
    StampsFall {
        /// The later image.
        file: PathBuf,
        /// Its stamp.
        stamp: Timestamp,
        /// The stamp before it.
        previous: Timestamp,
    },
}

/// Image files in order of capture. Files are read when their frame is due and decoded when somebody looks;
/// one that is not there any more is a lost frame.
#[derive(Clone, Debug)]
pub struct ImageSequence {
    files: Vec<StampedFile>,
    span: Span,
    size: ImageSize,
    decodes: DecodeCount,
    next: usize,
}

impl ImageSequence {
    /// All `.jpg`, `.jpeg` and `.png` files of `folder`, in natural order of their names; the first captured
    /// at `start`, the others at `rate`. Other files are not looked at. Each image must be `size`.
    ///
    /// # Errors
    /// When the folder cannot be read or holds no image.
    pub fn open(
        folder: &Path,
        size: ImageSize,
        rate: FrameRate,
        start: Timestamp,
    ) -> Result<Self, SequenceError> {
        let files = list_images(folder).map_err(|source| SequenceError::Unreadable {
            folder: folder.to_owned(),
            source,
        })?;
        let last_index =
            (files.len() as u64)
                .checked_sub(1)
                .ok_or_else(|| SequenceError::NoImages {
                    folder: folder.to_owned(),
                })?;
        let span = Span {
            first: start,
            last: start.saturating_add(rate.offset(last_index)),
            interval: rate.interval(),
        };
        let stamped = (0..).zip(files).map(|(index, file)| StampedFile {
            file,
            stamp: start.saturating_add(rate.offset(index)),
        });
        Ok(Self::with_span(stamped.collect(), span, size))
    }

    /// Images with a stamp each. Each must be `size`.
    ///
    /// # Errors
    /// When there is none, or stamps do not rise.
    pub fn from_files(files: Vec<StampedFile>, size: ImageSize) -> Result<Self, SequenceError> {
        for (before, after) in files.iter().zip(files.iter().skip(1)) {
            if after.stamp <= before.stamp {
                return Err(SequenceError::StampsFall {
                    file: after.file.clone(),
                    stamp: after.stamp,
                    previous: before.stamp,
                });
            }
        }
        let span = Span::from_stamps(files.iter().map(|file| file.stamp));
        Ok(Self::with_span(
            files,
            span.ok_or(SequenceError::Empty)?,
            size,
        ))
    }

    fn with_span(files: Vec<StampedFile>, span: Span, size: ImageSize) -> Self {
        Self {
            files,
            span,
            size,
            decodes: DecodeCount::default(),
            next: 0,
        }
    }

    /// The same sequence; every decode of one of its images adds one to `decodes`.
    #[must_use]
    pub fn counting(self, decodes: DecodeCount) -> Self {
        Self { decodes, ..self }
    }

    /// The images, in order.
    #[must_use]
    pub fn files(&self) -> &[StampedFile] {
        &self.files
    }
}

impl Recording for ImageSequence {
    fn span(&self) -> Span {
        self.span
    }

    fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError> {
        Ok(self.files.get(self.next).map(|file| file.stamp))
    }

    fn take_image(&mut self) -> Result<Image, SourceError> {
        let StampedFile { file, .. } = self.files.get(self.next).ok_or(SourceError::EndOfStream)?;
        self.next += 1;
        let bytes = fs::read(file).map_err(|source| {
            SourceError::FrameLost(Box::new(LostFile {
                file: file.clone(),
                source,
            }))
        })?;
        let still = StillImage::new(bytes, self.size, file.display().to_string());
        Ok(Image::encoded(Box::new(Counted::new(
            still,
            self.decodes.clone(),
        ))))
    }

    fn rewind(&mut self) -> Result<(), SourceError> {
        self.next = 0;
        Ok(())
    }
}

/// The cause of a lost frame: its file cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("`{}` cannot be read", file.display())]
struct LostFile {
    file: PathBuf,
    source: io::Error,
}

fn list_images(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut named = Vec::new();
    for entry in fs::read_dir(folder)? {
        let file = entry?.path();
        if is_image(&file) {
            named.push((file.to_string_lossy().into_owned(), file));
        }
    }
    named.sort_by(|(a, _), (b, _)| natural_order(a, b));
    Ok(named.into_iter().map(|(_, file)| file).collect())
}

fn is_image(file: &Path) -> bool {
    file.extension().is_some_and(|found| {
        EXTENSIONS
            .iter()
            .any(|known| found.eq_ignore_ascii_case(known))
    })
}
