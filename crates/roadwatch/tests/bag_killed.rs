//! A daemon that is killed while it records leaves a bag that others open, without more than its last second.

mod support;

use std::{
    fs,
    path::Path,
    process::Stdio,
    thread,
    time::{Duration, Instant},
};
use support::{daemon, demo, peer_json, python, runtime_library};

const PATIENCE: Duration = Duration::from_secs(60);
/// More than fits the first second of six cameras, so that some of it was flushed later.
const ENOUGH: u64 = 300;

/// `message_count` of the whole bag; `None` while there is no such file.
fn counted(metadata: &Path) -> Option<u64> {
    let text = fs::read_to_string(metadata).ok()?;
    let line = text
        .lines()
        .find(|line| line.starts_with("  message_count: "))?;
    line.rsplit(' ').next()?.parse().ok()
}

#[test]
fn what_was_recorded_until_the_last_second_is_there_and_opens() {
    let (Some(python), Some(_)) = (python(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let silent = |text: String| text.replacen("[node]", "[node]\npublish = false", 1);
    let config = demo(folder.path(), silent);
    let bag = folder.path().join("drive");
    let mut running = daemon(&[
        "run",
        &config,
        "--loop",
        "--bag",
        &bag.display().to_string(),
    ])
    .stderr(Stdio::null())
    .spawn()
    .expect("starts");
    let metadata = bag.join("metadata.yaml");
    let until = Instant::now() + PATIENCE;
    while counted(&metadata).is_none_or(|count| count < ENOUGH) {
        assert!(Instant::now() < until, "nothing recorded");
        thread::park_timeout(Duration::from_millis(20));
    }
    // SIGKILL.
    running.kill().expect("killed");
    running.wait().expect("ended");

    let promised = counted(&metadata).expect("metadata");
    let bytes = fs::read(bag.join("drive_0.mcap")).expect("a file");
    let options = mcap::read::Options::IgnoreEndMagic.into();
    let stream = mcap::MessageStream::new_with_options(&bytes, options).expect("the beginning");
    let readable = stream.take_while(Result::is_ok).count() as u64;
    assert!(readable >= promised, "{readable} of {promised} messages");

    let folder = bag.display().to_string();
    let read = peer_json(&python, "open_killed_bag.py", &[&folder]);
    assert!(
        read["rosbags"].as_u64() >= Some(promised),
        "{read}, promised {promised}"
    );
    assert!(
        read["mcap"].as_u64() >= Some(promised),
        "{read}, promised {promised}"
    );
}
