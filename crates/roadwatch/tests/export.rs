//! What others take recordings in, against the recording itself: JSON lines live and from the bag, data frames, glTF.

mod support;

use mcap::MessageStream;
use roadwatch_ros::{cdr, msg::roadwatch_msgs::ObjectArray};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    io::{BufRead as _, BufReader},
    net::TcpStream,
    path::Path,
    process::{Command, Stdio},
    sync::OnceLock,
    thread,
};
use support::{daemon, demo, refusal, run_well, runtime_library, stderr};
use tempfile::TempDir;

const FRAMES: &str = "16";
const SCENE: &str = "/roadwatch/scene/objects";

/// A short recording of the demo, with the lines that its daemon offered meanwhile; `None` without ONNX Runtime.
struct Drive {
    folder: TempDir,
    offered: Vec<String>,
}

impl Drive {
    fn recorded() -> Option<&'static Self> {
        static DRIVE: OnceLock<Option<Drive>> = OnceLock::new();
        DRIVE
            .get_or_init(|| runtime_library().map(|_| Self::record()))
            .as_ref()
    }

    fn record() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let silent = |text: String| {
            let text = text.replacen("[node]", "[node]\npublish = false", 1);
            text + "\n[scene_stream]\nlisten = \"127.0.0.1:0\"\n"
        };
        let config = demo(folder.path(), silent);
        let bag = folder.path().join("drive").display().to_string();
        let arguments = [
            "run", &config, "--pace", "lossless", "--frames", FRAMES, "--bag", &bag,
        ];
        let mut running = daemon(&arguments)
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
        let mut said = BufReader::new(running.stderr.take().expect("piped")).lines();
        let address = said.find_map(|line| {
            line.expect("text")
                .strip_prefix("scene stream: ")
                .map(str::to_owned)
        });
        let stream = TcpStream::connect(address.expect("said")).expect("connected");
        // Read to the end, so that nobody waits for a full pipe.
        let rest = thread::Builder::new();
        let rest = rest.spawn(move || said.count()).expect("a thread");
        let offered = BufReader::new(stream)
            .lines()
            .map(|line| line.expect("a line"))
            .collect();
        assert!(running.wait().expect("ended").success());
        rest.join().expect("read");
        Self { folder, offered }
    }

    fn bag(&self) -> String {
        self.folder.path().join("drive").display().to_string()
    }

    /// The messages of a topic as they stand in the file.
    fn messages(&self, wanted: impl Fn(&str) -> bool) -> Vec<ObjectArray> {
        let bytes = fs::read(self.folder.path().join("drive/drive_0.mcap")).expect("a file");
        let stream = MessageStream::new(&bytes)
            .expect("MCAP")
            .map(|message| message.expect("whole"));
        let wanted = stream.filter(|message| wanted(&message.channel.topic));
        wanted
            .map(|message| cdr::decode(&message.data).expect("an array"))
            .collect()
    }
}

fn out(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

fn scene_of(line: &str) -> Option<(u64, ObjectArray)> {
    let line: Value = serde_json::from_str(line).expect("JSON");
    let is_scene = line["type"] == "scene";
    is_scene.then(|| {
        let scene = serde_json::from_value(line["scene"].clone()).expect("the message");
        (line["seq"].as_u64().expect("a number"), scene)
    })
}

#[test]
fn scenes_as_lines_are_the_bags_to_the_last_digit_and_live_ones_are_the_same() {
    let Some(drive) = Drive::recorded() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let file = out(folder.path(), "scene.jsonl");
    run_well(&["export", "scene", "--bag", &drive.bag(), "-o", &file]);
    let text = fs::read_to_string(&file).expect("written");
    let mut lines = text.lines();
    let rig: Value = serde_json::from_str(lines.next().expect("the rig")).expect("JSON");
    assert_eq!(rig["base_frame"], "base_link");
    assert_eq!(rig["cameras"].as_array().map(Vec::len), Some(6));
    let exported: Vec<ObjectArray> = lines.filter_map(scene_of).map(|(_, scene)| scene).collect();
    assert_eq!(exported, drive.messages(|topic| topic == SCENE));
    assert!(
        exported.iter().any(|scene| !scene.objects.is_empty()),
        "something is seen"
    );

    // The live reader may have come after the first scenes.
    let live_rig: Value = serde_json::from_str(&drive.offered[0]).expect("JSON");
    let names = |rig: &Value| -> Vec<String> {
        let cameras = rig["cameras"].as_array().expect("cameras").iter();
        let mut names: Vec<_> = cameras.map(|one| one["name"].to_string()).collect();
        names.sort();
        names
    };
    assert_eq!(names(&live_rig), names(&rig));
    let live: Vec<_> = drive
        .offered
        .iter()
        .filter_map(|line| scene_of(line))
        .collect();
    assert!(live.len() > 5, "{} scenes came live", live.len());
    for (seq, scene) in live {
        assert_eq!(scene, exported[seq as usize]);
    }
}

#[test]
fn data_frames_have_a_row_for_every_object_of_every_camera() {
    let Some(drive) = Drive::recorded() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let frames = out(folder.path(), "frames");
    run_well(&["export", "frames", "--bag", &drive.bag(), "-o", &frames]);
    let is_camera = |topic: &str| topic.ends_with("/objects") && topic != SCENE;
    let arrays = drive.messages(is_camera);
    let objects = arrays
        .iter()
        .map(|array| array.objects.len())
        .sum::<usize>();
    for name in ["locational", "rotational"] {
        let csv = fs::read_to_string(format!("{frames}/{name}.csv")).expect("written");
        assert_eq!(csv.lines().count(), objects + 1, "{name}");
        for picture_or_table in ["png", "parquet"] {
            let size =
                fs::metadata(format!("{frames}/{name}.{picture_or_table}")).expect("written");
            assert!(size.len() > 1000, "{name}.{picture_or_table}");
        }
    }
    let csv = fs::read_to_string(format!("{frames}/locational.csv")).expect("written");
    let columns: Vec<&str> = csv.lines().next().expect("names").split(',').collect();
    let column = |name: &str| {
        columns
            .iter()
            .position(|one| *one == name)
            .expect("a column")
    };
    let (camera, x) = (column("camera"), column("x_m"));
    let mut expected: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for array in &arrays {
        let places = array.objects.iter().map(|object| object.position.x);
        expected.entry(&array.camera).or_default().extend(places);
    }
    let mut found: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for line in csv.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        found
            .entry(cells[camera])
            .or_default()
            .push(cells[x].parse().expect("a number"));
    }
    expected.retain(|_, places| !places.is_empty());
    assert_eq!(found, expected);
}

#[test]
fn a_gltf_file_is_whole_and_moves() {
    let Some(drive) = Drive::recorded() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let file = out(folder.path(), "drive.glb");
    let output = run_well(&["export", "gltf", "--bag", &drive.bag(), "-o", &file]);
    assert!(stderr(&output).contains("tracks in"), "{}", stderr(&output));
    let bytes = fs::read(&file).expect("written");
    let length = u32::from_le_bytes(bytes[8..12].try_into().expect("four"));
    assert_eq!(length as usize, bytes.len());
    let json_length = u32::from_le_bytes(bytes[12..16].try_into().expect("four")) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + json_length]).expect("JSON");
    assert_eq!(json["cameras"].as_array().map(Vec::len), Some(6));
    let channels = json["animations"][0]["channels"].as_array().expect("moves");
    assert!(channels.len() > 4, "{}", channels.len());
}

#[test]
fn what_cannot_be_exported_says_why_and_leaves_nothing_behind() {
    let Some(drive) = Drive::recorded() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let nowhere = out(folder.path(), "absent/scene.jsonl");
    let file = out(folder.path(), "scene.jsonl");
    let no_bag = refusal(&[
        "export",
        "scene",
        "--bag",
        &out(folder.path(), "none"),
        "-o",
        &file,
    ]);
    assert!(no_bag.contains("is no bag"), "{no_bag}");
    let no_place = refusal(&["export", "gltf", "--bag", &drive.bag(), "-o", &nowhere]);
    assert!(
        no_place.contains("cannot be written") && no_place.contains("No such file"),
        "{no_place}"
    );
    let no_topic = refusal(&[
        "export",
        "scene",
        "--bag",
        &drive.bag(),
        "--topic",
        "/tf_static",
        "-o",
        &file,
    ]);
    assert!(no_topic.contains("/tf_static"), "{no_topic}");
    assert_eq!(
        fs::read_dir(folder.path()).expect("there").count(),
        0,
        "nothing half"
    );
}

#[test]
fn a_full_disk_is_said_and_what_was_there_before_stays() {
    let Some(drive) = Drive::recorded() else {
        return;
    };
    let disk = tempfile::tempdir().expect("a folder");
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
        .arg(disk.path())
        .status();
    if !mounted.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED: this user cannot mount a small disk to fill");
        return;
    }
    let file = out(disk.path(), "scene.jsonl");
    fs::write(&file, "before").expect("room for that");
    let said = refusal(&["export", "scene", "--bag", &drive.bag(), "-o", &file]);
    let (kept, count) = (
        fs::read_to_string(&file),
        fs::read_dir(disk.path()).map(Iterator::count),
    );
    let unmounted = Command::new("umount").arg(disk.path()).status();
    assert!(
        unmounted.is_ok_and(|status| status.success()),
        "still mounted"
    );
    assert!(
        said.contains("cannot be written") && said.contains("No space"),
        "{said}"
    );
    assert_eq!(kept.expect("there"), "before");
    assert_eq!(count.expect("there"), 1, "nothing half");
}

#[test]
fn an_address_that_is_taken_ends_the_start_with_a_message() {
    if runtime_library().is_none() {
        return;
    }
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address").to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let silent = |text: String| text.replacen("[node]", "[node]\npublish = false", 1);
    let config = demo(folder.path(), silent);
    let output = daemon(&["run", &config, "--frames", "1", "--scene-stream", &address])
        .output()
        .expect("ran");
    assert!(!output.status.success());
    let said = stderr(&output);
    assert!(
        said.contains(&address) && said.contains("--scene-stream"),
        "{said}"
    );
}

#[test]
fn mistakes_in_the_streams_table_are_said_each_with_its_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        (
            "listen = \"everywhere\"",
            "scene_stream.listen: `everywhere` is no address with a port",
        ),
        (
            "lisen = \"127.0.0.1:0\"",
            "scene_stream.lisen: unknown key; did you mean `listen`?",
        ),
        ("", "scene_stream.listen: "),
    ];
    for (keys, expected) in cases {
        let config = demo(folder.path(), |text| {
            format!("{text}\n[scene_stream]\n{keys}\n")
        });
        let said = refusal(&["check", &config]);
        assert!(said.contains(expected), "expected `{expected}` in:\n{said}");
    }
}
