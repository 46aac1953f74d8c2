//! Headings that fail: the frame goes on without new ones, is counted, and the next is asked again.

mod support;

use nalgebra::Matrix3;
use roadwatch_core::{
    CameraId, Detection, Frame, Heading, HeadingCandidates, Known, Located, Location, Locator,
    Method, Rotation, RotationError, RotationEstimator, SizeLwh,
    space::{Covariance, Point},
};
use roadwatch_pipeline::{
    NamedSink, Overload, PipelineOptions, Stages,
    perceive::{Perceiver, Rotating},
    start,
};
use std::sync::{Arc, Mutex, atomic::AtomicUsize, mpsc::sync_channel};
use support::{ChannelSink, ChannelSource, NoMemory, OneBoxDetector, PATIENCE, RealClock};

/// Places everything 20 m ahead.
struct Ahead;

impl Locator for Ahead {
    fn locate(&self, _: &Detection, _: &Known) -> Option<Location> {
        Some(Location {
            position: Point::new(20.0, 0.0, 0.8),
            covariance: Covariance::new(Matrix3::identity()),
            depth_m: 20.0,
            range_m: 20.0,
            size: SizeLwh {
                length_m: 4.5,
                width_m: 1.8,
                height_m: 1.5,
            },
            method: Method::Ground,
            headings: HeadingCandidates::default(),
            ground: None,
            held: false,
        })
    }
}

/// Fails every other time.
struct EveryOther(Arc<Mutex<u32>>);

impl RotationEstimator for EveryOther {
    fn wants(&self, _: &Located) -> bool {
        true
    }

    fn estimate(
        &mut self,
        _: &Frame,
        objects: &[(&Located, Option<Heading>)],
    ) -> Result<Vec<Option<Rotation>>, RotationError> {
        let mut calls = self.0.lock().expect("calls");
        *calls += 1;
        if calls.is_multiple_of(2) {
            return Err(RotationError::new("the network fell over"));
        }
        Ok(objects.iter().map(|_| None).collect())
    }
}

#[test]
fn a_frame_without_headings_is_counted_and_published_all_the_same() {
    const FRAMES: i64 = 6;
    let (camera, stamps) = sync_channel(FRAMES as usize);
    let (sender, outputs) = sync_channel(1000);
    let calls = Arc::new(Mutex::new(0));
    let stages = Stages {
        sources: vec![Box::new(ChannelSource::new(CameraId(0), stamps))],
        detector: Arc::new(OneBoxDetector {
            gate: None,
            max_batch: 1,
            batches: Arc::default(),
        }),
        perceiver: Perceiver {
            locators: vec![Box::new(Ahead)],
            rotation: Some(Rotating {
                estimator: Box::new(EveryOther(Arc::clone(&calls))),
                crops_per_frame: Arc::new(AtomicUsize::new(1)),
            }),
            reidentifier: Box::new(NoMemory),
            ego: Arc::default(),
        },
        sinks: vec![NamedSink {
            name: "channel".to_owned(),
            sink: Box::new(ChannelSink(sender)),
        }],
    };
    let options = PipelineOptions::new(Overload::Wait);
    let running = start(stages, options, Arc::new(RealClock)).expect("starts");
    for stamp in 0..FRAMES {
        camera.send(stamp * 10).expect("the source lives");
    }
    drop(camera);
    running.wait(PATIENCE).expect("no panic");
    let counts = running.metrics().camera(CameraId(0));
    let frames = outputs.try_iter().filter(|(camera, _)| camera.is_some());
    assert_eq!(frames.count(), FRAMES as usize);
    assert_eq!((counts.published, counts.unrotated), (6, 3));
    assert_eq!(*calls.lock().expect("calls"), 6);
}
