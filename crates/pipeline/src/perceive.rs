//! The perceiving step: from detections to objects with place, heading and identity, for the whole rig.

use roadwatch_core::{
    Detection, EgoMotion, Frame, Heading, KeptHeading, Known, Located, Locator, Oriented, PerFrame,
    Perceived, Reidentifier, RotationError, RotationEstimator, Round, Scene,
};
use std::{
    cmp::Reverse,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

/// Locators, headings and memory. One synchronous step per frame; no thread, no clock, no I/O.
pub struct Perceiver {
    /// One per camera, in order of their ids.
    pub locators: Vec<Box<dyn Locator>>,
    /// Headings; `None` where nobody estimates any.
    pub rotation: Option<Rotating>,
    /// The only memory.
    pub reidentifier: Box<dyn Reidentifier>,
    /// Where the vehicle is; told by whoever knows, and not at all by nobody.
    pub ego: Arc<EgoMotion>,
}

/// How headings are estimated.
pub struct Rotating {
    /// The estimator.
    pub estimator: Box<dyn RotationEstimator>,
    /// Most objects of a frame that are looked at: those that are longest without a heading of their own first.
    /// May be changed while it runs.
    pub crops_per_frame: Arc<AtomicUsize>,
}

impl Perceiver {
    /// Recall, locate, rotate, commit. With the error that left a frame without new headings, if one did.
    pub fn perceive(
        &mut self,
        seen: PerFrame<Detection>,
    ) -> (Perceived, Result<(), RotationError>) {
        let ego = self.ego.at(seen.frame.captured_at);
        let known = self.reidentifier.recall(&seen, &ego);
        let PerFrame { frame, items } = seen;
        let locator = &self.locators[frame.camera.index()];
        let mut objects = Vec::with_capacity(items.len());
        let mut unlocated = Vec::new();
        for (detection, known) in items.into_iter().zip(known) {
            match locator.locate(&detection, &known) {
                Some(location) => {
                    let slopes = known.slopes;
                    let located = Located {
                        detection,
                        location,
                        slopes,
                    };
                    objects.push(with_kept_heading(located, &known));
                }
                None => unlocated.push(detection),
            }
        }
        let rotated = match &mut self.rotation {
            Some(rotating) => rotating.rotate(&frame, &mut objects),
            None => Ok(()),
        };
        let objects = PerFrame {
            frame,
            items: objects,
        };
        let tracks = self.reidentifier.commit(objects, &unlocated, &ego);
        let perceived = Perceived {
            tracks,
            unlocated,
            ego,
        };
        (perceived, rotated)
    }

    /// Every object of a completed round.
    pub fn scene(&mut self, round: &Round) -> Scene {
        let ego = self.ego.at(round.stamp);
        Scene {
            seq: round.seq,
            stamp: round.stamp,
            ego,
            objects: self.reidentifier.scene(round, &ego),
        }
    }
}

impl Rotating {
    /// Looks at as many objects as the budget allows.
    fn rotate(&mut self, frame: &Frame, objects: &mut [Oriented]) -> Result<(), RotationError> {
        let chosen = self.chosen(objects);
        if chosen.is_empty() {
            return Ok(());
        }
        let before = |object: &Oriented| object.heading.map(|kept| kept.heading);
        let asked: Vec<(&Located, Option<Heading>)> = chosen
            .iter()
            .map(|&at| (&objects[at].located, before(&objects[at])))
            .collect();
        let rotations = self.estimator.estimate(frame, &asked)?;
        for (at, rotation) in chosen.into_iter().zip(rotations) {
            if let Some(rotation) = rotation {
                let object = &mut objects[at];
                object.heading = Some(KeptHeading {
                    heading: rotation.heading,
                    age: Duration::ZERO,
                });
                object.components = rotation.components;
            }
        }
        Ok(())
    }

    /// Those without a heading first, then those whose heading is oldest, then in the detector's order.
    fn chosen(&self, objects: &[Oriented]) -> Vec<usize> {
        let wanted = (0..objects.len()).filter(|&at| self.estimator.wants(&objects[at].located));
        let mut wanted: Vec<usize> = wanted.collect();
        let age = |at: usize| objects[at].heading.map_or(Duration::MAX, |kept| kept.age);
        wanted.sort_by_key(|&at| Reverse(age(at)));
        wanted.truncate(self.crops_per_frame.load(Ordering::Relaxed));
        wanted
    }
}

/// An object as it is before anybody looks which way it points.
fn with_kept_heading(located: Located, known: &Known) -> Oriented {
    Oriented {
        located,
        heading: known.object.as_ref().and_then(|prior| prior.heading),
        components: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;
    use roadwatch_core::{
        BoxPx, CameraId, HeadingCandidates, Image, ImageSize, Location, Method, ObjectClass,
        Pixels, Rotation, Score, SizeLwh, SlopeEvidence, Timestamp,
        space::{Covariance, Point},
    };
    use std::{
        sync::{Arc, Mutex},
        time::Instant,
    };

    /// Notes which objects it was asked for, by the left edges of their boxes.
    struct Asked(Arc<Mutex<Vec<f32>>>);

    impl RotationEstimator for Asked {
        fn wants(&self, located: &Located) -> bool {
            located.detection.class.as_str() == "car"
        }

        fn estimate(
            &mut self,
            _: &Frame,
            objects: &[(&Located, Option<Heading>)],
        ) -> Result<Vec<Option<Rotation>>, RotationError> {
            let lefts = objects
                .iter()
                .map(|(located, _)| located.detection.box_px.x_min);
            self.0.lock().expect("alone").extend(lefts);
            Ok(objects.iter().map(|_| None).collect())
        }
    }

    fn object(left: f32, class: &str, heading_age_millis: Option<u64>) -> Oriented {
        let detection = Detection {
            class: ObjectClass::new(class),
            score: Score::new(0.5).expect("a score"),
            input_pixel_px: 1.0,
            box_px: BoxPx::new(left, 0.0, left + 10.0, 10.0).expect("a box"),
        };
        let heading = heading_age_millis.map(|millis| KeptHeading {
            heading: Heading {
                yaw_rad: 0.0,
                std_dev_rad: 0.1,
                flip_probability: 0.0,
            },
            age: Duration::from_millis(millis),
        });
        let located = Located {
            detection,
            location: Location {
                position: Point::new(10.0, 0.0, 0.8),
                covariance: Covariance::new(Matrix3::identity()),
                depth_m: 10.0,
                range_m: 10.0,
                size: SizeLwh {
                    length_m: 4.6,
                    width_m: 1.85,
                    height_m: 1.6,
                },
                method: Method::Fused,
                headings: HeadingCandidates::default(),
                ground: None,
                held: false,
            },
            slopes: SlopeEvidence::default(),
        };
        Oriented {
            heading,
            ..with_kept_heading(located, &Known::default())
        }
    }

    fn frame() -> Frame {
        let size = ImageSize {
            width_px: 1,
            height_px: 1,
        };
        Frame {
            camera: CameraId(0),
            seq: 0,
            captured_at: Timestamp::from_nanos(0),
            received_at: Instant::now(),
            image: Image::decoded(Pixels::new(size, vec![0; 3]).expect("a pixel")),
        }
    }

    #[test]
    fn those_longest_without_a_heading_are_looked_at_first_and_no_more_than_the_budget() {
        let asked = Arc::new(Mutex::new(Vec::new()));
        let mut rotating = Rotating {
            estimator: Box::new(Asked(Arc::clone(&asked))),
            crops_per_frame: Arc::new(AtomicUsize::new(3)),
        };
        let mut objects = [
            object(1.0, "car", Some(100)),
            object(2.0, "car", None),
            object(3.0, "person", None),
            object(4.0, "car", Some(300)),
            object(5.0, "car", Some(200)),
        ];
        rotating.rotate(&frame(), &mut objects).expect("asked");
        assert_eq!(*asked.lock().expect("alone"), [2.0, 4.0, 5.0]);
        assert_eq!(
            objects[0].heading.map(|kept| kept.age),
            Some(Duration::from_millis(100))
        );
    }
}
