//! One reader is suspended for ten seconds: does the other one, or the publisher, notice?
//!
//! Six cameras publish `objects` with a hundred objects each at 50 Hz to two readers on Fast DDS that count bytes.
//! Printed are what the free reader lost, how long publishing took, and the publisher's memory before, during, after.
//! It needs the peer that `./dev test` compiles.

#[expect(dead_code, reason = "the rig's outputs are made here")]
#[path = "../tests/common/mod.rs"]
mod common;

use roadwatch_core::{CameraId, Output, Rig, Sink as _, Timestamp};
use roadwatch_ros::{Network, Outlets, PublishOptions, RosNode, RosOptions, RosSink, Surface};
use std::{
    fs,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

const DOMAIN_ID: u16 = 75;
const CAMERAS: [&str; 6] = [
    "front",
    "front_left",
    "front_right",
    "back",
    "left",
    "right",
];
const OBJECTS: u64 = 100;
const PERIOD: Duration = Duration::from_millis(20);
/// Before, while and after one reader is suspended.
const PHASES: [(&str, u32); 3] = [("both read", 5), ("one suspended", 10), ("both again", 5)];
/// How long readers may take to find the publisher, and to read the last messages.
const SPARE_SECS: u32 = 15;

struct Reader(Child);

impl Reader {
    fn start(peer: &Path) -> Self {
        let topics = CAMERAS
            .map(|camera| format!("/roadwatch/{camera}/objects"))
            .join(",");
        let seconds = PHASES.iter().map(|(_, secs)| secs).sum::<u32>() + SPARE_SECS;
        let child = Command::new(peer)
            .args([
                "read",
                "--domain",
                &DOMAIN_ID.to_string(),
                "--topic",
                &topics,
            ])
            .args(["--type", "roadwatch_msgs::msg::dds_::ObjectArray_"])
            .args(["--seconds", &seconds.to_string()])
            .stdout(Stdio::piped())
            .spawn();
        Self(child.expect("the peer starts"))
    }

    fn signal(&self, signal: &str) {
        let sent = Command::new("kill")
            .args([signal, &self.0.id().to_string()])
            .status();
        assert!(sent.is_ok_and(|status| status.success()), "signal {signal}");
    }

    /// Messages and bytes, when it ends.
    fn report(mut self) -> (u64, u64) {
        let lines = BufReader::new(self.0.stdout.take().expect("piped")).lines();
        let reports = lines
            .map_while(Result::ok)
            .filter(|line| line.starts_with('{'));
        let (mut messages, mut bytes) = (0, 0);
        for line in reports {
            let report: serde_json::Value = serde_json::from_str(&line).expect("JSON");
            messages += report["count"].as_u64().expect("a count");
            bytes += report["bytes"].as_u64().expect("a size");
        }
        self.0.wait().expect("ended");
        (messages, bytes)
    }
}

/// Resident memory of this process, MiB.
fn memory_mib() -> f64 {
    let status = fs::read_to_string("/proc/self/status").expect("status");
    let line = status
        .lines()
        .find(|line| line.starts_with("VmRSS:"))
        .expect("VmRSS");
    let kib: f64 = line
        .split_whitespace()
        .nth(1)
        .and_then(|n| n.parse().ok())
        .expect("a size");
    kib / 1024.0
}

fn six_cameras() -> Rig {
    let turned = |(at, name): (usize, &&str)| {
        common::camera(name, at as f64, 1.0, roadwatch_core::Distortion::None)
    };
    Rig::new(CAMERAS.iter().enumerate().map(turned).collect(), 0.0).expect("six names")
}

/// What every camera sees in one round.
fn round(number: i64) -> Vec<Output> {
    let stamp = Timestamp::from_nanos(common::START_NS + number * 20_000_000);
    let objects: Vec<_> = (0..OBJECTS)
        .map(|id| common::track(id, "car", Some(0.5)))
        .collect();
    let cameras = 0..CAMERAS.len() as u8;
    cameras
        .map(|id| common::of_camera(CameraId(id).0, number, stamp, objects.clone()))
        .collect()
}

/// What publishing one phase was like.
struct Phase {
    took: Vec<Duration>,
    refused: u64,
}

impl Phase {
    fn run(sink: &mut RosSink, rounds: std::ops::Range<i64>) -> Self {
        let mut phase = Self {
            took: Vec::new(),
            refused: 0,
        };
        let began = Instant::now();
        for (at, number) in (1..).zip(rounds) {
            for output in round(number) {
                let before = Instant::now();
                let published = sink.publish(&output);
                phase.took.push(before.elapsed());
                phase.refused += u64::from(published.is_err());
            }
            let next = began + PERIOD * at;
            thread::park_timeout(next.saturating_duration_since(Instant::now()));
        }
        phase.took.sort();
        phase
    }

    fn ms(&self, share: f64) -> f64 {
        let at = (self.took.len() - 1) as f64 * share;
        self.took[at as usize].as_secs_f64() * 1e3
    }
}

fn main() {
    let peer = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../.cache/fastdds_peer");
    if !peer.is_file() {
        println!(
            "SKIPPED: {} is not there; ./dev test compiles it",
            peer.display()
        );
        return;
    }
    let options = RosOptions {
        surface: Surface::default(),
        domain_id: DOMAIN_ID,
        network: Network::LocalhostOnly,
    };
    let node = RosNode::start(&options, Vec::new()).expect("started");
    let (rig, stamp) = (Arc::new(six_cameras()), Timestamp::from_nanos(1));
    let outlets = Outlets::announce(&node, rig, PublishOptions::default(), stamp);
    let mut sink = RosSink(outlets.expect("announced"));
    let (free, suspended) = (Reader::start(&peer), Reader::start(&peer));
    let read_twice = |camera: &&str| node.readers_of(&format!("/roadwatch/{camera}/objects")) == 2;
    while !CAMERAS.iter().all(read_twice) {
        thread::park_timeout(PERIOD);
    }
    // Until both sides have matched, not only found each other.
    thread::park_timeout(Duration::from_secs(1));

    let (mut sent, mut refused, mut number) = (0, 0, 0);
    println!(
        "{:<16}{:>12}{:>12}{:>12}{:>14}",
        "phase", "p50 ms", "p99 ms", "max ms", "memory MiB"
    );
    for (name, secs) in PHASES {
        match name {
            "one suspended" => suspended.signal("-STOP"),
            "both again" => suspended.signal("-CONT"),
            _ => {}
        }
        let rounds = number..number + i64::from(secs) * 50;
        number = rounds.end;
        let phase = Phase::run(&mut sink, rounds);
        let [p50, p99, max] = [0.5, 0.99, 1.0].map(|share| phase.ms(share));
        println!(
            "{name:<16}{p50:>12.2}{p99:>12.2}{max:>12.2}{:>14.1}",
            memory_mib()
        );
        sent += phase.took.len();
        refused += phase.refused;
    }
    let (messages, bytes) = free.report();
    let (late, _) = suspended.report();
    println!("sent {sent}, not taken by the middleware {refused}");
    println!("the free reader got {messages} messages, {bytes} bytes; the suspended one {late}");
}
