//! The whole daemon on the network: independent readers get every topic, and one that is killed
//! disturbs nobody.

mod support;

use serde_json::Value;
use std::io::Write as _;
use std::{
    io::{BufRead as _, BufReader},
    path::Path,
    process::{Child, ChildStdout, Command, Stdio},
};
use support::{daemon, pandaset_config, python, root, runtime_library, shared, write};

/// Nobody else's, so that tests beside this one are not heard.
const DOMAIN: &str = "83";
/// Messages of each topic that a reader waits for before it ends.
const EXPECTED: &str = "10";

struct Reader {
    process: Child,
    lines: BufReader<ChildStdout>,
}

impl Reader {
    fn start(python: &Path, expect: &str) -> Self {
        let cameras = [
            "front_left",
            "front",
            "front_right",
            "right",
            "back",
            "left",
        ];
        let camera_topics = [
            "objects",
            "detections_2d",
            "detections_3d",
            "markers",
            "camera_info",
        ];
        let of_camera = |camera| camera_topics.map(|name| format!("/roadwatch/{camera}/{name}"));
        let mut topics: Vec<String> = cameras.into_iter().flat_map(of_camera).collect();
        topics.extend(
            ["objects", "detections_3d", "markers"].map(|name| format!("/roadwatch/scene/{name}")),
        );
        topics.push("/tf_static".to_owned());
        let mut process = Command::new(python)
            .arg("-B")
            .arg(root().join("tests/peers/cyclone_reader.py"))
            .args([
                "--domain",
                DOMAIN,
                "--seconds",
                "90",
                "--expect",
                expect,
                "--topics",
            ])
            .arg(serde_json::to_string(&topics).expect("JSON"))
            .stdout(Stdio::piped())
            .spawn()
            .expect("python starts");
        let lines = BufReader::new(process.stdout.take().expect("its output"));
        Self { process, lines }
    }

    fn wait_for(&mut self, word: &str) {
        let mut line = String::new();
        while line.trim() != word {
            line.clear();
            let read = self.lines.read_line(&mut line).expect("a line");
            assert!(read > 0, "the reader ended before `{word}`");
        }
    }

    /// What it counted, one line per topic.
    fn counts(mut self) -> Vec<(String, u64)> {
        let lines = std::io::BufRead::lines(&mut self.lines).map(|line| line.expect("a line"));
        let counts = lines.filter_map(|line| serde_json::from_str::<Value>(&line).ok());
        let counts = counts.map(|count| {
            (
                count["topic"].as_str().expect("a topic").to_owned(),
                count["count"].as_u64().expect("a count"),
            )
        });
        let counts = counts.collect();
        self.process.wait().expect("it ends");
        counts
    }
}

#[test]
fn cyclone_readers_get_every_topic_also_late_and_after_another_was_killed() {
    let (Some(shared), Some(python), Some(_)) = (shared(), python(), runtime_library()) else {
        return;
    };
    let has_cyclone = Command::new(&python)
        .args(["-c", "import cyclonedds"])
        .status();
    if !has_cyclone.expect("python starts").success() {
        writeln!(std::io::stderr(), "SKIPPED: this Python has no cyclonedds")
            .expect("standard error");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let node = format!("domain_id = {DOMAIN}\nlocalhost_only = true");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, &node),
    );
    // Slow enough that nothing is dropped on a busy machine.
    let mut daemon = daemon(&["run", &config, "--loop", "--speed", "0.2", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the daemon starts");
    let mut survivor = Reader::start(&python, EXPECTED);
    let mut victim = Reader::start(&python, "1000000");
    survivor.wait_for("matched");
    victim.wait_for("matched");
    victim.process.kill().expect("SIGKILL");
    victim.process.wait().expect("it ends");
    let late = Reader::start(&python, "2");
    for (who, least, counts) in [
        ("survivor", 10, survivor.counts()),
        ("late", 2, late.counts()),
    ] {
        assert_eq!(counts.len(), 34, "{who}");
        for (topic, count) in counts {
            // The one message of /tf_static is there for whoever comes later too.
            let expected = if topic == "/tf_static" { 1 } else { least };
            assert!(count >= expected, "{who}: {count} messages on {topic}");
        }
    }
    let terminated = Command::new("kill")
        .args(["-TERM", &daemon.id().to_string()])
        .status();
    assert!(terminated.expect("kill starts").success());
    let mut report = String::new();
    std::io::Read::read_to_string(&mut daemon.stdout.take().expect("its output"), &mut report)
        .expect("text");
    assert!(
        daemon.wait().expect("it ends").success(),
        "a stop by signal is a success"
    );
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["sinks"]["ros2"]["failed"], 0);
    assert_eq!(report["sinks"]["ros2"]["dropped"], 0);
}
