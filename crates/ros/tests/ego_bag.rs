//! Where the vehicle was, from bags that others recorded: in order of stamps, and refused where they do not say.

use mcap::records::MessageHeader;
use nalgebra::{Isometry3, Vector3};
use roadwatch_core::{EgoKnowledge, EgoMotion, Timestamp, ego::EgoCounts};
use roadwatch_ros::{
    EgoSource,
    definitions::schema,
    msg::{
        geometry_msgs::{Pose, PoseWithCovariance, Quaternion, Transform, TransformStamped},
        nav_msgs::Odometry,
        std_msgs::Header,
        tf2_msgs::TFMessage,
    },
    tell_from_bag,
};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    error::Error,
    fs::File,
    io::BufWriter,
    path::{Path, PathBuf},
    sync::Arc,
};

const ODOM: &str = "/odom";

/// 10 Hz.
fn at(step: i64) -> Timestamp {
    Timestamp::from_nanos(1_000_000_000_000 + step * 100_000_000)
}

fn odometry(step: i64, child: &str) -> Vec<u8> {
    let mut pose = Pose {
        orientation: Quaternion {
            w: 1.0,
            ..Quaternion::default()
        },
        ..Pose::default()
    };
    pose.position.x = step as f64;
    let message = Odometry {
        header: Header::new(at(step), "odom"),
        child_frame_id: child.to_owned(),
        pose: PoseWithCovariance {
            pose,
            ..PoseWithCovariance::default()
        },
        ..Odometry::default()
    };
    encoded(&message)
}

fn transforms(all: &[(&str, &str, i64, f64)]) -> Vec<u8> {
    let transforms = all.iter().map(|(parent, child, step, x)| TransformStamped {
        header: Header::new(at(*step), *parent),
        child_frame_id: (*child).to_owned(),
        transform: Transform::from(&Isometry3::new(Vector3::x() * *x, Vector3::zeros())),
    });
    encoded(&TFMessage {
        transforms: transforms.collect(),
    })
}

/// As DDS carries it.
fn encoded(message: &impl Serialize) -> Vec<u8> {
    let body = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(message).expect("encoded");
    [vec![0, 1, 0, 0], body].concat()
}

/// A bag with these messages, recorded one second after the other.
fn bag(folder: &Path, messages: &[(&str, &str, Vec<u8>)]) -> PathBuf {
    let path = folder.join("drive_0.mcap");
    let file = BufWriter::new(File::create(&path).expect("a file"));
    let mut writer = mcap::Writer::new(file).expect("a bag");
    let mut channels = BTreeMap::new();
    for (sequence, (topic, ros_type, bytes)) in messages.iter().enumerate() {
        let channel_id = *channels.entry(*topic).or_insert_with(|| {
            let text = schema(ros_type).expect("embedded");
            let name = ros_type.replace('/', "/msg/");
            let schema = writer.add_schema(&name, "ros2msg", text.as_bytes());
            writer
                .add_channel(schema.expect("added"), topic, "cdr", &BTreeMap::new())
                .expect("added")
        });
        let log_time = sequence as u64 * 1_000_000_000;
        let header = MessageHeader {
            channel_id,
            sequence: sequence as u32,
            log_time,
            publish_time: log_time,
        };
        writer
            .write_to_known_channel(&header, bytes)
            .expect("written");
    }
    writer.finish().expect("finished");
    folder.to_owned()
}

fn by_odometry() -> EgoSource {
    EgoSource::Odometry {
        topic: ODOM.to_owned(),
        base_frame: "base_link".to_owned(),
    }
}

fn by_transforms() -> EgoSource {
    EgoSource::Transforms {
        moving: "/tf".to_owned(),
        fixed: "/tf_static".to_owned(),
        odom_frame: "odom".to_owned(),
        base_frame: "base_link".to_owned(),
    }
}

fn told(messages: &[(&str, &str, Vec<u8>)], source: &EgoSource) -> Result<EgoMotion, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let motion = Arc::new(EgoMotion::recorded());
    let bag = bag(folder.path(), messages);
    match tell_from_bag(&bag, source, &motion) {
        Ok(()) => Ok(Arc::into_inner(motion).expect("kept by nobody else")),
        Err(error) => Err(match error.source() {
            None => error.to_string(),
            Some(source) => format!("{error}: {source}"),
        }),
    }
}

fn x(motion: &EgoMotion, step: i64) -> f64 {
    let ego = motion.at(at(step));
    assert_eq!(ego.knowledge, EgoKnowledge::Measured);
    ego.odom_from_base.origin().x()
}

#[test]
fn odometry_is_told_in_order_of_stamps_and_other_frames_are_left_out() {
    let kind = "nav_msgs/Odometry";
    let mut messages: Vec<_> = [3, 0, 2, 1, 5, 4]
        .map(|step| (ODOM, kind, odometry(step, "base_link")))
        .into();
    messages.push((ODOM, kind, odometry(6, "")));
    messages.push((ODOM, kind, odometry(900, "trailer")));
    messages.push((ODOM, kind, b"\0\x01\0\0no odometry".to_vec()));
    messages.push((ODOM, kind, odometry(6, "base_link")));
    let motion = told(&messages, &by_odometry()).expect("told");
    let counts = EgoCounts {
        taken: 7,
        // What cannot be read, and one stamp twice.
        refused: 2,
        ..EgoCounts::default()
    };
    assert_eq!(motion.counts(), counts);
    assert_eq!(motion.newest(), Some(at(6)));
    for step in 0..=6 {
        assert_eq!(x(&motion, step), step as f64);
    }
}

#[test]
fn transforms_are_told_through_frames_in_between() {
    let kind = "tf2_msgs/TFMessage";
    let moving = |step: i64| {
        // A wheel's stamp is later, and says nothing of the vehicle.
        let base = ("odom", "base_footprint", step, step as f64);
        transforms(&[base, ("base_link", "wheel", step + 50, 0.0)])
    };
    let fixed = transforms(&[("base_footprint", "base_link", 0, 0.25)]);
    let mut messages: Vec<_> = [1, 0, 2].map(|step| ("/tf", kind, moving(step))).into();
    messages.push(("/tf_static", kind, fixed));
    let motion = told(&messages, &by_transforms()).expect("told");
    assert_eq!((motion.counts().taken, motion.counts().refused), (3, 0));
    for step in 0..=2 {
        assert_eq!(x(&motion, step), step as f64 + 0.25);
    }
}

#[test]
fn a_bag_that_does_not_say_it_is_refused_with_what_it_has() {
    let odometry_of = |child| vec![(ODOM, "nav_msgs/Odometry", odometry(1, child))];
    let tf = |parent| {
        let message = transforms(&[(parent, "base_link", 1, 0.0)]);
        vec![("/tf", "tf2_msgs/TFMessage", message)]
    };
    let cases = [
        (tf("odom"), by_odometry(), "has no `/odom`; it has /tf"),
        (
            odometry_of("base_link"),
            by_transforms(),
            "has no `/tf`; it has /odom",
        ),
        (
            odometry_of("trailer"),
            by_odometry(),
            "does not say where the vehicle is: it tells of trailer, and not of `base_link`",
        ),
        (
            tf("map"),
            by_transforms(),
            "no moving transforms lead from `odom` to `base_link`; there are map -> base_link",
        ),
        (
            vec![(ODOM, "tf2_msgs/TFMessage", transforms(&[]))],
            by_odometry(),
            "is tf2_msgs/msg/TFMessage, not nav_msgs/msg/Odometry",
        ),
        (
            vec![(ODOM, "nav_msgs/Odometry", b"none".to_vec())],
            by_odometry(),
            "not taken 1 times: it cannot be read",
        ),
    ];
    for (messages, source, expected) in cases {
        let said = told(&messages, &source).expect_err(expected);
        assert!(said.contains(expected), "{said}");
    }
}
