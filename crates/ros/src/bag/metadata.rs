//! `metadata.yaml` of a bag, layout version 5: the newest that Humble writes, and later ones read it too.
//!
//! Readers go by the version and look at no other keys. From 7 on (Iron) they want `type_description_hash`; up to 8 such
//! a file would do for Humble as well, from 9 on (Jazzy) it would not: QoS profiles are then a list, no longer a text.

use crate::{
    topics::{Retention, Topic},
    type_hash::type_hash,
};
use roadwatch_core::Timestamp;

/// What a recording holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Number of messages per topic, in the order of the list of topics.
    pub messages: Vec<u64>,
    /// Earliest and latest log time; `None` while nothing is recorded.
    pub span: Option<(Timestamp, Timestamp)>,
}

impl Summary {
    /// What several files hold together.
    pub(super) fn of(parts: &[Part]) -> Self {
        let mut whole = Self {
            messages: Vec::new(),
            span: None,
        };
        for Part { summary, .. } in parts {
            whole.messages.resize(summary.messages.len(), 0);
            for (sum, count) in whole.messages.iter_mut().zip(&summary.messages) {
                *sum += count;
            }
            whole.span = match (whole.span, summary.span) {
                (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                (a, b) => a.or(b),
            };
        }
        whole
    }

    /// Number of all messages.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.messages.iter().sum()
    }

    fn start_ns(&self) -> i64 {
        self.span.map_or(0, |(first, _)| first.as_nanos())
    }

    fn duration_ns(&self) -> u128 {
        self.span
            .map_or(0, |(first, last)| last.saturating_since(first).as_nanos())
    }
}

/// `package/msg/Type` of `package/Type`.
pub(super) fn long_type_name(ros_type: &str) -> String {
    ros_type.replacen('/', "/msg/", 1)
}

/// The topic's QoS as rosbag2 writes it: enumerators as rmw's numbers, infinite times as its largest.
pub(super) fn offered_qos(topic: &Topic) -> String {
    const INFINITE: &str = "{sec: 9223372036, nsec: 854775807}";
    let durability = match topic.kind.retention() {
        Retention::Latched => 1,
        Retention::Volatile => 2,
    };
    format!(
        "- history: 1
  depth: {depth}
  reliability: 1
  durability: {durability}
  deadline: {INFINITE}
  lifespan: {INFINITE}
  liveliness: 1
  liveliness_lease_duration: {INFINITE}
  avoid_ros_namespace_conventions: false",
        depth = topic.depth,
    )
}

/// One file of a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// Its name in the folder.
    pub(super) file_name: String,
    /// What it holds.
    pub(super) summary: Summary,
}

/// The whole file about a bag of these parts.
pub(super) fn yaml(topics: &[Topic], parts: &[Part]) -> String {
    let mut text = "rosbag2_bagfile_information:\n".to_owned();
    for line in information(topics, parts).lines() {
        text.push_str(&format!("  {line}\n"));
    }
    text
}

/// What the file says, without the key around it: so it also stands in each MCAP file, where Jazzy's reader fails on
/// that key. The only times are those of messages, so that equal recordings have equal files.
pub(super) fn information(topics: &[Topic], parts: &[Part]) -> String {
    let whole = Summary::of(parts);
    let mut topic_list = String::new();
    for (topic, count) in topics.iter().zip(&whole.messages) {
        push_topic(&mut topic_list, topic, *count);
    }
    let mut paths = String::new();
    let mut files = String::new();
    for Part { file_name, summary } in parts {
        let quoted = quoted(file_name);
        paths.push_str(&format!("  - {quoted}\n"));
        files.push_str(&format!(
            "  - path: {quoted}
    starting_time:
      nanoseconds_since_epoch: {}
    duration:
      nanoseconds: {}
    message_count: {}
",
            summary.start_ns(),
            summary.duration_ns(),
            summary.total()
        ));
    }
    format!(
        "version: 5
storage_identifier: mcap
duration:
  nanoseconds: {}
starting_time:
  nanoseconds_since_epoch: {}
message_count: {}
topics_with_message_count:
{topic_list}compression_format: \"\"
compression_mode: \"\"
relative_file_paths:
{paths}files:
{files}",
        whole.duration_ns(),
        whole.start_ns(),
        whole.total()
    )
}

fn push_topic(list: &mut String, topic: &Topic, count: u64) {
    let (name, ros_type) = (&topic.name, long_type_name(topic.kind.ros_type()));
    let qos = quoted(&offered_qos(topic));
    // A key of version 7, which `rosbags` reads in any version and `ros2 bag` not at all; Jazzy takes the hash from the
    // channels of the MCAP file.
    let hash = type_hash(topic.kind.ros_type()).unwrap_or_default();
    list.push_str(&format!(
        "  - topic_metadata:
      name: {name}
      type: {ros_type}
      serialization_format: cdr
      offered_qos_profiles: {qos}
      type_description_hash: {hash}
    message_count: {count}
"
    ));
}

/// A YAML double-quoted scalar.
fn quoted(text: &str) -> String {
    let escaped = text
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n");
    format!("\"{escaped}\"")
}
