//! What feeds a camera.

use super::reader::Reader;
use roadwatch_camera::FrameRate;
use roadwatch_core::Timestamp;
use std::path::PathBuf;

/// What feeds a camera.
#[derive(Debug, Clone, PartialEq)]
pub enum SourceConfig {
    /// The camera of this index in the rig dataset.
    Dataset(usize),
    /// A folder of images.
    Images {
        /// The folder.
        folder: PathBuf,
        /// Frames per second.
        rate: FrameRate,
        /// Stamp of the first; `None` for the rig's own beginning.
        start: Option<Timestamp>,
    },
    /// A video file.
    Video {
        /// The file.
        file: PathBuf,
        /// Stamp of the first frame; `None` for the rig's own beginning.
        start: Option<Timestamp>,
    },
}

/// The `images` or `video` that a table names; `None` when there is a mistake, which is noted.
pub(super) fn read(table: &Reader<'_, '_>) -> Option<SourceConfig> {
    let start = match table.text("start_stamp") {
        None => None,
        Some(text) => match text.parse() {
            Ok(start) => Some(start),
            Err(error) => {
                table.note("start_stamp", format!("{error}"));
                return None;
            }
        },
    };
    let rate_hz = table.number("rate_hz", 0.001..=1000.0);
    match (table.path("images"), table.path("video")) {
        (Some(folder), None) => {
            let Some(rate) = rate_hz.and_then(FrameRate::from_hz) else {
                table.note("rate_hz", "missing: frames per second of the images");
                return None;
            };
            Some(SourceConfig::Images {
                folder,
                rate,
                start,
            })
        }
        (None, Some(file)) => {
            if rate_hz.is_some() {
                table.note("rate_hz", "is for images; a video has its own");
            }
            Some(SourceConfig::Video { file, start })
        }
        (Some(_), Some(_)) => {
            table.note("video", "a camera has one source: `images` or `video`");
            None
        }
        (None, None) => {
            table.note(
                "images",
                "missing: name a folder of `images` or a `video` file",
            );
            None
        }
    }
}
