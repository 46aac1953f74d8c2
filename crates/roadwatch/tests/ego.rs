//! `[ego]`: what cannot tell where the vehicle is, is said at once; what a bag tells is known in every output.

mod support;

use mcap::records::MessageHeader;
use roadwatch_ros::{cdr, definitions::schema, msg::roadwatch_msgs::ObjectArray};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::BufWriter,
    path::{Path, PathBuf},
};
use support::{demo, refusal, run_well, runtime_library, stdout};

/// The demo begins there, seconds.
const DEMO_STARTS: i32 = 1_700_000_000;
const ODOM: &str = "/vehicle/odom";

/// The demo without a node, with this in its `[ego]`.
fn with_ego(folder: &Path, keys: &str) -> String {
    demo(folder, |text| {
        let silent = text.replacen("[node]", "[node]\npublish = false", 1);
        format!("{silent}\n[ego]\n{keys}\n")
    })
}

#[test]
fn mistakes_in_it_are_said_each_with_its_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let one_of =
        "only one can tell where the vehicle is: keep one of `still`, `odometry` and `tf_frame`";
    let cases = [
        (
            "odometri = \"/odom\"",
            "ego.odometri: unknown key; did you mean `odometry`?".to_owned(),
        ),
        ("still = 1", "ego.still: ".to_owned()),
        (
            "still = true\nodometry = \"/odom\"",
            format!("ego.odometry: {one_of}"),
        ),
        (
            "odometry = \"/odom\"\ntf_frame = \"odom\"",
            format!("ego.tf_frame: {one_of}"),
        ),
        (
            "still = true\ntf_frame = \"odom\"",
            format!("ego.tf_frame: {one_of}"),
        ),
        (
            "bag = \"drive\"",
            "ego.bag: of which topic? add `odometry` or `tf_frame`".to_owned(),
        ),
        ("odometry = \"\"", "ego.odometry: empty".to_owned()),
        (
            "tf_frame = \"/odom\"",
            "ego.tf_frame: cannot name a tf frame".to_owned(),
        ),
        (
            "tf_frame = \"base_link\"",
            "ego.tf_frame: `base_link` is the vehicle itself".to_owned(),
        ),
        (
            "odometry = \"/odom\"\nbag = \"/no/such/bag\"",
            "ego.bag: `/no/such/bag` is no bag".to_owned(),
        ),
    ];
    for (keys, expected) in cases {
        let said = refusal(&["check", &with_ego(folder.path(), keys)]);
        assert!(
            said.contains(&expected),
            "expected `{expected}` in:\n{said}"
        );
    }
}

#[test]
fn check_says_who_will_tell() {
    if runtime_library().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let bag = odometry_bag(folder.path());
    let of_bag = format!("odometry = \"{ODOM}\"\nbag = \"{}\"", bag.display());
    let cases = [
        (
            "still = true",
            "where the vehicle is: the configuration, which says that it is still",
        ),
        (
            "tf_frame = \"odom\"",
            "where the vehicle is: the topic /tf, in the frame odom, which only `run` listens to",
        ),
        (&of_bag, "drive.mcap, 200 poses"),
    ];
    for (keys, expected) in cases {
        let said = stdout(&run_well(&["check", &with_ego(folder.path(), keys)]));
        assert!(said.contains(expected), "{said}");
    }
}

/// Odometry at 100 Hz, from half a second before the demo to one and a half after its beginning.
fn odometry_bag(folder: &Path) -> PathBuf {
    let path = folder.join("drive.mcap");
    let file = BufWriter::new(File::create(&path).expect("a file"));
    let mut writer = mcap::Writer::new(file).expect("a bag");
    let text = schema("nav_msgs/Odometry").expect("embedded");
    let schema = writer.add_schema("nav_msgs/msg/Odometry", "ros2msg", text.as_bytes());
    let schema = schema.expect("added");
    let channel = writer.add_channel(schema, ODOM, "cdr", &BTreeMap::new());
    let channel_id = channel.expect("added");
    for step in 0..200_i32 {
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: 0,
            publish_time: 0,
        };
        let message = odometry(step * 10 - 500, f64::from(step) * 0.1);
        writer
            .write_to_known_channel(&header, &message)
            .expect("written");
    }
    writer.finish().expect("finished");
    path
}

/// An Odometry message, byte by byte as `rmw` writes it.
fn odometry(millis: i32, x_m: f64) -> Vec<u8> {
    let mut body = Vec::new();
    let secs = DEMO_STARTS + millis.div_euclid(1000);
    body.extend(secs.to_le_bytes());
    body.extend((millis.rem_euclid(1000) * 1_000_000).to_le_bytes());
    for text in ["odom", "base_link"] {
        body.resize(body.len().next_multiple_of(4), 0);
        body.extend((text.len() as u32 + 1).to_le_bytes());
        body.extend(text.as_bytes());
        body.push(0);
    }
    body.resize(body.len().next_multiple_of(8), 0);
    let pose = [x_m, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let numbers = pose.into_iter().chain([0.01; 36]).chain([0.0; 6 + 36]);
    body.extend(numbers.flat_map(f64::to_le_bytes));
    [vec![0, 1, 0, 0], body].concat()
}

#[test]
fn what_a_bag_tells_is_known_in_every_output_and_the_same_in_every_run() {
    if runtime_library().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let bag = odometry_bag(folder.path());
    let keys = format!("odometry = \"{ODOM}\"\nbag = \"{}\"", bag.display());
    let config = with_ego(folder.path(), &keys);
    let recorded = ["one", "two"].map(|run| {
        fs::create_dir(folder.path().join(run)).expect("a folder");
        let out = folder.path().join(run).join("out");
        let out_path = out.display().to_string();
        let run = [
            "run", &config, "--pace", "lossless", "--frames", "4", "--bag",
        ];
        run_well(&[&run[..], &[&out_path]].concat());
        fs::read(out.join("out_0.mcap")).expect("recorded")
    });
    assert!(recorded[0] == recorded[1], "two runs differ");
    let messages = mcap::MessageStream::new(&recorded[0]).expect("MCAP");
    let known: Vec<String> = messages
        .map(|message| message.expect("whole"))
        .filter(|message| message.channel.topic.ends_with("/objects"))
        .map(|message| {
            let objects: ObjectArray = cdr::decode(&message.data).expect("objects");
            objects.ego_motion
        })
        .collect();
    assert!(known.len() > 4 * 6, "{known:?}");
    assert_eq!(
        BTreeSet::from_iter(known),
        BTreeSet::from(["measured".to_owned()])
    );
}
