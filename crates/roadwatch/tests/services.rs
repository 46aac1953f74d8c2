//! Services of the running node, called by clients of two vendors, who say differently which answer is whose.

mod support;

use serde_json::Value;
use std::{
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};
use support::{daemon, demo, fast_dds_peer, python, root, runtime_library};

/// One per test; nobody else's on this machine, one hopes; loopback only in any case.
const DOMAINS: [&str; 2] = ["78", "79"];
const PATIENCE: Duration = Duration::from_secs(60);

/// The node, killed when the test ends.
struct Node(Child);

impl Drop for Node {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

fn start(folder: &std::path::Path, domain: &str) -> Node {
    let config = demo(folder, |text| text);
    let started = daemon(&["run", &config, "--loop"])
        .env("ROS_DOMAIN_ID", domain)
        .env("ROS_LOCALHOST_ONLY", "1")
        .stderr(Stdio::null())
        .spawn();
    Node(started.expect("starts"))
}

/// Little-endian CDR with its header, as text: `parts` are aligned already.
fn hex(parts: &[&[u8]]) -> String {
    let sample = [&[0, 1, 0, 0], &parts.concat()[..]].concat();
    sample.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(hex: &str) -> Vec<u8> {
    let digits = (0..hex.len()).step_by(2);
    digits
        .map(|at| u8::from_str_radix(&hex[at..at + 2], 16).expect("hex"))
        .collect()
}

/// What a client under Fast DDS gets for an answer.
fn call((peer, domain): (&Command, &str), service: &str, ros_type: &str, request: &str) -> Vec<u8> {
    let mut command = Command::new(peer.get_program());
    command
        .args(["call", "--domain", domain, "--seconds", "30"])
        .args(["--service", &format!("/roadwatch/{service}")])
        .args(["--type", ros_type, "--request", request]);
    let output = command.output().expect("the peer runs");
    assert!(
        output.status.success(),
        "{service}: {}",
        support::stderr(&output)
    );
    let said = support::stdout(&output);
    let last = said.lines().last().expect("an answer");
    let answer: Value = serde_json::from_str(last).expect("JSON");
    bytes(answer["reply"].as_str().expect("a reply"))
}

fn contains(bytes: &[u8], text: &str) -> bool {
    bytes
        .windows(text.len())
        .any(|window| window == text.as_bytes())
}

#[test]
fn clients_of_fast_dds_are_answered() {
    let (Some(peer), Some(_)) = (fast_dds_peer(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let domain = DOMAINS[0];
    let _node = start(folder.path(), domain);
    let peer = (&peer, domain);
    // No prefixes, any depth.
    let everything = hex(&[&[0; 4], &[0; 4], &[0; 8]]);
    let of = |name: &str| format!("rcl_interfaces::srv::dds_::{name}_");
    let listed = call(peer, "list_parameters", &of("ListParameters"), &everything);
    assert!(
        contains(&listed, "detector.score_threshold\0"),
        "{listed:?}"
    );
    // One name of six letters and the final zero.
    let one = hex(&[&[1, 0, 0, 0], &[7, 0, 0, 0], b"sesame\0\0"]);
    let types = call(peer, "get_parameter_types", &of("GetParameterTypes"), &one);
    assert_eq!(
        types[..9],
        [0, 1, 0, 0, 1, 0, 0, 0, 0],
        "a parameter that is not there is not set"
    );
    let state = call(
        peer,
        "get_state",
        "lifecycle_msgs::srv::dds_::GetState_",
        &hex(&[&[0]]),
    );
    assert!(contains(&state, "active\0"), "{state:?}");
}

#[test]
fn both_vendors_clients_are_answered_at_once() {
    let (Some(peer), Some(python), Some(_)) = (fast_dds_peer(), python(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let domain = DOMAINS[1];
    let _node = start(folder.path(), domain);
    let peer = (&peer, domain);
    let mut cyclone = Command::new(python)
        .arg("-B")
        .arg(root().join("tests/peers/cyclone_caller.py"))
        .args(["--domain", domain, "--calls", "20", "--seconds", "40"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("python runs");
    let began = Instant::now();
    let everything = hex(&[&[0; 4], &[0; 4], &[0; 8]]);
    while cyclone.try_wait().expect("runs").is_none() {
        assert!(
            began.elapsed() < PATIENCE,
            "the Cyclone client does not end"
        );
        let of = "rcl_interfaces::srv::dds_::ListParameters_";
        let listed = call(peer, "list_parameters", of, &everything);
        assert!(contains(&listed, "use_sim_time\0"));
        thread::park_timeout(Duration::from_millis(1));
    }
    let output = cyclone.wait_with_output().expect("ended");
    assert!(output.status.success());
    let said: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(said["answered"], 20, "{said}");
    assert_eq!(said["names"][0], "detector.classes");
}
