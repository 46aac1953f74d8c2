//! Other ways to give identities, tried on the very objects that were recorded.

use crate::recorder::Recorded;
use roadwatch_core::{Ego, Frame, Image, ImageSize, PerFrame, Pixels, Reidentifier};
use std::time::Instant;

/// A way to give identities that knows nothing of motion.
pub struct Baseline {
    /// Its name.
    pub name: String,
    /// Fresh from the start.
    pub reidentifier: Box<dyn Reidentifier>,
}

impl Baseline {
    /// The same objects with its identities, and its name.
    pub(crate) fn rename(mut self, recorded: &[Recorded]) -> (String, Vec<Recorded>) {
        let mut seq = 0;
        let renamed = recorded.iter().map(|frame| {
            let observed = frame.tracks.iter().map(|track| track.observed.clone());
            let seen = PerFrame {
                frame: without_image(frame, seq),
                items: observed.collect(),
            };
            seq += 1;
            let tracks = self
                .reidentifier
                .commit(seen, &frame.unlocated, &Ego::default());
            Recorded {
                tracks: tracks.items,
                ..frame.clone()
            }
        });
        let renamed = renamed.collect();
        (self.name, renamed)
    }
}

/// Identities are given without looking at the image, so any will do.
fn without_image(frame: &Recorded, seq: u64) -> Frame {
    let size = ImageSize {
        width_px: 1,
        height_px: 1,
    };
    let black = Pixels::new(size, vec![0; 3]);
    Frame {
        camera: frame.camera,
        seq,
        captured_at: frame.captured_at,
        received_at: Instant::now(),
        image: black.map_or_else(|_| unreachable!("three bytes make a pixel"), Image::decoded),
    }
}
