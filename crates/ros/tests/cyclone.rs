//! CycloneDDS, in processes of its own, receives every topic of the node; one reader's death disturbs
//! nobody.

mod common;
#[path = "common/python.rs"]
mod python;

use roadwatch_core::{Rig, Sink, Timestamp};
use roadwatch_ros::{Network, Outlets, PublishOptions, RosNode, RosOptions, RosSink, Surface};
use serde_json::Value;
use std::{
    io::{BufRead, BufReader, Lines},
    process::{Child, ChildStdout, Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

/// Nobody else's on this machine, one hopes; loopback only in any case.
const DOMAIN_ID: u16 = 77;
const ROUNDS: i64 = 50;
/// Rounds within which writer and reader have met on a busy machine.
const ROUNDS_TO_MEET: i64 = 10;
/// The round after which one of the two readers is killed.
const KILLED_AFTER: i64 = 20;
/// Between two rounds, as cameras have it.
const INTERVAL: Duration = Duration::from_millis(20);
const PATIENCE: Duration = Duration::from_secs(40);

struct Reader {
    process: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Reader {
    /// Starts a reader of `topics` that ends by itself when all have come.
    fn start(mut command: Command, topics: &[&str]) -> Self {
        let mut process = command
            .args(["--domain", &DOMAIN_ID.to_string()])
            .args(["--seconds", &PATIENCE.as_secs().to_string()])
            .args(["--expect", &ROUNDS.to_string()])
            .args(["--topics", &serde_json::to_string(topics).expect("names")])
            .stdout(Stdio::piped())
            .spawn()
            .expect("python runs");
        let stdout = process.stdout.take().expect("piped");
        Self {
            process,
            lines: BufReader::new(stdout).lines(),
        }
    }

    fn wait_for(&mut self, line: &str) {
        let found = self
            .lines
            .by_ref()
            .map_while(Result::ok)
            .any(|said| said == line);
        assert!(found, "the reader ended before it said `{line}`");
    }

    /// What it says in the end, one value per topic.
    fn report(mut self) -> Vec<Value> {
        let report = self
            .lines
            .map_while(Result::ok)
            .map(|line| serde_json::from_str(&line).expect("JSON"))
            .collect();
        assert!(self.process.wait().expect("ended").success());
        report
    }
}

fn options() -> RosOptions {
    RosOptions {
        surface: Surface::default(),
        domain_id: DOMAIN_ID,
        network: Network::LocalhostOnly,
    }
}

fn rig() -> Arc<Rig> {
    Arc::new(common::two_cameras())
}

/// Until the node, too, knows of `count` readers on every topic.
fn wait_for_readers(node: &RosNode, topics: &[&str], count: usize) {
    let deadline = Instant::now() + PATIENCE;
    while topics.iter().any(|topic| node.readers_of(topic) < count) {
        assert!(Instant::now() < deadline, "readers not discovered");
        thread::park_timeout(INTERVAL);
    }
}

/// Everything from the first message to the last round's arrived once and in order. The first messages may
/// be missing: a volatile writer owes nothing to a reader that it has not met yet.
fn assert_no_gap(topic: &Value, name: &str) {
    let stamps = topic["stamps"].as_array().expect("stamps").iter();
    let stamps: Vec<i64> = stamps
        .map(|stamp| {
            stamp
                .as_str()
                .expect("text")
                .replace('.', "")
                .parse()
                .expect("nanoseconds")
        })
        .collect();
    let late = ROUNDS - i64::try_from(stamps.len()).expect("a count");
    assert!(
        (0..=ROUNDS_TO_MEET).contains(&late),
        "{name}: {late} of {ROUNDS} rounds missing"
    );
    for (before, after) in stamps.iter().zip(&stamps[1..]) {
        assert_eq!(
            after - before,
            common::INTERVAL_NS,
            "{name}: a gap after {before}"
        );
    }
    assert_eq!(
        (stamps[0] - common::START_NS) / common::INTERVAL_NS,
        late,
        "{name}: the last are missing"
    );
}

#[test]
fn every_topic_arrives_and_a_killed_reader_disturbs_nobody() {
    let peer = || python::peer("cyclone_reader.py", "cyclonedds");
    let (Some(first), Some(second)) = (peer(), peer()) else {
        return;
    };
    // `/tf_static` is published here, before anybody listens.
    let node = RosNode::start(&options(), Vec::new()).expect("started");
    let (publishing, stamp) = (PublishOptions::default(), Timestamp::from_nanos(7));
    let outlets = Outlets::announce(&node, rig(), publishing, stamp).expect("announced");
    let names: Vec<String> = outlets
        .topics()
        .iter()
        .map(|topic| topic.name.clone())
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (mut doomed, mut survivor) = (Reader::start(first, &names), Reader::start(second, &names));
    doomed.wait_for("matched");
    survivor.wait_for("matched");
    wait_for_readers(&node, &names, 2);
    let mut sink = RosSink(outlets);

    for round in 0..ROUNDS {
        for output in common::outputs(round) {
            sink.publish(&output).expect("published");
        }
        if round == KILLED_AFTER {
            doomed.process.kill().expect("killed");
            doomed.process.wait().expect("ended");
        }
        thread::park_timeout(INTERVAL);
    }

    let report = survivor.report();
    assert_eq!(report.len(), names.len());
    for (topic, name) in report.iter().zip(&names) {
        assert_eq!(topic["topic"], **name);
        if *name == "/tf_static" {
            assert_eq!(topic["count"], 1);
        } else {
            assert_no_gap(topic, name);
        }
    }
    assert_eq!(report[0]["stamps"][0], "0.000000007");
    assert_eq!(report[0]["objects"][0], 2);
    assert_eq!(report[1]["stamps"][0], "1557539956.439383000");
}

#[test]
fn a_domain_that_dds_does_not_have_is_refused() {
    let beyond = RosOptions {
        domain_id: 233,
        ..options()
    };
    let error = RosNode::start(&beyond, Vec::new()).expect_err("refused");
    assert_eq!(
        error.to_string(),
        "domain id 233 is out of range: DDS has the domains 0 to 232"
    );
}
