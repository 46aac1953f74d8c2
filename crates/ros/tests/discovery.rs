//! The node is announced as ROS 2's tools expect it: with ids of 24 bytes until Humble, of 16 from Iron on.

#[expect(dead_code, reason = "only the rig is needed here")]
mod common;
#[path = "common/python.rs"]
mod python;

use roadwatch_core::Timestamp;
use roadwatch_ros::{Network, Outlets, PublishOptions, RosNode, RosOptions, Surface};
use std::sync::Arc;

/// Nobody else's on this machine, one hopes; loopback only in any case.
const DOMAIN_ID: u16 = 76;
const GID_LENGTH: usize = if cfg!(feature = "jazzy") { 16 } else { 24 };

#[test]
fn the_node_is_found_with_everything_it_writes() {
    let Some(mut peer) = python::peer("cyclone_nodes.py", "cyclonedds") else {
        return;
    };
    let options = RosOptions {
        surface: Surface {
            namespace: "/one".to_owned(),
            ..Surface::default()
        },
        domain_id: DOMAIN_ID,
        network: Network::LocalhostOnly,
    };
    let node = RosNode::start(&options, Vec::new()).expect("started");
    let rig = Arc::new(common::two_cameras());
    let stamp = Timestamp::from_nanos(1);
    let outlets =
        Outlets::announce(&node, rig, PublishOptions::default(), stamp).expect("announced");
    let output = peer
        .args([
            "--domain",
            &DOMAIN_ID.to_string(),
            "--node",
            "/one/roadwatch",
        ])
        .args(["--gid-length", &GID_LENGTH.to_string()])
        .output()
        .expect("python runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    // The library's own besides: discovery, parameter events.
    let expected = outlets.topics().len() as u64 + 2;
    assert_eq!(found["writers"].as_u64(), Some(expected), "{found}");
}
