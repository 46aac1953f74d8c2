use super::*;
use crate::{
    msg::{geometry_msgs::Quaternion, visualization_msgs::Marker},
    testing,
};

fn messages() -> Messages {
    Messages::new(Arc::new(testing::two_cameras()), &Surface::default()).expect("legal names")
}

/// What goes to the topic of that name for the outputs of the first round.
fn published(name: &str) -> Message {
    let messages = messages();
    testing::outputs(0)
        .iter()
        .flat_map(|output| messages.of(output))
        .find(|outgoing| messages.topics()[outgoing.topic].name == name)
        .expect("published")
        .message
}

fn marker_array(name: &str) -> Vec<Marker> {
    match published(name) {
        Message::Markers(array) => array.markers,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_message_goes_to_a_topic_of_its_kind_and_every_topic_gets_one() {
    let messages = messages();
    let mut outgoing = vec![messages.tf_static(Timestamp::from_nanos(1))];
    outgoing.extend(
        testing::outputs(0)
            .iter()
            .flat_map(|output| messages.of(output)),
    );
    let places: Vec<usize> = outgoing.iter().map(|one| one.topic).collect();
    assert_eq!(places, (0..messages.topics().len()).collect::<Vec<_>>());
    for one in &outgoing {
        assert_eq!(messages.topics()[one.topic].kind, one.message.kind());
    }
}

#[test]
fn stamps_keep_every_digit() {
    let Message::Objects(array) = published("/roadwatch/front/objects") else {
        panic!("objects");
    };
    assert_eq!(array.header.stamp.sec, 1_557_539_956);
    assert_eq!(array.header.stamp.nanosec, 439_383_000);
    assert_eq!(array.header.frame_id, "base_link");
    assert_eq!(array.camera, "front");
}

#[test]
fn objects_of_the_scene_keep_their_own_stamp_and_cameras() {
    let Message::Objects(array) = published("/roadwatch/scene/objects") else {
        panic!("objects");
    };
    assert_eq!(array.camera, "");
    assert_eq!(array.header.stamp.nanosec, 440_383_000);
    assert_eq!(array.objects[0].header.stamp.nanosec, 439_383_000);
    assert_eq!(array.objects[0].seen_by, ["front"]);
}

#[test]
fn an_unknown_heading_is_said_and_not_invented() {
    let Message::Objects(array) = published("/roadwatch/front/objects") else {
        panic!("objects");
    };
    let (car, person) = (&array.objects[0], &array.objects[1]);
    assert!(!car.heading_known && car.yaw_rad == 0.0);
    assert_eq!(car.yaw_variance, YAW_UNKNOWN_VARIANCE_RAD2);
    assert!(person.heading_known && person.yaw_rad == 0.5);
    assert!((person.yaw_variance - 0.01).abs() < 1e-12);
}

#[test]
fn a_box_in_space_has_its_pose_twice_and_the_covariance_of_the_location() {
    let Message::Detections3d(array) = published("/roadwatch/front/detections_3d") else {
        panic!("detections in 3D");
    };
    let car = &array.detections[0];
    assert_eq!(car.id, "1");
    assert_eq!(car.results.len(), 1);
    let result = &car.results[0];
    assert_eq!(result.hypothesis.class_id, "car");
    assert_eq!(result.pose.pose, car.bbox.center);
    assert_eq!(car.bbox.center.orientation, Quaternion::default());
    assert_eq!(
        (car.bbox.size.x, car.bbox.size.y, car.bbox.size.z),
        (4.5, 1.8, 1.5)
    );
    let covariance = result.pose.covariance;
    assert_eq!(covariance[0], [4.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(covariance[1], [0.5, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(covariance[3][3], UPRIGHT_VARIANCE_RAD2);
    assert_eq!(covariance[5][5], YAW_UNKNOWN_VARIANCE_RAD2);
    let person = &array.detections[1].bbox.center.orientation;
    assert!((person.z - 0.25_f64.sin()).abs() < 1e-12 && (person.w - 0.25_f64.cos()).abs() < 1e-12);
}

#[test]
fn a_box_in_the_image_is_the_detected_one_and_its_pose_is_optical() {
    let Message::Detections2d(array) = published("/roadwatch/front/detections_2d") else {
        panic!("detections in 2D");
    };
    assert_eq!(array.header.frame_id, "front_optical_frame");
    let car = &array.detections[0];
    let middle = car.bbox.center.position;
    assert_eq!((middle.x, middle.y), (140.0, 225.0));
    assert_eq!((car.bbox.size_x, car.bbox.size_y), (80.0, 50.0));
    // base_link (20, 3, 0.75) from a camera at (1, 0, 1.5): 3 m left, 0.75 m down, 19 m ahead.
    let position = car.results[0].pose.pose.position;
    assert!((position.x + 3.0).abs() < 1e-9);
    assert!((position.y - 0.75).abs() < 1e-9);
    assert!((position.z - 19.0).abs() < 1e-9);
    // Along the optical axis the variance is base_link's along x.
    assert!((car.results[0].pose.covariance[2][2] - 4.0).abs() < 1e-9);
}

#[test]
fn what_has_no_place_is_in_the_image_only() {
    let Message::Detections2d(array) = published("/roadwatch/front/detections_2d") else {
        panic!("detections in 2D");
    };
    let boat = &array.detections[2];
    assert_eq!((boat.id.as_str(), array.detections.len()), ("", 3));
    assert_eq!(boat.results[0].hypothesis.class_id, "boat");
    assert_eq!(boat.results[0].pose.covariance[0][0], -1.0);
}

#[test]
fn markers_clear_first_and_point_an_arrow_only_where_a_heading_is_known() {
    let markers = marker_array("/roadwatch/front/markers");
    let shapes: Vec<(&str, i32, i32)> = markers
        .iter()
        .map(|marker| (marker.ns.as_str(), marker.id, marker.kind))
        .collect();
    assert_eq!(markers[0].action, Marker::DELETE_ALL);
    assert_eq!(
        shapes[1..],
        [
            ("front/box", 1, Marker::CUBE),
            ("front/label", 1, Marker::TEXT_VIEW_FACING),
            ("front/box", 2, Marker::CUBE),
            ("front/heading", 2, Marker::ARROW),
            ("front/label", 2, Marker::TEXT_VIEW_FACING),
        ]
    );
    assert_eq!(markers[2].text, "car 1 19.2 m");
}

#[test]
fn nothing_seen_is_published_as_empty_arrays() {
    assert_eq!(marker_array("/roadwatch/rear/markers").len(), 1);
    let Message::Objects(array) = published("/roadwatch/rear/objects") else {
        panic!("objects");
    };
    assert!(array.objects.is_empty());
}

#[test]
fn camera_info_carries_the_lens_and_zeros_where_there_is_none() {
    let Message::CameraInfo(front) = published("/roadwatch/front/camera_info") else {
        panic!("camera info");
    };
    let Message::CameraInfo(rear) = published("/roadwatch/rear/camera_info") else {
        panic!("camera info");
    };
    assert_eq!(front.distortion_model, "plumb_bob");
    assert_eq!(front.d, [-0.1, 0.01, 0.0, 0.0, 0.0]);
    assert_eq!(
        front.k,
        [465.0, 0.0, 480.5, 0.0, 466.0, 270.25, 0.0, 0.0, 1.0]
    );
    assert_eq!(front.p[..7], [465.0, 0.0, 480.5, 0.0, 0.0, 466.0, 270.25]);
    assert_eq!(
        (rear.distortion_model.as_str(), rear.d.as_slice()),
        ("plumb_bob", &[0.0; 5][..])
    );
}

#[test]
fn tf_static_places_every_camera_with_a_unit_quaternion() {
    let Message::TfStatic(tf) = messages().tf_static(Timestamp::from_nanos(7)).message else {
        panic!("transforms");
    };
    assert_eq!(tf.transforms.len(), 2);
    let rear = &tf.transforms[1];
    assert_eq!(rear.header.frame_id, "base_link");
    assert_eq!(rear.header.stamp.nanosec, 7);
    assert_eq!(rear.child_frame_id, "rear_optical_frame");
    assert_eq!(rear.transform.translation.x, -1.0);
    let q = rear.transform.rotation;
    assert!((q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0).abs() < 1e-12);
}

#[test]
fn autoware_is_told_what_is_known_and_no_more() {
    use crate::msg::autoware_perception_msgs::{
        DetectedObjectKinematics as Kinematics, ObjectClassification as Class, Shape,
    };
    let surface = Surface {
        autoware: true,
        ..Surface::default()
    };
    let messages = Messages::new(Arc::new(testing::two_cameras()), &surface).expect("legal names");
    let outputs = testing::outputs(0);
    let mut sent: Vec<_> = outputs
        .iter()
        .flat_map(|output| messages.of(output))
        .collect();
    let tracked = sent.pop().expect("the scene's last topic");
    let sent = sent.pop().expect("the one before");
    let names = [&sent, &tracked].map(|one| messages.topics()[one.topic].name.as_str());
    assert_eq!(
        names,
        [
            "/roadwatch/scene/detected_objects",
            "/roadwatch/scene/tracked_objects"
        ]
    );
    // Nothing is tracked here, and nothing is said of tracks.
    assert!(matches!(&tracked.message, Message::TrackedObjects(array) if array.objects.is_empty()));
    let Message::DetectedObjects(array) = sent.message else {
        panic!("Autoware's objects");
    };
    let (car, person) = (&array.objects[0], &array.objects[1]);
    assert_eq!(car.classification[0].label, Class::CAR);
    assert_eq!(
        car.kinematics.orientation_availability,
        Kinematics::UNAVAILABLE
    );
    assert_eq!(car.shape.kind, Shape::BOUNDING_BOX);
    assert!(car.kinematics.has_position_covariance && !car.kinematics.has_twist);
    assert_eq!(person.classification[0].label, Class::PEDESTRIAN);
    assert_eq!(
        person.kinematics.orientation_availability,
        Kinematics::AVAILABLE
    );
    assert_eq!(person.shape.kind, Shape::CYLINDER);
}

/// The scene's car as a track that drives along its heading, and the vehicle at a known place.
fn tracked_scene() -> Output {
    use nalgebra::{Isometry3, Matrix2, Vector2, Vector3};
    use roadwatch_core::{
        Ego, EgoKnowledge, Heading, Motion, Phase,
        space::{Covariance, Transform},
    };
    let outputs = testing::outputs(0);
    let Some(Output::Scene(scene)) = outputs.last() else {
        panic!("a scene");
    };
    let mut scene = Scene::clone(scene);
    let car = &mut scene.objects[0];
    let location = car.track.observed.located.location.clone();
    car.track.motion = Some(Motion {
        phase: Phase::Coasting,
        first_seen: Timestamp::from_nanos(testing::START_NS - 2_000_000_000),
        class: car.track.observed.located.detection.class.clone(),
        position: location.position,
        covariance: Covariance::new(location.covariance.matrix),
        size: location.size,
        heading: Some(Heading {
            yaw_rad: 1.0,
            std_dev_rad: 0.1,
            flip_probability: 0.0,
        }),
        velocity_m_s: Vector2::new(1.0_f64.cos(), 1.0_f64.sin()) * 5.0,
        velocity_covariance: Matrix2::identity(),
        acceleration_m_s2: Vector2::zeros(),
        acceleration_covariance: Matrix2::identity(),
        turn_rate_rad_s: 0.25,
        turn_rate_variance: 0.01,
    });
    let turned = Isometry3::new(Vector3::new(100.0, 0.0, 0.0), Vector3::z() * 0.5);
    scene.ego = Ego {
        odom_from_base: Transform::new(turned),
        steady_from_base: Transform::new(Isometry3::identity()),
        knowledge: EgoKnowledge::Measured,
    };
    Output::Scene(Arc::new(scene))
}

fn of_tracked_scene(surface: &Surface, name: &str) -> Message {
    let messages = Messages::new(Arc::new(testing::two_cameras()), surface).expect("legal names");
    let sent = messages.of(&tracked_scene()).into_iter();
    let mut sent = sent.filter(|one| messages.topics()[one.topic].name.ends_with(name));
    sent.next().expect("published").message
}

#[test]
fn a_track_says_who_it_is_how_it_moves_and_that_it_is_predicted() {
    let Message::Objects(array) = of_tracked_scene(&Surface::default(), "scene/objects") else {
        panic!("objects");
    };
    assert_eq!(array.ego_motion, "measured");
    let (car, person) = (&array.objects[0], &array.objects[1]);
    assert_eq!((car.state.as_str(), car.predicted), ("coasting", true));
    assert!((car.age - 2.0).abs() < 0.1 && car.motion_known);
    assert!((car.velocity.y - 5.0 * 1.0_f64.sin()).abs() < 1e-9);
    // Version and variant of RFC 9562.
    assert_eq!((car.uuid.uuid[6] >> 4, car.uuid.uuid[8] >> 6), (8, 2));
    assert_eq!(
        (person.state.as_str(), person.motion_known),
        ("untracked", false)
    );
    assert_eq!(person.uuid.uuid, [0; 16]);
}

#[test]
fn a_scene_in_odom_is_turned_and_moved_with_the_vehicle() {
    let surface = Surface {
        scene_in_odom: Some("odom".to_owned()),
        ..Surface::default()
    };
    let Message::Objects(array) = of_tracked_scene(&surface, "scene/objects") else {
        panic!("objects");
    };
    let car = &array.objects[0];
    assert_eq!(
        (array.header.frame_id.as_str(), car.header.frame_id.as_str()),
        ("odom", "odom")
    );
    // base_link (20, 3) turned by half a radian, 100 m ahead.
    let (sin, cos) = 0.5_f64.sin_cos();
    assert!((car.position.x - (100.0 + 20.0 * cos - 3.0 * sin)).abs() < 1e-9);
    assert!((car.yaw_rad - 1.5).abs() < 1e-9);
    assert!((car.velocity.x - 5.0 * 1.5_f64.cos()).abs() < 1e-9);
}

#[test]
fn autowares_tracks_move_along_their_own_axes() {
    let surface = Surface {
        autoware: true,
        ..Surface::default()
    };
    let Message::TrackedObjects(array) = of_tracked_scene(&surface, "tracked_objects") else {
        panic!("tracks");
    };
    // The person is not tracked here.
    let [car] = &array.objects[..] else {
        panic!("{} tracks", array.objects.len());
    };
    let twist = &car.kinematics.twist_with_covariance.twist;
    assert!((twist.linear.x - 5.0).abs() < 1e-9 && twist.linear.y.abs() < 1e-9);
    assert_eq!(twist.angular.z, 0.25);
    assert!(!car.kinematics.is_stationary);
    // What coasts was not detected.
    let Message::DetectedObjects(detected) = of_tracked_scene(&surface, "detected_objects") else {
        panic!("detections");
    };
    assert_eq!(detected.objects.len(), 1);
}
