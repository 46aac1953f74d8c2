use super::*;
use crate::msg::{geometry_msgs::Transform, std_msgs::Header};
use nalgebra::Vector3;

const STEP: i64 = 20_000_000;

fn at(step: i64) -> Timestamp {
    Timestamp::from_nanos(1_000_000_000_000 + step * STEP)
}

fn transform(chain: (&str, &str), step: i64, x: f64, yaw_rad: f64) -> TransformStamped {
    let pose = Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * yaw_rad);
    TransformStamped {
        header: Header::new(at(step), chain.0),
        child_frame_id: chain.1.to_owned(),
        transform: Transform::from(&pose),
    }
}

/// Step and x of `base_link` in `odom`.
fn told(transforms: &Transforms) -> Option<(Timestamp, f64)> {
    let pose = transforms.pose("odom", "base_link");
    pose.map(|(at, pose)| (at, pose.translation.x))
}

#[test]
fn a_pose_follows_from_a_chain_of_moving_and_static_transforms() {
    let mut transforms = Transforms::default();
    transforms.take(
        &transform(("base_footprint", "base_link"), 0, 1.0, 0.0),
        Moves::Never,
    );
    assert!(transforms.pose("odom", "base_link").is_none());
    let quarter = std::f64::consts::FRAC_PI_2;
    transforms.take(
        &transform(("/odom", "base_footprint"), 7, 5.0, quarter),
        Moves::Always,
    );
    let (stamp, pose) = transforms.pose("odom", "base_link").expect("a chain");
    let off = pose.translation.vector - Vector3::new(5.0, 1.0, 0.0);
    assert!(off.norm() < 1e-9 && stamp == at(7), "{pose}");
}

#[test]
fn a_wheel_that_turns_says_nothing_of_the_vehicle() {
    let mut transforms = Transforms::default();
    transforms.take(
        &transform(("odom", "base_link"), 1, 5.0, 0.0),
        Moves::Always,
    );
    transforms.take(
        &transform(("base_link", "wheel"), 9, 0.0, 1.0),
        Moves::Always,
    );
    assert_eq!(told(&transforms), Some((at(1), 5.0)));
}

#[test]
fn pieces_that_come_at_their_own_pace_meet_at_the_moment_both_tell_of() {
    let mut transforms = Transforms::default();
    let (outer, inner) = (("odom", "footprint"), ("footprint", "base_link"));
    transforms.take(&transform(outer, 0, 0.0, 0.0), Moves::Always);
    transforms.take(&transform(outer, 10, 10.0, 0.0), Moves::Always);
    assert_eq!(told(&transforms), None);
    transforms.take(&transform(inner, 5, 0.5, 0.0), Moves::Always);
    let (stamp, x) = told(&transforms).expect("both");
    assert!(stamp == at(5) && (x - 5.5).abs() < 1e-9, "{x}");
    transforms.take(&transform(inner, 12, 0.5, 0.0), Moves::Always);
    assert_eq!(told(&transforms), Some((at(10), 10.5)));
}

#[test]
fn what_comes_late_is_left_out_and_what_begins_anew_is_followed() {
    let mut transforms = Transforms::default();
    let edge = ("odom", "base_link");
    transforms.take(&transform(edge, 100, 5.0, 0.0), Moves::Always);
    transforms.take(&transform(edge, 90, 4.0, 0.0), Moves::Always);
    assert_eq!(told(&transforms), Some((at(100), 5.0)));
    transforms.take(&transform(edge, 0, 1.0, 0.0), Moves::Always);
    assert_eq!(told(&transforms), Some((at(0), 1.0)));
}

#[test]
fn what_is_no_transform_is_left_out() {
    let mut transforms = Transforms::default();
    let good = transform(("odom", "base_link"), 1, 5.0, 0.0);
    transforms.take(&good, Moves::Always);
    let mut bad = transform(("odom", "base_link"), 2, f64::NAN, 0.0);
    transforms.take(&bad, Moves::Always);
    bad = transform(("odom", "base_link"), 3, 6.0, 0.0);
    bad.transform.rotation.w = 0.0;
    transforms.take(&bad, Moves::Always);
    assert_eq!(told(&transforms), Some((at(1), 5.0)));
}

#[test]
fn a_camera_listed_twice_in_two_places_is_said_once_and_the_last_counts() {
    let mut transforms = Transforms::default();
    let camera = ("base_link", "camera");
    for x in [1.0, 1.000_01, 1.5, 1.0, 1.5] {
        transforms.take(&transform(camera, 0, x, 0.0), Moves::Never);
    }
    assert_eq!(transforms.said.len(), 1);
    let said = ("camera".to_owned(), Oddity::TwoPlaces);
    assert!(transforms.said.contains(&said));
}

#[test]
fn the_same_place_told_by_two_is_nothing_odd() {
    let mut transforms = Transforms::default();
    for (step, x) in [(0, 1.0), (3, 1.000_01)] {
        transforms.take(
            &transform(("base_link", "camera"), step, x, 0.0),
            Moves::Never,
        );
    }
    for step in [4, 4, 5] {
        transforms.take(
            &transform(("odom", "base_link"), step, 2.0, 0.0),
            Moves::Always,
        );
    }
    assert!(transforms.said.is_empty());
}

#[test]
fn a_frame_with_two_parents_is_said() {
    let mut transforms = Transforms::default();
    transforms.take(
        &transform(("odom", "base_link"), 0, 1.0, 0.0),
        Moves::Always,
    );
    transforms.take(&transform(("map", "base_link"), 1, 1.0, 0.0), Moves::Always);
    assert_eq!(transforms.said.len(), 1);
    assert_eq!(told(&transforms), None);
}

#[test]
fn frames_in_a_circle_lead_nowhere() {
    let mut transforms = Transforms::default();
    transforms.take(&transform(("a", "b"), 0, 1.0, 0.0), Moves::Always);
    transforms.take(&transform(("b", "a"), 0, 1.0, 0.0), Moves::Always);
    assert!(transforms.pose("odom", "a").is_none());
}
