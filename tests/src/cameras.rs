//! Cameras of the world: frames whose images show nothing.

use crate::world::World;
use roadwatch_core::{CameraId, Frame, FrameSource, Image, ImageSize, Pixels, SourceError};
use std::{
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError},
    },
    time::Instant,
};

/// When a camera hands out its next frame.
#[derive(Debug)]
pub enum Release {
    /// As soon as it is asked.
    AtOnce,
    /// One frame for each signal; its end when nobody can signal any more.
    OnSignal(Receiver<()>),
}

/// One camera of a world. Its frames carry one black pixel: the detector knows what they show.
pub struct WorldCamera {
    world: Arc<World>,
    camera: CameraId,
    next: usize,
    release: Release,
    image: Image,
}

impl WorldCamera {
    /// A camera before its first frame.
    ///
    /// # Panics
    /// Never: one pixel has three bytes.
    #[must_use]
    pub fn new(world: Arc<World>, camera: CameraId, release: Release) -> Self {
        let size = ImageSize {
            width_px: 1,
            height_px: 1,
        };
        Self {
            world,
            camera,
            next: 0,
            release,
            image: Image::decoded(Pixels::new(size, vec![0; 3]).expect("a pixel")),
        }
    }
}

impl FrameSource for WorldCamera {
    fn next_frame(&mut self, deadline: Instant) -> Result<Frame, SourceError> {
        if let Release::OnSignal(signals) = &self.release {
            let left = deadline.saturating_duration_since(Instant::now());
            match signals.recv_timeout(left) {
                Ok(()) => {}
                Err(RecvTimeoutError::Timeout) => return Err(SourceError::Timeout),
                Err(RecvTimeoutError::Disconnected) => return Err(SourceError::EndOfStream),
            }
        }
        let views = self.world.views(self.camera);
        let view = views.get(self.next).ok_or(SourceError::EndOfStream)?;
        self.next += 1;
        let imperfections = self.world.imperfections();
        if imperfections.loses(self.camera.index(), view.frame) {
            return Err(SourceError::FrameLost("the world wants it so".into()));
        }
        Ok(Frame {
            camera: self.camera,
            seq: view.frame,
            captured_at: view.captured_at,
            received_at: Instant::now(),
            image: self.image.clone(),
        })
    }
}
