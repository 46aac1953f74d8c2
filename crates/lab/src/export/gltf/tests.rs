//! Files of scenes, read back by somebody else's reader.

use super::*;
use gltf::animation::{Interpolation, Property, util::ReadOutputs};
use roadwatch_ros::msg::{
    geometry_msgs::{Point, Quaternion, Vector3 as Size},
    std_msgs::Header,
};

const UTM: [f64; 3] = [4_000_000.25, 500_000.5, 30.0];

fn object(id: u64, x: f64, yaw: Option<f64>) -> Object {
    Object {
        track_id: id,
        class_id: "car".to_owned(),
        position: Point { x, y: 2.0, z: 0.8 },
        size: Size {
            x: 4.6,
            y: 1.9,
            z: 1.6,
        },
        heading_known: yaw.is_some(),
        yaw_rad: yaw.unwrap_or_default(),
        ..Object::default()
    }
}

/// The vehicle goes a metre forward, to the north, in each tenth of a second.
fn scene(number: u32, objects: Vec<Object>) -> ObjectArray {
    let mut scene = ObjectArray {
        header: Header {
            stamp: Time {
                sec: 100,
                nanosec: number * 100_000_000,
            },
            frame_id: "base_link".to_owned(),
        },
        ego_motion: "measured".to_owned(),
        objects,
        ..ObjectArray::default()
    };
    scene.ego_pose.position = Point {
        x: UTM[0],
        y: UTM[1] + f64::from(number),
        z: UTM[2],
    };
    let half = FRAC_PI_2 / 2.0;
    scene.ego_pose.orientation = Quaternion {
        x: 0.0,
        y: 0.0,
        z: half.sin(),
        w: half.cos(),
    };
    scene
}

fn rig() -> LineRig {
    let mut camera = LineCamera {
        name: "front".to_owned(),
        ..LineCamera::default()
    };
    camera.camera_info.width = 960;
    camera.camera_info.height = 540;
    camera.camera_info.k = [700.0, 0.0, 480.0, 0.0, 700.0, 270.0, 0.0, 0.0, 1.0];
    LineRig {
        base_frame: "base_link".to_owned(),
        cameras: vec![camera],
    }
}

struct Read {
    document: gltf::Document,
    binary: Vec<u8>,
}

fn written(scenes: &[ObjectArray]) -> (usize, Read) {
    let mut all = GltfScenes::new(rig(), 100.0);
    for scene in scenes {
        all.add(scene);
    }
    let mut bytes = Vec::new();
    let count = all.write(&mut bytes).expect("written");
    let read = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    let binary = read.blob.clone().expect("numbers");
    (
        count,
        Read {
            document: read.document,
            binary,
        },
    )
}

impl Read {
    /// Times and values of what moves a node.
    fn moves(&self, node: &str, property: Property) -> Option<(Vec<f32>, Vec<Vec<f32>>)> {
        let animation = self.document.animations().next().expect("an animation");
        let channel = animation.channels().find(|channel| {
            channel.target().node().name() == Some(node) && channel.target().property() == property
        })?;
        let evenly = channel.sampler().interpolation() == Interpolation::Linear;
        assert_eq!(
            evenly,
            property != Property::Scale,
            "what is seen changes at once"
        );
        let reader = channel.reader(|_| Some(&self.binary));
        let times = reader.read_inputs().expect("times").collect();
        let values = match reader.read_outputs().expect("values") {
            ReadOutputs::Translations(all) | ReadOutputs::Scales(all) => {
                all.map(|v| v.to_vec()).collect()
            }
            ReadOutputs::Rotations(all) => all.into_f32().map(|v| v.to_vec()).collect(),
            ReadOutputs::MorphTargetWeights(_) => unreachable!("none of these"),
        };
        Some((times, values))
    }
}

fn near(found: &[f32], expected: &[f64]) -> bool {
    found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(a, b)| (f64::from(*a) - b).abs() < 1e-3)
}

#[test]
fn places_are_right_to_a_millimetre_wherever_odom_begins() {
    let scenes: Vec<_> = (0..3)
        .map(|number| scene(number, vec![object(7, 10.0, Some(0.0))]))
        .collect();
    let (count, read) = written(&scenes);
    assert_eq!(count, 1);
    let (times, places) = read.moves("car 7", Property::Translation).expect("moves");
    assert!(near(&times, &[0.0, 0.1, 0.2]), "{times:?}");
    // Ten metres ahead of a vehicle that faces north, two to its left, which is west.
    assert!(near(&places[0], &[-2.0, 10.0, 0.8]), "{places:?}");
    assert!(near(&places[2], &[-2.0, 12.0, 0.8]), "{places:?}");
    let (_, ego) = read
        .moves("base_link", Property::Translation)
        .expect("moves");
    assert!(near(&ego[2], &[0.0, 2.0, 0.0]), "{ego:?}");
    let half = FRAC_PI_2 / 2.0;
    let (_, turns) = read.moves("car 7", Property::Rotation).expect("turns");
    assert!(
        near(&turns[0], &[0.0, 0.0, half.sin(), half.cos()]),
        "{turns:?}"
    );
}

#[test]
fn a_scene_in_odom_is_not_moved_once_more() {
    let mut told = scene(0, vec![object(7, UTM[0] + 3.0, Some(0.0))]);
    told.header.frame_id = "odom".to_owned();
    told.objects[0].position.y = UTM[1];
    told.objects[0].position.z = UTM[2];
    let (_, read) = written(&[told]);
    let (_, places) = read.moves("car 7", Property::Translation).expect("moves");
    assert!(near(&places[0], &[3.0, 0.0, 0.0]), "{places:?}");
}

#[test]
fn who_comes_and_goes_is_shown_only_while_there() {
    let there = |number| {
        vec![object(1, 5.0, Some(0.0))]
            .into_iter()
            .filter(|_| (2..4).contains(&number))
            .collect()
    };
    let scenes: Vec<_> = (0..6).map(|number| scene(number, there(number))).collect();
    let (_, read) = written(&scenes);
    let (times, shown) = read
        .moves("car 1", Property::Scale)
        .expect("comes and goes");
    assert!(near(&times, &[0.0, 0.2, 0.4]), "{times:?}");
    assert_eq!(shown, [[0.0; 3], [1.0; 3], [0.0; 3]]);
}

#[test]
fn an_unknown_heading_has_no_arrow_and_no_turn() {
    let scenes = [
        scene(0, vec![object(1, 5.0, Some(0.5))]),
        scene(1, vec![object(1, 5.0, None)]),
    ];
    let (_, read) = written(&scenes);
    let (_, arrows) = read.moves("car 1 heading", Property::Scale).expect("goes");
    assert_eq!(arrows, [[1.0; 3], [0.0; 3]]);
    let (_, turns) = read.moves("car 1", Property::Rotation).expect("turns");
    assert_eq!(turns[0], turns[1], "stands as it stood");
}

#[test]
fn what_is_far_away_and_scenes_that_stand_still_are_left_out() {
    let scenes = [
        scene(0, vec![object(1, 5.0, None), object(2, 150.0, None)]),
        scene(0, vec![object(3, 5.0, None)]),
    ];
    let (count, read) = written(&scenes);
    assert_eq!(count, 1);
    assert!(read.moves("car 1", Property::Translation).is_some());
    assert!(read.moves("car 2", Property::Translation).is_none());
    assert!(read.moves("car 3", Property::Translation).is_none());
}

#[test]
fn nothing_at_all_is_a_file_too() {
    let (count, read) = written(&[]);
    assert_eq!(count, 0);
    assert_eq!(read.document.animations().count(), 0);
    assert_eq!(read.document.cameras().count(), 1);
}
