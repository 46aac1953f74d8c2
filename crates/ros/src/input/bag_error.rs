//! Why a bag cannot be a source.

use mcap::McapError;
use std::{collections::BTreeSet, io, path::PathBuf};

pub(super) const RAW: &str = "sensor_msgs/msg/Image";
pub(super) const COMPRESSED: &str = "sensor_msgs/msg/CompressedImage";

/// A bag that does not give what was asked of it.
#[derive(Debug, thiserror::Error)]
pub enum BagImagesError {
    /// Neither a file nor a folder with files.
    #[error("`{}` is no bag: expected an .mcap file, or a folder with some", .0.display())]
    NoBag(PathBuf),
    /// The folder cannot be read.
    #[error("`{}` cannot be read", path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is damaged.
    #[error("`{}` cannot be read as MCAP", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: McapError,
    },
    /// The recording was not finished.
    #[error("`{}` has no index: it was not finished; `mcap recover` makes one", .0.display())]
    NotFinished(PathBuf),
    /// No such topic.
    #[error("`{}` has no images on `{topic}`; its image topics: {}", path.display(), listed(topics))]
    NoTopic {
        /// The bag.
        path: PathBuf,
        /// What was asked for.
        topic: String,
        /// What there is.
        topics: BTreeSet<String>,
    },
    /// No such topic of any kind.
    #[error("`{}` has no `{topic}`; it has {}", path.display(), listed(topics))]
    NoSuch {
        /// The bag.
        path: PathBuf,
        /// What was asked for.
        topic: String,
        /// What there is.
        topics: BTreeSet<String>,
    },
    /// The topic carries something else than was asked for.
    #[error("`{topic}` of `{}` is {found}, not {expected}", path.display())]
    NotThat {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// What it carries.
        found: String,
        /// What was asked for.
        expected: String,
    },
    /// The topic tells of other things than the vehicle.
    #[error("`{topic}` of `{}` does not say where the vehicle is: {why}", path.display())]
    TellsNothing {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// What it tells instead.
        why: String,
    },
    /// The topic carries something else.
    #[error("`{topic}` of `{}` is {found}, not {RAW} or {COMPRESSED}", path.display())]
    OtherType {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// What it carries.
        found: String,
    },
}

fn listed(topics: &BTreeSet<String>) -> String {
    match topics.is_empty() {
        true => "none".to_owned(),
        false => topics.iter().cloned().collect::<Vec<_>>().join(", "),
    }
}
