//! The detector of the world: boxes from the truth, spoilt as the imperfections say.

use crate::{
    random::{Purpose, Random},
    view::{Seen, View},
    world::{World, is_noticeable},
};
use roadwatch_core::{
    BoxPx, CameraId, DetectError, Detection, Detector, Frame, ImageSize, ObjectClass, PerFrame,
    Score,
};
use std::sync::Arc;

/// Of what is there.
const TRUE_SCORE: f32 = 0.9;
/// Of what is not.
const FALSE_SCORE: f32 = 0.4;
/// A false alarm overlaps no object by more, so that it is nobody's detection.
const FALSE_ALARM_IOU: f32 = 0.1;
/// Places tried for a false alarm before there is none.
const FALSE_ALARM_TRIES: u32 = 50;

/// Says what a world's frames show.
pub struct WorldDetector {
    world: Arc<World>,
    max_batch: usize,
}

impl WorldDetector {
    /// A detector that takes up to `max_batch` frames at a time.
    #[must_use]
    pub fn new(world: Arc<World>, max_batch: usize) -> Self {
        Self { world, max_batch }
    }

    fn detect_one(&self, frame: Frame) -> PerFrame<Detection> {
        let camera = frame.camera;
        let view = &self.world.views(camera)[frame.seq as usize];
        let found = view
            .objects
            .iter()
            .filter_map(|seen| self.find(camera, view, seen));
        let items = found.chain(self.false_alarm(camera, view)).collect();
        PerFrame { frame, items }
    }

    fn find(&self, camera: CameraId, view: &View, seen: &Seen) -> Option<Detection> {
        let imperfections = self.world.imperfections();
        let dropped = imperfections.drops(camera.index(), view.frame, seen.actor);
        if dropped || !is_noticeable(seen) {
            return None;
        }
        let key = [camera.index() as u64, view.frame, seen.actor as u64];
        let mut random = imperfections.random(Purpose::Jitter, &key);
        let mut moved = |edge_px: f32| edge_px + (random.normal() * imperfections.jitter_px) as f32;
        let exact = seen.silhouette_px;
        let size = self.image_size(camera);
        let (width_px, height_px) = (size.width_px as f32, size.height_px as f32);
        Some(Detection {
            class: ObjectClass::new(&seen.truth.class),
            score: score(TRUE_SCORE),
            input_pixel_px: 1.0,
            box_px: BoxPx::new(
                moved(exact.x_min).clamp(0.0, width_px),
                moved(exact.y_min).clamp(0.0, height_px),
                moved(exact.x_max).clamp(0.0, width_px),
                moved(exact.y_max).clamp(0.0, height_px),
            )?,
        })
    }

    fn false_alarm(&self, camera: CameraId, view: &View) -> Option<Detection> {
        let imperfections = self.world.imperfections();
        let key = [camera.index() as u64, view.frame];
        let mut random = imperfections.random(Purpose::FalseAlarm, &key);
        if random.unit() >= imperfections.false_alarm_share {
            return None;
        }
        let size = self.image_size(camera);
        let free = (0..FALSE_ALARM_TRIES).find_map(|_| {
            let box_px = random_box(&mut random, size)?;
            let overlaps = |seen: &Seen| {
                let truth_px = seen.truth.box_px.unwrap_or(seen.silhouette_px);
                truth_px.iou(&box_px) > FALSE_ALARM_IOU
            };
            (!view.objects.iter().any(overlaps)).then_some(box_px)
        });
        Some(Detection {
            class: ObjectClass::new("car"),
            score: score(FALSE_SCORE),
            input_pixel_px: 1.0,
            box_px: free?,
        })
    }

    fn image_size(&self, camera: CameraId) -> ImageSize {
        self.world.scenario().rig.camera(camera).model.size
    }
}

impl Detector for WorldDetector {
    fn detect(&self, frames: Vec<Frame>) -> Vec<Result<PerFrame<Detection>, DetectError>> {
        let frames = frames.into_iter();
        frames.map(|frame| Ok(self.detect_one(frame))).collect()
    }

    fn max_batch(&self) -> usize {
        self.max_batch
    }
}

/// As large as a car a street's width away, anywhere in the image.
fn random_box(random: &mut Random, size: ImageSize) -> Option<BoxPx> {
    let (width_px, height_px) = (random.between(40.0, 90.0), random.between(30.0, 60.0));
    let x = random.between(0.0, f64::from(size.width_px) - width_px);
    let y = random.between(0.0, f64::from(size.height_px) - height_px);
    BoxPx::new(
        x as f32,
        y as f32,
        (x + width_px) as f32,
        (y + height_px) as f32,
    )
}

fn score(value: f32) -> Score {
    Score::new(value).expect("between 0 and 1")
}
