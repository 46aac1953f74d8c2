//! What tracking promises, whatever comes.

mod ring;

use nalgebra::{Isometry3, Vector2, Vector3};
use ring::{at, ego, heading, ring, seen};
use roadwatch_core::{Ego, EgoMotion, PerFrame, Phase, Reidentifier as _, Rig, Round, Track};
use roadwatch_reid::{Tracker, TrackingOptions};
use std::sync::Arc;

struct Watched {
    rig: Arc<Rig>,
    tracker: Tracker,
}

impl Watched {
    fn new() -> Self {
        let rig = Arc::new(ring(6));
        let tracker = Tracker::new(Arc::clone(&rig), TrackingOptions::default());
        Self { rig, tracker }
    }

    fn look(
        &mut self,
        camera: u8,
        millis: i64,
        ego: &Ego,
        places: &[(f64, f64)],
    ) -> PerFrame<Track> {
        let seen = seen(&self.rig, camera, at(millis), (ego, places));
        self.tracker.commit(seen, &[], ego)
    }

    /// One car seen by the front camera every tenth of a second.
    fn follow(&mut self, millis: std::ops::Range<i64>, x_m: impl Fn(f64) -> f64) -> Vec<Track> {
        let looks = millis.step_by(100).flat_map(|millis| {
            let place = (x_m(millis as f64 / 1e3), 2.0);
            self.look(0, millis, &ego(0.0, 0.0), &[place]).items
        });
        looks.collect()
    }
}

fn motion(track: &Track) -> &roadwatch_core::Motion {
    track.motion.as_ref().expect("tracked")
}

#[test]
fn a_car_is_tentative_then_confirmed_with_its_speed() {
    let tracks = Watched::new().follow(0..3_000, |t| 12.0 + 5.0 * t);
    assert!(tracks.iter().all(|track| track.id == tracks[0].id));
    assert_eq!(motion(&tracks[1]).phase, Phase::Tentative);
    assert_eq!(motion(&tracks[2]).phase, Phase::Confirmed);
    let last = motion(tracks.last().expect("seen"));
    let off = last.velocity_m_s - Vector2::new(5.0, 0.0);
    assert!(off.norm() < 0.3, "{last:?}");
    assert_eq!(last.first_seen, at(0));
    // Nothing but its motion says which way it points.
    let heading = last.heading.expect("it drives");
    assert!(heading.yaw_rad.abs() < 0.1 && heading.flip_probability < 0.1);
}

#[test]
fn what_is_hidden_coasts_and_comes_back_as_itself() {
    let mut watched = Watched::new();
    let before = watched.follow(0..2_000, |t| 15.0 + 3.0 * t);
    let round = Round {
        seq: 0,
        stamp: at(2_500),
        perceived: Vec::new(),
    };
    let scene = watched.tracker.scene(&round, &ego(0.0, 0.0));
    let coasting = &scene[0];
    assert_eq!(motion(&coasting.track).phase, Phase::Coasting);
    assert!((coasting.track.position().x() - 22.5).abs() < 0.5);
    assert_eq!((coasting.stamp, coasting.seen_at), (at(2_500), at(1_900)));
    let after = watched.follow(3_500..3_700, |t| 15.0 + 3.0 * t);
    assert_eq!(after[0].id, before[0].id);
}

#[test]
fn a_late_frame_is_put_where_it_belongs() {
    let place = |millis: i64| [(12.0 + 5.0 * millis as f64 / 1e3, 2.0)];
    let (mut in_order, mut late) = (Watched::new(), Watched::new());
    let still = ego(0.0, 0.0);
    for millis in (0..1_000).step_by(100) {
        in_order.look(0, millis, &still, &place(millis));
        if millis != 700 {
            late.look(0, millis, &still, &place(millis));
        }
    }
    late.look(0, 700, &still, &place(700));
    let [one, other] = [&mut in_order, &mut late]
        .map(|watched| watched.look(0, 1_000, &still, &place(1_000)).items[0].clone());
    let off = one.position().coords - other.position().coords;
    assert!(off.norm() < 1e-6, "{off}");
    assert_eq!(late.tracker.late(), 0);
    // Half a second is all that is kept.
    late.look(0, 300, &still, &place(300));
    assert_eq!(late.tracker.late(), 1);
}

#[test]
fn what_is_seen_first_keeps_its_name_when_an_earlier_frame_comes_late() {
    let (mut watched, still) = (Watched::new(), ego(0.0, 0.0));
    let looks = [(0, 100), (1, 60), (0, 200)];
    // Where two cameras see it.
    let places = [(12.0, 7.0)];
    let tracks = looks.map(|(camera, millis)| {
        let seen = watched.look(camera, millis, &still, &places);
        seen.items[0].clone()
    });
    assert!(tracks.iter().all(|one| one.id == tracks[0].id));
    assert!(tracks.iter().all(|one| motion(one).first_seen == at(100)));
}

#[test]
fn a_parked_car_stands_while_the_vehicle_drives_past_and_turns() {
    let mut watched = Watched::new();
    let parked = [(20.0, 4.0)];
    let mut ids = Vec::new();
    for step in 0..30_i64 {
        let vehicle = ego(0.8 * step as f64, 0.01 * step as f64);
        for camera in 0..6 {
            let tracks = watched.look(
                camera,
                step * 100 + i64::from(camera) * 10,
                &vehicle,
                &parked,
            );
            ids.extend(tracks.items.iter().map(|track| track.id));
            for track in tracks.items.iter().filter(|_| step > 20) {
                assert!(motion(track).speed_m_s() < 0.3, "{:?}", motion(track));
            }
        }
    }
    assert!(
        ids.len() > 15 && ids.iter().all(|id| *id == ids[0]),
        "{ids:?}"
    );
}

#[test]
fn motion_turns_a_heading_that_is_the_wrong_way_round() {
    let mut watched = Watched::new();
    let still = ego(0.0, 0.0);
    let mut last = None;
    for millis in (0..3_000).step_by(100) {
        let place = [(12.0 + 5.0 * millis as f64 / 1e3, 2.0)];
        let mut frame = seen(&watched.rig, 0, at(millis), (&still, &place));
        frame.items[0].heading = heading(std::f64::consts::PI, 0.3);
        last = watched.tracker.commit(frame, &[], &still).items.pop();
    }
    let track = last.expect("seen");
    let heading = motion(&track).heading.expect("looked at");
    assert!(heading.yaw_rad.abs() < 0.2, "{heading:?}");
}

#[test]
fn without_the_vehicles_motion_nothing_is_said_of_headings() {
    let mut watched = Watched::new();
    for millis in (0..2_000).step_by(100) {
        let place = [(12.0 + 5.0 * millis as f64 / 1e3, 2.0)];
        let tracks = watched.look(0, millis, &Ego::default(), &place);
        assert_eq!(motion(&tracks.items[0]).heading, None);
    }
}

#[test]
fn odometry_that_begins_late_or_jumps_leaves_objects_where_they_are() {
    let mut watched = Watched::new();
    let motion = EgoMotion::default();
    let pose = |x_m: f64, yaw_rad: f64| {
        Isometry3::new(Vector3::new(x_m, 40.0, 0.0), Vector3::z() * yaw_rad)
    };
    let mut ids = Vec::new();
    for millis in (0..3_000).step_by(100) {
        // Nobody tells for a second; then far away from any origin, then from another one.
        match millis {
            ..1_000 => {}
            1_000..2_000 => motion.tell(at(millis), pose(500.0, 1.0)).expect("a pose"),
            _ => motion.tell(at(millis), pose(-900.0, 2.0)).expect("a pose"),
        }
        // The car stands ahead of a vehicle that stands, whatever is told.
        let frame = seen(
            &watched.rig,
            0,
            at(millis),
            (&ego(0.0, 0.0), &[(15.0, 2.0)]),
        );
        let told = motion.at(at(millis));
        ids.extend(
            watched
                .tracker
                .commit(frame, &[], &told)
                .items
                .into_iter()
                .map(|one| one.id),
        );
        let round = Round {
            seq: 0,
            stamp: at(millis),
            perceived: Vec::new(),
        };
        for object in watched.tracker.scene(&round, &told) {
            let off = object.track.position().coords - nalgebra::Point3::new(15.0, 2.0, 0.8);
            assert!(off.norm() < 0.5, "{millis}: {off}");
        }
    }
    assert!(ids.len() == 30 && ids.iter().all(|id| *id == ids[0]));
    assert_eq!(motion.counts().jumps, 1);
}

#[test]
fn numbers_that_are_none_are_not_believed() {
    let mut watched = Watched::new();
    let still = ego(0.0, 0.0);
    watched.follow(0..1_000, |t| 12.0 + t);
    for (millis, spoilt) in [(1_000, f64::NAN), (1_100, f64::INFINITY)] {
        let mut frame = seen(&watched.rig, 0, at(millis), (&still, &[(13.0, 2.0)]));
        frame.items[0].located.location.position =
            roadwatch_core::space::Point::new(spoilt, 2.0, 0.8);
        watched.tracker.commit(frame, &[], &still);
    }
    let tracks = watched.look(0, 1_200, &still, &[(13.2, 2.0)]);
    for track in &tracks.items {
        let motion = motion(track);
        let numbers = motion
            .position
            .coords
            .iter()
            .chain(motion.velocity_m_s.iter());
        assert!(
            numbers
                .chain(motion.covariance.matrix.iter())
                .all(|one| one.is_finite())
        );
    }
}

#[test]
fn three_hundred_boxes_a_frame_leave_memory_bounded() {
    let rig = Arc::new(ring(6));
    let options = TrackingOptions {
        most_objects: 200,
        ..TrackingOptions::default()
    };
    let mut tracker = Tracker::new(Arc::clone(&rig), options);
    let still = ego(0.0, 0.0);
    for step in 0..10_i64 {
        // Other places every time, so that nobody is anybody.
        let places: Vec<(f64, f64)> = (0..300)
            .map(|n| {
                (
                    8.0 + f64::from(n % 20) * 3.0 + step as f64 * 1.3,
                    f64::from(n / 20) * 3.0 - 22.0,
                )
            })
            .collect();
        let frame = seen(&rig, 0, at(step * 100), (&still, &places));
        tracker.commit(frame, &[], &still);
        assert!(tracker.len() <= 200);
    }
}

#[test]
fn a_recording_that_begins_anew_knows_nobody() {
    let mut watched = Watched::new();
    let before = watched.follow(10_000..11_000, |_| 12.0);
    let after = watched.follow(0..300, |_| 12.0);
    assert_ne!(after[0].id, before[0].id);
}
