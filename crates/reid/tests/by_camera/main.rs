//! What left-to-right order promises.

use nalgebra::Matrix3;
use proptest::prelude::*;
use roadwatch_core::{
    BoxPx, CameraId, Detection, Ego, Frame, Heading, HeadingCandidates, Image, ImageSize,
    KeptHeading, Located, Location, Method, ObjectClass, Oriented, PerFrame, Pixels, Prior,
    Reidentifier, Score, SizeLwh, SlopeEvidence, Timestamp, TrackId,
    space::{Covariance, Point},
};
use roadwatch_reid::{ByCamera, Rule};
use std::{
    collections::BTreeSet,
    time::{Duration, Instant},
};

fn frame(camera: u8, millis: i64) -> Frame {
    let size = ImageSize {
        width_px: 1,
        height_px: 1,
    };
    Frame {
        camera: CameraId(camera),
        seq: 0,
        captured_at: Timestamp::from_nanos(millis * 1_000_000),
        received_at: Instant::now(),
        image: Image::decoded(Pixels::new(size, vec![0; 3]).expect("one pixel")),
    }
}

fn detection(class: &str, left_px: f32) -> Detection {
    Detection {
        class: ObjectClass::new(class),
        score: Score::new(0.5).expect("a score"),
        input_pixel_px: 1.0,
        box_px: BoxPx::new(left_px, 0.0, left_px + 10.0, 10.0).expect("a box"),
    }
}

fn measured(x_m: f64) -> Location {
    Location {
        position: Point::new(x_m, 0.0, 0.75),
        covariance: Covariance::new(Matrix3::identity()),
        depth_m: x_m,
        range_m: x_m,
        size: SizeLwh {
            length_m: 5.1,
            width_m: 1.9,
            height_m: 1.5,
        },
        method: Method::Ground,
        headings: HeadingCandidates::default(),
        ground: None,
        held: false,
    }
}

fn oriented(detection: Detection, location: Location) -> Oriented {
    Oriented {
        located: Located {
            detection,
            location,
            slopes: SlopeEvidence::default(),
        },
        heading: None,
        components: Vec::new(),
    }
}

fn seen(camera: u8, millis: i64, detections: &[Detection]) -> PerFrame<Detection> {
    PerFrame {
        frame: frame(camera, millis),
        items: detections.to_vec(),
    }
}

fn cars(lefts_px: &[f32]) -> Vec<Detection> {
    lefts_px
        .iter()
        .map(|&left| detection("car", left))
        .collect()
}

/// Commits detections, each measured at its own left edge as metres.
fn commit(reid: &mut ByCamera, camera: u8, millis: i64, detections: &[Detection]) -> Vec<TrackId> {
    let locate = |one: &Detection| oriented(one.clone(), measured(one.box_px.x_min.into()));
    let tracks = reid.commit(
        PerFrame {
            frame: frame(camera, millis),
            items: detections.iter().map(locate).collect(),
        },
        &[],
        &Ego::default(),
    );
    let same = tracks.items.iter().zip(detections);
    assert!(
        same.clone()
            .all(|(track, one)| track.observed.located.detection == *one)
    );
    tracks.items.iter().map(|track| track.id).collect()
}

/// Remembers nobody yet.
fn left_to_right() -> ByCamera {
    ByCamera::new(Rule::LeftToRight, ByCamera::DEFAULT_GROUND_MEMORY)
}

/// What is remembered of the objects themselves.
fn priors(reid: &ByCamera, seen: &PerFrame<Detection>) -> Vec<Option<Prior>> {
    let known = reid.recall(seen, &Ego::default()).into_iter();
    known.map(|known| known.object).collect()
}

fn remembered_x_m(prior: &Option<Prior>) -> Option<f64> {
    prior.as_ref().map(|prior| prior.location.position.x())
}

#[test]
fn the_nth_from_the_left_keeps_the_nth_identity_and_the_given_order() {
    let mut reid = left_to_right();
    let first = commit(&mut reid, 2, 0, &cars(&[300.0, 100.0, 200.0]));
    let base = 20_000;
    assert_eq!(first, [TrackId(base + 2), TrackId(base), TrackId(base + 1)]);
    let later = commit(&mut reid, 2, 100, &cars(&[110.0, 210.0, 310.0]));
    assert_eq!(later, [TrackId(base), TrackId(base + 1), TrackId(base + 2)]);
}

#[test]
fn recall_gives_the_nth_the_nth_of_the_last_frame_of_the_same_camera() {
    let mut reid = left_to_right();
    commit(&mut reid, 0, 1_000, &cars(&[300.0, 100.0]));
    commit(&mut reid, 1, 1_050, &cars(&[500.0]));
    let recalled = priors(&reid, &seen(0, 1_100, &cars(&[400.0, 320.0, 90.0])));
    let places: Vec<_> = recalled.iter().map(remembered_x_m).collect();
    assert_eq!(places, [None, Some(300.0), Some(100.0)]);
    assert_eq!(
        recalled[1].as_ref().map(|prior| prior.age),
        Some(Duration::from_millis(100))
    );
    assert!(priors(&reid, &seen(7, 0, &cars(&[1.0])))[0].is_none());
}

#[test]
fn another_class_is_somebody_else() {
    let mut reid = left_to_right();
    commit(&mut reid, 0, 0, &cars(&[100.0]));
    let priors = priors(&reid, &seen(0, 100, &[detection("person", 100.0)]));
    assert_eq!(priors, [None]);
}

#[test]
fn a_held_location_keeps_the_stamp_it_was_measured_at() {
    let mut reid = left_to_right();
    commit(&mut reid, 0, 0, &cars(&[100.0]));
    for millis in [100, 200, 300] {
        let priors = priors(&reid, &seen(0, millis, &cars(&[100.0])));
        let prior = priors[0].as_ref().expect("remembered");
        assert_eq!(prior.age, Duration::from_millis(millis.unsigned_abs()));
        assert!(!prior.location.held);
        assert_eq!(prior.location.covariance.matrix, Matrix3::identity());
        let held = Location {
            held: true,
            covariance: Covariance::new(Matrix3::identity() * 9.0),
            ..prior.location.clone()
        };
        reid.commit(
            PerFrame {
                frame: frame(0, millis),
                items: vec![oriented(detection("car", 100.0), held)],
            },
            &[],
            &Ego::default(),
        );
    }
}

#[test]
fn the_last_heading_stays_until_there_is_a_newer_one() {
    let mut reid = left_to_right();
    let heading = Heading {
        yaw_rad: 1.0,
        std_dev_rad: 0.1,
        flip_probability: 0.2,
    };
    let items = vec![Oriented {
        heading: Some(KeptHeading {
            heading,
            age: Duration::ZERO,
        }),
        ..oriented(detection("car", 100.0), measured(100.0))
    }];
    reid.commit(
        PerFrame {
            frame: frame(0, 0),
            items,
        },
        &[],
        &Ego::default(),
    );
    let kept = priors(&reid, &seen(0, 100, &cars(&[100.5])));
    let items = vec![Oriented {
        heading: kept[0].as_ref().and_then(|prior| prior.heading),
        ..oriented(detection("car", 100.5), measured(100.5))
    }];
    reid.commit(
        PerFrame {
            frame: frame(0, 100),
            items,
        },
        &[],
        &Ego::default(),
    );
    let priors = priors(&reid, &seen(0, 200, &cars(&[101.0])));
    assert_eq!(
        priors[0].as_ref().and_then(|prior| prior.heading),
        Some(KeptHeading {
            heading: Heading {
                std_dev_rad: 0.1_f64.hypot(0.5 * 0.2),
                ..heading
            },
            age: Duration::from_millis(200),
        })
    );
}

/// A car at some distance with a heading of this age.
fn car_with_heading(x_m: f64, age: Duration) -> Oriented {
    let heading = Heading {
        yaw_rad: 1.0,
        std_dev_rad: 0.1,
        flip_probability: 0.2,
    };
    Oriented {
        heading: Some(KeptHeading { heading, age }),
        ..oriented(detection("car", 100.0), measured(x_m))
    }
}

#[test]
fn a_kept_heading_stays_with_its_object_and_not_with_its_place_in_the_row() {
    let keeps = |x_m: f64| {
        let mut reid = left_to_right();
        let mut commit = |millis, car| {
            let seen = PerFrame {
                frame: frame(0, millis),
                items: vec![car],
            };
            reid.commit(seen, &[], &Ego::default()).items[0]
                .observed
                .heading
        };
        commit(0, car_with_heading(20.0, Duration::ZERO));
        commit(100, car_with_heading(x_m, Duration::from_millis(100))).is_some()
    };
    assert!(keeps(20.5));
    assert!(!keeps(26.0));
}

#[test]
fn a_heading_is_recalled_only_where_the_object_was() {
    let mut reid = left_to_right();
    let first = PerFrame {
        frame: frame(0, 0),
        items: vec![car_with_heading(20.0, Duration::ZERO)],
    };
    reid.commit(first, &[], &Ego::default());
    let recalled = |left_px: f32| {
        let prior = priors(&reid, &seen(0, 100, &cars(&[left_px])))[0].clone();
        prior.expect("somebody had that place").heading.is_some()
    };
    assert!(recalled(104.0));
    assert!(!recalled(300.0));
}

#[test]
fn an_empty_frame_forgets_everybody_and_what_is_still_to_come_is_no_memory() {
    let mut reid = left_to_right();
    commit(&mut reid, 0, 1_000, &cars(&[100.0]));
    let early = priors(&reid, &seen(0, 900, &cars(&[100.0])));
    assert_eq!(early, [None]);
    commit(&mut reid, 0, 1_100, &[]);
    assert_eq!(priors(&reid, &seen(0, 1_200, &cars(&[100.0]))), [None]);
}

/// Whole pixels, so that equal middles occur.
fn lefts() -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec((0..30_u8).prop_map(f32::from), 0..40)
}

proptest! {
    #[test]
    fn identities_are_unique_and_ascend_from_left_to_right(lefts in lefts(), camera in 0..255_u8) {
        let ids = commit(&mut left_to_right(), camera, 0, &cars(&lefts));
        prop_assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), lefts.len());
        for (a, id_a) in lefts.iter().zip(&ids) {
            for (b, id_b) in lefts.iter().zip(&ids) {
                prop_assert!(a >= b || id_a < id_b);
            }
        }
        let places: BTreeSet<_> = ids.iter().map(|id| id.0 % 10_000).collect();
        prop_assert!(places.into_iter().eq(0..lefts.len() as u64));
    }

    #[test]
    fn the_same_frame_again_recalls_each_object_as_itself(lefts in lefts()) {
        let mut reid = left_to_right();
        let mut items = Vec::new();
        for (number, one) in cars(&lefts).into_iter().enumerate() {
            items.push(oriented(one, measured(number as f64)));
        }
        reid.commit(PerFrame { frame: frame(0, 0), items }, &[], &Ego::default());
        let priors = priors(&reid, &seen(0, 0, &cars(&lefts)));
        for (number, prior) in priors.iter().enumerate() {
            prop_assert_eq!(remembered_x_m(prior), Some(number as f64));
        }
    }
}

#[test]
fn what_got_no_location_keeps_its_place_in_the_row() {
    let mut reid = left_to_right();
    let row = cars(&[100.0, 200.0, 300.0]);
    let located = PerFrame {
        frame: frame(0, 0),
        items: row[1..]
            .iter()
            .map(|car| oriented(car.clone(), measured(f64::from(car.box_px.x_min))))
            .collect(),
    };
    let tracks = reid.commit(located, &row[..1], &Ego::default());
    assert_eq!(
        tracks
            .items
            .iter()
            .map(|track| track.id.0)
            .collect::<Vec<_>>(),
        [1, 2]
    );
    let priors = priors(&reid, &seen(0, 100, &row));
    let places: Vec<_> = priors
        .iter()
        .map(|prior| prior.as_ref().map(|prior| prior.location.range_m))
        .collect();
    assert_eq!(places, [None, Some(200.0), Some(300.0)]);
}

#[test]
fn by_overlap_a_car_keeps_its_identity_when_another_enters_and_when_it_is_missed() {
    let mut reid = ByCamera::new(Rule::Overlap, ByCamera::DEFAULT_GROUND_MEMORY);
    let [old] = commit(&mut reid, 2, 0, &cars(&[100.0]))[..] else {
        panic!("one car");
    };
    let both = commit(&mut reid, 2, 100, &cars(&[20.0, 102.0]));
    assert_eq!(both[1], old);
    assert_ne!(both[0], old);
    assert_eq!(commit(&mut reid, 2, 200, &cars(&[21.0])), both[..1]);
    assert_eq!(commit(&mut reid, 2, 300, &cars(&[103.0])), [old]);
    // After a second without it, it is somebody new, whose identity nobody ever had.
    let late = commit(&mut reid, 2, 1500, &cars(&[103.0]));
    assert!(!late.contains(&old) && !both.contains(&late[0]));
    // Another camera's are others.
    assert_ne!(commit(&mut reid, 3, 1500, &cars(&[103.0])), late);
}

#[test]
fn by_overlap_what_is_remembered_follows_the_object() {
    let mut reid = ByCamera::new(Rule::Overlap, ByCamera::DEFAULT_GROUND_MEMORY);
    commit(&mut reid, 0, 0, &cars(&[100.0]));
    let now = seen(0, 100, &cars(&[20.0, 102.0]));
    let priors = priors(&reid, &now);
    assert_eq!(remembered_x_m(&priors[0]), None);
    assert_eq!(remembered_x_m(&priors[1]), Some(100.0));
    // Time that goes back is another recording.
    let before = seen(0, -5000, &cars(&[101.0]));
    assert_eq!(reid.recall(&before, &Ego::default())[0].object, None);
}
