//! The messages of one topic of a recorded bag, all at once.

use super::{
    bag_error::BagImagesError,
    bag_file::TopicReader,
    bag_images::{OneFile, files, type_of},
};
use mcap::sans_io::indexed_reader::ReadOrder;
use std::{collections::BTreeSet, path::Path};

/// The bytes of every message of a topic of one type, in order of log times.
pub(super) fn messages_of(
    path: &Path,
    topic: &str,
    ros_type: &str,
) -> Result<Vec<Vec<u8>>, BagImagesError> {
    let mut all = Vec::new();
    let mut found = None;
    let files = files(path)?;
    for file in &files {
        let Some(name) = type_of(&file.summary, topic) else {
            continue;
        };
        found = Some(name);
        if name != ros_type {
            continue;
        }
        let damaged = |source| BagImagesError::Damaged {
            path: file.path.clone(),
            source,
        };
        let mut reader = TopicReader::open(&file.path, &file.summary, topic, ReadOrder::LogTime)
            .map_err(damaged)?;
        while let Some(bytes) = reader.next().map_err(damaged)? {
            all.push(bytes);
        }
    }
    match found {
        Some(name) if name == ros_type => Ok(all),
        Some(name) => Err(BagImagesError::NotThat {
            path: path.to_owned(),
            topic: topic.to_owned(),
            found: name.to_owned(),
            expected: ros_type.to_owned(),
        }),
        None => Err(BagImagesError::NoSuch {
            path: path.to_owned(),
            topic: topic.to_owned(),
            topics: all_topics(&files),
        }),
    }
}

fn all_topics(files: &[OneFile]) -> BTreeSet<String> {
    let channels = files.iter().flat_map(|file| file.summary.channels.values());
    channels.map(|channel| channel.topic.clone()).collect()
}
