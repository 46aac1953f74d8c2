//! Readers that know nothing of this project read its bags with the schemas inside.

mod common;
#[path = "common/python.rs"]
mod python;

use roadwatch_core::Sink;
use roadwatch_ros::{BagOptions, BagSink, LogTime, Surface};
use serde_json::{Value, json};
use std::sync::Arc;

const ROUNDS: i64 = 3;

#[test]
fn rosbags_and_mcap_read_every_message_and_agree() {
    let Some(mut reader) = python::peer("read_bag.py", "rosbags, mcap_ros2") else {
        return;
    };
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = scratch.path().join("drive");
    let rig = Arc::new(common::two_cameras());
    let mut bag = BagSink::create(
        &folder,
        rig,
        &Surface::default(),
        BagOptions::new(LogTime::Stamp),
    )
    .expect("created");
    for output in (0..ROUNDS).flat_map(common::outputs) {
        bag.publish(&output).expect("recorded");
    }
    bag.finish().expect("finished");

    let output = reader.arg(&folder).output().expect("python runs");
    let complaint = String::from_utf8_lossy(&output.stderr);
    let read: Value = serde_json::from_slice(&output.stdout).expect(&complaint);
    assert!(output.status.success(), "{complaint}{read}");
    assert_eq!(read["agree"], true);
    assert_eq!(read["message_count"], 1 + 13 * ROUNDS);
    let topics = &read["rosbags"];
    assert_eq!(
        topics["/roadwatch/front/objects"],
        json!({
            "type": "roadwatch_msgs/msg/ObjectArray",
            "count": ROUNDS,
            "stamps": [
                "1557539956.439383000",
                "1557539956.539383000",
                "1557539956.639383000",
            ],
            "frames": ["base_link"],
            "objects": [2, 2, 2],
            "offered_qos": {"durability": "volatile", "reliability": "reliable", "depth": 5},
        })
    );
    assert_eq!(
        topics["/roadwatch/front/detections_2d"]["frames"],
        json!(["front_optical_frame"])
    );
    assert_eq!(
        topics["/roadwatch/rear/detections_3d"]["objects"],
        json!([0, 0, 0])
    );
    let tf = &topics["/tf_static"];
    assert_eq!((&tf["count"], &tf["objects"]), (&json!(1), &json!([2])));
    assert_eq!(tf["offered_qos"]["durability"], "transient_local");
}
