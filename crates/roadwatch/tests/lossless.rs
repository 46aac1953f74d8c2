//! Lossless runs over the real drive: everything recorded, stamps to the digit, the same bytes twice.

mod support;

use serde_json::Value;
use std::{fs, path::Path};
use support::{pandaset_config, peer_json, python, run_well, runtime_library, shared, write};

const CAMERAS: [&str; 6] = [
    "front_left",
    "front",
    "front_right",
    "right",
    "back",
    "left",
];
const CAMERA_TOPICS: [&str; 5] = [
    "objects",
    "detections_2d",
    "detections_3d",
    "markers",
    "camera_info",
];
const SCENE_TOPICS: [&str; 3] = ["objects", "detections_3d", "markers"];
const FRAMES: usize = 40;

/// Stamps of a camera as the dataset writes them, digits added up to nanoseconds.
fn written_stamps(shared: &Path, camera: &str) -> Vec<String> {
    let text = fs::read_to_string(shared.join("data/pandaset-dev/frames.jsonl")).expect("frames");
    let key = format!("\"{camera}\": ");
    text.lines()
        .map(|line| {
            let digits = line.split(&key).nth(1).expect("a stamp");
            let digits = digits.split([',', '}']).next().expect("its end");
            let (secs, fraction) = digits.split_once('.').expect("a decimal");
            format!("{secs}.{fraction:0<9}")
        })
        .collect()
}

fn texts(value: &Value) -> Vec<String> {
    let list = value.as_array().expect("a list").iter();
    list.map(|text| text.as_str().expect("text").to_owned())
        .collect()
}

#[test]
fn two_runs_give_one_bag_with_every_frame_and_every_digit() {
    let (Some(shared), Some(python), Some(_)) = (shared(), python(), runtime_library()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let config = write(
        folder.path(),
        "config.toml",
        &pandaset_config(&shared, "publish = false"),
    );
    for run in ["one", "two"] {
        let bag = folder.path().join(run).join("bag").display().to_string();
        fs::create_dir(folder.path().join(run)).expect("a folder");
        run_well(&["run", &config, "--pace", "lossless", "--bag", &bag]);
    }
    for file in ["bag_0.mcap", "metadata.yaml"] {
        let bytes =
            |run: &str| fs::read(folder.path().join(run).join("bag").join(file)).expect("recorded");
        assert!(
            bytes("one") == bytes("two"),
            "{file} differs between two runs"
        );
    }
    let bag = folder.path().join("one/bag").display().to_string();
    let read = peer_json(&python, "read_bag.py", &[&bag]);
    assert_eq!(
        read["agree"],
        Value::Bool(true),
        "two independent readers disagree"
    );
    let topics = &read["rosbags"];
    for camera in CAMERAS {
        let stamps = written_stamps(&shared, camera);
        for name in CAMERA_TOPICS {
            let topic = &topics[format!("/roadwatch/{camera}/{name}")];
            assert_eq!(topic["count"], FRAMES, "{camera}/{name}");
            if name != "markers" {
                assert_eq!(texts(&topic["stamps"]), stamps, "{camera}/{name}");
            }
        }
    }
    for name in SCENE_TOPICS {
        assert_eq!(
            topics[format!("/roadwatch/scene/{name}")]["count"],
            FRAMES,
            "scene/{name}"
        );
    }
    assert_eq!(topics["/tf_static"]["count"], 1);
    // The newest of each round is the right camera's.
    assert_eq!(
        texts(&topics["/roadwatch/scene/objects"]["stamps"]),
        written_stamps(&shared, "right")
    );
}
