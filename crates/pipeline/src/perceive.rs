//! The perceiving step: from detections to objects with place, heading and identity, for the whole rig.

use roadwatch_core::{
    Detection, Frame, Heading, KeptHeading, Known, Located, Locator, Oriented, PerFrame, Perceived,
    Reidentifier, RotationError, RotationEstimator,
};
use std::{cmp::Reverse, time::Duration};

/// Locators, headings and memory. One synchronous step per frame; no thread, no clock, no I/O.
pub struct Perceiver {
    /// One per camera, in order of their ids.
    pub locators: Vec<Box<dyn Locator>>,
    /// Headings; `None` where nobody estimates any.
    pub rotation: Option<Rotating>,
    /// The only memory.
    pub reidentifier: Box<dyn Reidentifier>,
}

/// How headings are estimated.
pub struct Rotating {
    /// The estimator.
    pub estimator: Box<dyn RotationEstimator>,
    /// Most objects of a frame that are looked at: those that are longest without a heading of their own first.
    pub crops_per_frame: usize,
}

impl Perceiver {
    /// Recall, locate, rotate, commit. With the error that left a frame without new headings, if one did.
    pub fn perceive(
        &mut self,
        seen: PerFrame<Detection>,
    ) -> (Perceived, Result<(), RotationError>) {
        let known = self.reidentifier.recall(&seen);
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
        let tracks = self.reidentifier.commit(objects, &unlocated);
        (Perceived { tracks, unlocated }, rotated)
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
        wanted.truncate(self.crops_per_frame);
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
