//! What one round of six cameras costs: recall, commit and the scene.

#[path = "../tests/tracker/ring.rs"]
#[expect(dead_code, reason = "the tests use all of it")]
mod ring;

use divan::{Bencher, counter::ItemsCount};
use ring::{at, ego, frame, ring, seen};
use roadwatch_core::{Detection, PerFrame, Perceived, Reidentifier as _, Rig, Round};
use roadwatch_reid::{Tracker, TrackingOptions};
use std::{f64::consts::TAU, sync::Arc};

/// Rounds until every object is confirmed and its memory full.
const WARM_UP: i64 = 20;

fn main() {
    divan::main();
}

/// Around the vehicle, no two at one place, driving in circles.
fn places(count: usize, round: i64) -> Vec<(f64, f64)> {
    (0..count)
        .map(|one| {
            let turn = one as f64 / count as f64 + round as f64 * 0.002;
            let range_m = 12.0 + (one % 7) as f64 * 6.0;
            let (sin, cos) = (TAU * turn).sin_cos();
            (range_m * cos, range_m * sin)
        })
        .collect()
}

fn round(tracker: &mut Tracker, rig: &Rig, count: usize, number: i64) -> usize {
    let (ego, places) = (ego(0.0, 0.0), places(count, number));
    let mut perceived = Vec::new();
    for camera in 0..6 {
        let stamp = at(number * 100 + i64::from(camera) * 15);
        let seen = seen(rig, camera, stamp, (&ego, &places));
        let detections: Vec<Detection> = seen
            .items
            .iter()
            .map(|one| one.located.detection.clone())
            .collect();
        let detected = PerFrame {
            frame: frame(camera, stamp),
            items: detections,
        };
        tracker.recall(&detected, &ego);
        perceived.push(Arc::new(Perceived {
            tracks: tracker.commit(seen, &[], &ego),
            unlocated: Vec::new(),
            ego,
        }));
    }
    let stamp = at(number * 100 + 75);
    let round = Round {
        seq: 0,
        stamp,
        perceived,
    };
    tracker.scene(&round, &ego).len()
}

#[divan::bench(args = [25, 100, 300])]
fn one_round(bencher: Bencher<'_, '_>, count: usize) {
    let rig = Arc::new(ring(6));
    let mut tracker = Tracker::new(Arc::clone(&rig), TrackingOptions::default());
    for number in 0..WARM_UP {
        round(&mut tracker, &rig, count, number);
    }
    let mut number = WARM_UP;
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        number += 1;
        round(&mut tracker, &rig, count, number)
    });
}

/// What of that is the bench's own: making what cameras see.
#[divan::bench(args = [25, 100, 300])]
fn seeing_alone(bencher: Bencher<'_, '_>, count: usize) {
    let rig = ring(6);
    let (ego, places) = (ego(0.0, 0.0), places(count, 0));
    bencher.bench_local(|| {
        let seen = (0..6).map(|camera| seen(&rig, camera, at(0), (&ego, &places)).items.len());
        seen.sum::<usize>()
    });
}
