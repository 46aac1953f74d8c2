//! The perceiving step: from detections to objects with place and identity, for the whole rig.

use roadwatch_core::{Detection, Located, Locator, Oriented, PerFrame, Perceived, Reidentifier};

/// Locators and memory. One synchronous step per frame; no thread, no clock, no I/O.
pub struct Perceiver {
    /// One per camera, in order of their ids.
    pub locators: Vec<Box<dyn Locator>>,
    /// The only memory of objects.
    pub reidentifier: Box<dyn Reidentifier>,
}

impl Perceiver {
    /// Recall, locate, commit. Headings have no estimator yet, so each is `None`.
    pub fn perceive(&mut self, seen: PerFrame<Detection>) -> Perceived {
        let known = self.reidentifier.recall(&seen);
        let PerFrame { frame, items } = seen;
        let locator = &self.locators[frame.camera.index()];
        let mut located = Vec::with_capacity(items.len());
        let mut unlocated = Vec::new();
        for (detection, known) in items.into_iter().zip(known) {
            match locator.locate(&detection, &known) {
                Some(location) => located.push(Oriented {
                    located: Located {
                        detection,
                        location,
                        slopes: known.slopes,
                    },
                    heading: None,
                }),
                None => unlocated.push(detection),
            }
        }
        let located = PerFrame {
            frame,
            items: located,
        };
        let tracks = self.reidentifier.commit(located, &unlocated);
        Perceived { tracks, unlocated }
    }
}
