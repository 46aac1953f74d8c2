//! A camera that says nothing any more, at realtime pace.

use roadwatch_core::{CameraId, Method, Output, Scene};
use roadwatch_tests::{Imperfections, Stepped, World, scenes::two_cameras, world::is_noticeable};
use std::{sync::Arc, time::Duration};

/// Short, so that the test is.
const SCENE_TIMEOUT: Duration = Duration::from_millis(20);

const SILENT: CameraId = CameraId(0);
const SPEAKING: CameraId = CameraId(1);

/// The next scene, and the cameras whose frames came before it.
fn next_scene(stepped: &Stepped) -> (Vec<CameraId>, Arc<Scene>) {
    let mut cameras = Vec::new();
    loop {
        match stepped.next_output() {
            Output::Camera(perceived) => cameras.push(perceived.tracks.frame.camera),
            Output::Scene(scene) => return (cameras, scene),
        }
    }
}

#[test]
fn a_silent_camera_does_not_stop_the_scene() {
    let world = World::new(two_cameras(20), Imperfections::default());
    let stepped = Stepped::start(&world, world.locators(Method::Ground), SCENE_TIMEOUT);
    stepped.release(SILENT);
    stepped.release(SPEAKING);
    let mut heard = Vec::new();
    while heard.len() < 2 {
        heard.extend(next_scene(&stepped).0);
    }
    for frame in 1..6 {
        stepped.release(SPEAKING);
        let (cameras, scene) = next_scene(&stepped);
        let view = &world.views(SPEAKING)[frame];
        assert_eq!(cameras, [SPEAKING]);
        assert_eq!(scene.stamp, view.captured_at);
        let seen = view.objects.iter().filter(|seen| is_noticeable(seen));
        assert_eq!(scene.objects.len(), seen.count());
        assert!(
            scene
                .objects
                .iter()
                .all(|object| object.seen_by == [SPEAKING])
        );
    }
    let counts = stepped.running().metrics().camera(SPEAKING);
    assert_eq!((counts.published, counts.dropped_total()), (6, 0));
}
