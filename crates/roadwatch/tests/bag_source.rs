//! A recorded bag as the source of every camera: played again it gives the same, and what is no such bag is refused.

mod support;

use std::{fs, path::Path};
use support::{demo, refusal, root, run_well, runtime_library, stdout};

const CAMERAS: usize = 6;

/// The demo without a node.
fn silent(text: String) -> String {
    text.replacen("[node]", "[node]\npublish = false", 1)
}

/// The demo's rig with every camera fed by its images in `bag`; `topic` gives the topic of a camera.
fn fed_by(bag: &Path, topic: impl Fn(&str) -> String) -> impl Fn(String) -> String {
    let rig = fs::read_to_string(root().join("demo/rig.toml")).expect("the demo's rig");
    let bag = bag.display().to_string();
    let tables = rig.split("[[camera]]").skip(1).map(|table| {
        let name = table.split('"').nth(1).expect("a name");
        format!(
            "[[camera]]\nbag = \"{bag}\"\ntopic = \"{}\"{table}",
            topic(name)
        )
    });
    let tables: String = tables.collect();
    move |text| {
        let without_dataset = |line: &&str| !line.starts_with("dataset =");
        let lines: Vec<&str> = text.lines().filter(without_dataset).collect();
        format!("{}\n{tables}", silent(lines.join("\n")))
    }
}

fn image_topic(camera: &str) -> String {
    format!("/roadwatch/{camera}/image/compressed")
}

/// Three frames of each camera, with images, in several files.
fn record(folder: &Path) {
    let config = demo(folder, silent);
    let bag = folder.join("recorded").display().to_string();
    let split = ["--bag-split-mb", "1"];
    let run = ["run", &config, "--pace", "lossless", "--frames", "3"];
    run_well(&[&run[..], &["--bag", &bag, "--bag-images"], &split].concat());
    assert!(
        folder.join("recorded/recorded_1.mcap").is_file(),
        "not split"
    );
}

/// The same, and the demo fed by them.
fn replayed(folder: &Path) -> String {
    record(folder);
    demo(folder, fed_by(&folder.join("recorded"), image_topic))
}

#[test]
fn replaying_a_bag_twice_gives_the_same_bytes_and_the_recorded_stamps() {
    if runtime_library().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let config = replayed(folder.path());
    let mut bags = Vec::new();
    for run in ["one", "two"] {
        let bag = folder.path().join(run).join("bag");
        fs::create_dir(folder.path().join(run)).expect("a folder");
        let bag_path = bag.display().to_string();
        let said = run_well(&[
            "run", &config, "--pace", "lossless", "--json", "--bag", &bag_path,
        ]);
        let said: serde_json::Value = serde_json::from_str(&stdout(&said)).expect("JSON");
        let cameras = said["cameras"].as_array().expect("cameras");
        let sum = |key: &str| -> u64 {
            cameras
                .iter()
                .filter_map(|camera| camera[key].as_u64())
                .sum()
        };
        assert_eq!(sum("published"), 3 * CAMERAS as u64);
        assert!(sum("objects") > 20, "{said}");
        let read = |name: &str| fs::read(bag.join(name)).expect("recorded");
        bags.push((read("bag_0.mcap"), read("metadata.yaml")));
    }
    assert!(bags[0] == bags[1], "two replays differ");
    let stamps = |bytes: &[u8], end: &str| -> Vec<u64> {
        let all = mcap::MessageStream::new(bytes)
            .expect("MCAP")
            .map(|m| m.expect("whole"));
        let of_topic = all.filter(|message| message.channel.topic == end);
        of_topic.map(|message| message.log_time).collect()
    };
    let recorded: Vec<u64> = (0..2)
        .map(|file| folder.path().join(format!("recorded/recorded_{file}.mcap")))
        .flat_map(|file| {
            stamps(
                &fs::read(file).expect("recorded"),
                "/roadwatch/front/objects",
            )
        })
        .collect();
    let replayed = stamps(&bags[0].0, "/roadwatch/front/objects");
    assert_eq!(replayed.len(), 3);
    assert_eq!(replayed[..recorded.len()], recorded[..]);
}

#[test]
fn a_bag_is_played_round_and_round() {
    if runtime_library().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let config = replayed(folder.path());
    let said = run_well(&[
        "run", &config, "--pace", "lossless", "--loop", "--frames", "7", "--json",
    ]);
    let said: serde_json::Value = serde_json::from_str(&stdout(&said)).expect("JSON");
    assert_eq!(said["cameras"][0]["published"], 7);
    assert_eq!(said["cameras"][0]["lost"], 0);
}

#[test]
fn what_is_no_bag_with_these_images_is_said_before_the_first_frame() {
    if runtime_library().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path());
    let recorded = folder.path().join("recorded");
    let check = |bag: &Path, topic: &dyn Fn(&str) -> String| {
        let config = demo(folder.path(), fed_by(bag, topic));
        refusal(&["check", &config])
    };
    let said = check(&recorded, &|camera| format!("/elsewhere/{camera}"));
    assert!(said.contains("has no images on `/elsewhere/front`; its image topics: /roadwatch/back/image/compressed,"), "{said}");
    let said = check(&recorded, &|camera| format!("/roadwatch/{camera}/objects"));
    assert!(said.contains("is roadwatch_msgs/msg/ObjectArray, not sensor_msgs/msg/Image or sensor_msgs/msg/CompressedImage"), "{said}");
    let said = check(&folder.path().join("nowhere"), &image_topic);
    assert!(
        said.contains("is no bag: expected an .mcap file, or a folder with some"),
        "{said}"
    );
    let file = recorded.join("recorded_0.mcap");
    let whole = fs::read(&file).expect("recorded");
    fs::write(&file, &whole[..whole.len() / 2]).expect("cut");
    let said = check(&recorded, &image_topic);
    assert!(
        said.contains("has no index: it was not finished; `mcap recover` makes one"),
        "{said}"
    );
}
