//! `metadata.yaml` of a bag, layout version 5: the newest that Humble reads, and Jazzy reads it too.

use crate::topics::{Retention, Topic};
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

/// The whole file. Its only times are those of messages, so that equal recordings have equal files.
pub(super) fn yaml(file_name: &str, topics: &[Topic], summary: &Summary) -> String {
    let mut topic_list = String::new();
    for (topic, count) in topics.iter().zip(&summary.messages) {
        push_topic(&mut topic_list, topic, *count);
    }
    let (start, duration, total) = (summary.start_ns(), summary.duration_ns(), summary.total());
    format!(
        "rosbag2_bagfile_information:
  version: 5
  storage_identifier: mcap
  duration:
    nanoseconds: {duration}
  starting_time:
    nanoseconds_since_epoch: {start}
  message_count: {total}
  topics_with_message_count:
{topic_list}  compression_format: \"\"
  compression_mode: \"\"
  relative_file_paths:
    - {quoted}
  files:
    - path: {quoted}
      starting_time:
        nanoseconds_since_epoch: {start}
      duration:
        nanoseconds: {duration}
      message_count: {total}
",
        quoted = quoted(file_name),
    )
}

fn push_topic(list: &mut String, topic: &Topic, count: u64) {
    let (name, ros_type) = (&topic.name, long_type_name(topic.kind.ros_type()));
    let qos = quoted(&offered_qos(topic));
    list.push_str(&format!(
        "    - topic_metadata:
        name: {name}
        type: {ros_type}
        serialization_format: cdr
        offered_qos_profiles: {qos}
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
