//! A bag is a folder that others can read, the same for the same input, and says so when it cannot be.

mod common;

use roadwatch_core::{Sink, Timestamp};
use roadwatch_ros::{BagError, BagOptions, BagSink, LogTime, Messages, Surface, bag::Summary};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
    sync::Arc,
};
use tempfile::TempDir;

const ROUNDS: i64 = 3;

/// Records three rounds into `folder`.
fn record(folder: &Path, log_time: LogTime) -> Summary {
    let rig = Arc::new(common::two_cameras());
    let mut bag = BagSink::create(folder, rig, &Surface::default(), BagOptions::new(log_time))
        .expect("created");
    for output in (0..ROUNDS).flat_map(common::outputs) {
        bag.publish(&output).expect("recorded");
    }
    bag.finish().expect("finished");
    bag.summary()
}

fn scratch() -> TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

fn read(path: &Path) -> Vec<u8> {
    fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_message_is_there_in_order_with_its_schema() {
    let scratch = scratch();
    let folder = scratch.path().join("drive");
    record(&folder, LogTime::Stamp);
    let file = read(&folder.join("drive_0.mcap"));
    let read: Vec<_> = mcap::MessageStream::new(&file)
        .expect("an MCAP file")
        .collect::<Result<_, _>>()
        .expect("every message");
    let messages =
        Messages::new(Arc::new(common::two_cameras()), &Surface::default()).expect("legal");
    let topics: Vec<&str> = messages
        .topics()
        .iter()
        .map(|topic| topic.name.as_str())
        .collect();
    let recorded: Vec<&str> = read
        .iter()
        .map(|message| message.channel.topic.as_str())
        .collect();
    let expected: Vec<&str> = std::iter::once(topics[0])
        .chain((0..ROUNDS).flat_map(|_| topics[1..].iter().copied()))
        .collect();
    assert_eq!(recorded, expected);
    for message in &read {
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert_eq!(schema.encoding, "ros2msg");
        assert_eq!(message.data[..4], [0, 1, 0, 0]);
        assert_eq!(message.log_time, message.publish_time);
    }
    assert_eq!(read[1].log_time, 1_557_539_956_439_383_000);
}

#[test]
fn the_summary_counts_every_message_and_topic() {
    let scratch = scratch();
    let folder = scratch.path().join("drive");
    let summary = record(&folder, LogTime::Stamp);
    let file = read(&folder.join("drive_0.mcap"));
    let index = mcap::Summary::read(&file)
        .expect("readable")
        .expect("a summary");
    let stats = index.stats.expect("statistics");
    assert_eq!(stats.message_count, summary.total());
    assert_eq!(stats.message_count, 1 + 13 * ROUNDS as u64);
    let topics: BTreeSet<_> = index
        .channels
        .values()
        .map(|channel| channel.topic.clone())
        .collect();
    assert_eq!(topics.len(), 14);
    let latched: BTreeMap<_, _> = index
        .channels
        .values()
        .map(|channel| {
            let qos = &channel.metadata["offered_qos_profiles"];
            (channel.topic.as_str(), qos.contains("durability: 1"))
        })
        .collect();
    assert_eq!(latched.iter().filter(|(_, latched)| **latched).count(), 1);
    assert!(latched["/tf_static"]);
}

#[test]
fn each_file_says_what_is_in_it_in_the_words_of_the_yaml_file() {
    let scratch = scratch();
    let folder = scratch.path().join("drive");
    record(&folder, LogTime::Stamp);
    let file = read(&folder.join("drive_0.mcap"));
    let index = mcap::Summary::read(&file)
        .expect("readable")
        .expect("a summary");
    // One at the beginning, for recordings that are killed, and one at the end, which counts.
    assert_eq!(index.metadata_indexes.len(), 2);
    let record = mcap::read::metadata(&file, &index.metadata_indexes[1]).expect("a record");
    let within = &record.metadata["serialized_metadata"];
    // rosbag2 looks for the version at the top of it, and throws when it is not there.
    assert!(within.starts_with("version: 5\n"), "{within}");
    let indented: String = within.lines().map(|line| format!("  {line}\n")).collect();
    let beside = read(&folder.join("metadata.yaml"));
    let expected = format!("rosbag2_bagfile_information:\n{indented}");
    assert_eq!(String::from_utf8_lossy(&beside), expected);
    for channel in index.channels.values() {
        let hash = &channel.metadata["topic_type_hash"];
        assert!(hash.starts_with("RIHS01_"), "{}", channel.topic);
        assert!(within.contains(hash.as_str()), "{}", channel.topic);
    }
}

#[test]
fn two_recordings_of_the_same_outputs_are_byte_identical() {
    let (one, other) = (scratch(), scratch());
    for scratch in [&one, &other] {
        record(&scratch.path().join("drive"), LogTime::Stamp);
    }
    for name in ["drive_0.mcap", "metadata.yaml"] {
        let path = |scratch: &TempDir| scratch.path().join("drive").join(name);
        assert_eq!(read(&path(&one)), read(&path(&other)), "{name}");
    }
}

#[test]
fn a_wall_clock_gives_the_log_times() {
    let scratch = scratch();
    let folder = scratch.path().join("drive");
    let clock = || Timestamp::from_nanos(42);
    let summary = record(&folder, LogTime::WallClock(Box::new(clock)));
    assert_eq!(summary.span, Some((clock(), clock())));
}

#[test]
fn a_recording_that_is_dropped_is_finished() {
    let scratch = scratch();
    let folder = scratch.path().join("drive");
    let rig = Arc::new(common::two_cameras());
    let mut bag = BagSink::create(
        &folder,
        rig,
        &Surface::default(),
        BagOptions::new(LogTime::Stamp),
    )
    .expect("created");
    bag.publish(&common::outputs(0)[0]).expect("recorded");
    drop(bag);
    let file = read(&folder.join("drive_0.mcap"));
    let index = mcap::Summary::read(&file)
        .expect("readable")
        .expect("a summary");
    assert_eq!(index.stats.expect("statistics").message_count, 6);
    assert!(folder.join("metadata.yaml").exists());
}

#[test]
fn a_folder_with_somebody_elses_files_is_refused() {
    let scratch = scratch();
    fs::write(scratch.path().join("notes.txt"), "mine").expect("written");
    let rig = Arc::new(common::two_cameras());
    let refused = BagSink::create(
        scratch.path(),
        rig,
        &Surface::default(),
        BagOptions::new(LogTime::Stamp),
    );
    let error = refused.expect_err("refused");
    assert!(matches!(error, BagError::NotEmpty(_)));
    assert!(
        error
            .to_string()
            .ends_with("exists and is not empty: choose another folder or remove it")
    );
}

#[test]
fn a_path_that_cannot_be_a_folder_is_refused() {
    let scratch = scratch();
    let file = scratch.path().join("file");
    fs::write(&file, "not a folder").expect("written");
    for path in [file.clone(), file.join("below"), "/proc/nowhere/bag".into()] {
        let rig = Arc::new(common::two_cameras());
        let refused = BagSink::create(
            &path,
            rig,
            &Surface::default(),
            BagOptions::new(LogTime::Stamp),
        );
        let error = refused.expect_err("refused");
        assert!(matches!(error, BagError::Folder { .. }), "{error}");
        assert!(
            error.to_string().contains(&*path.to_string_lossy()),
            "{error}"
        );
    }
}
