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
    /// An image topic of a recorded bag, with the stamps it has there.
    Bag {
        /// An `.mcap` file, or the folder of a recording.
        bag: PathBuf,
        /// The topic.
        topic: String,
    },
    /// An image topic.
    Topic {
        /// Where its images come.
        images: String,
        /// Where its `CameraInfo` comes.
        info: Option<String>,
    },
}

/// The keys that name a source; a `bag` comes with a `topic`.
const SOURCES: [&str; 3] = ["images", "video", "topic"];
/// What belongs to one kind of source only.
const EXTRAS: [&str; 4] = ["rate_hz", "start_stamp", "bag", "camera_info_topic"];

/// The one source that a table names; `None` when there is a mistake, which is noted.
pub(super) fn read(table: &Reader<'_, '_>) -> Option<SourceConfig> {
    for key in SOURCES.into_iter().chain(EXTRAS) {
        table.mark_read(key);
    }
    let named: Vec<_> = SOURCES.into_iter().filter(|key| table.has(key)).collect();
    match named[..] {
        ["images"] => read_images(table),
        ["video"] => {
            note_strays(table, &["start_stamp"]);
            Some(SourceConfig::Video {
                file: table.path("video")?,
                start: read_start(table).ok()?,
            })
        }
        ["topic"] => read_topic(table),
        [] if table.has("bag") => {
            table.note("topic", "missing: the image topic of the bag");
            None
        }
        [] => {
            table.note(
                "images",
                "missing: name a folder of `images`, a `video` file, or an image `topic`, of a `bag` or live",
            );
            None
        }
        [.., last] => {
            table.note(
                last,
                "a camera has one source: `images`, `video` or `topic`",
            );
            None
        }
    }
}

fn read_images(table: &Reader<'_, '_>) -> Option<SourceConfig> {
    note_strays(table, &["rate_hz", "start_stamp"]);
    let rate_hz = table.number("rate_hz", 0.001..=1000.0);
    let Some(rate) = rate_hz.and_then(FrameRate::from_hz) else {
        table.note("rate_hz", "missing: frames per second of the images");
        return None;
    };
    Some(SourceConfig::Images {
        folder: table.path("images")?,
        rate,
        start: read_start(table).ok()?,
    })
}

/// Images of a topic have stamps of their own.
fn read_topic(table: &Reader<'_, '_>) -> Option<SourceConfig> {
    let topic = table.text("topic")?.to_owned();
    if table.has("bag") {
        note_strays(table, &["bag"]);
        let bag = table.path("bag")?;
        return Some(SourceConfig::Bag { bag, topic });
    }
    note_strays(table, &["camera_info_topic"]);
    Some(SourceConfig::Topic {
        images: topic,
        info: table.text("camera_info_topic").map(str::to_owned),
    })
}

/// The stamp of the first frame, if the table says one; an error when it is none, which is noted.
fn read_start(table: &Reader<'_, '_>) -> Result<Option<Timestamp>, ()> {
    let start = table.text("start_stamp").map(str::parse::<Timestamp>);
    start
        .transpose()
        .map_err(|error| table.note("start_stamp", error.to_string()))
}

/// Notes keys that belong to another kind of source than this one, which has `wanted`.
fn note_strays(table: &Reader<'_, '_>, wanted: &[&str]) {
    let strays = EXTRAS.into_iter().filter(|key| !wanted.contains(key));
    for key in strays.filter(|key| table.has(key)) {
        let why = match key {
            "rate_hz" => "is for images; videos and topics have their own",
            "start_stamp" => {
                "is for images and videos; the images of a topic have stamps of their own"
            }
            "bag" => "is for a `topic`",
            _ => "is for a live `topic`",
        };
        table.note(key, why);
    }
}
