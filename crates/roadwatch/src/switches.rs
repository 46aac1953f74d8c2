//! Which cameras are looked at: all of an active node that are enabled.

use roadwatch_core::{CameraId, Frame, FrameSource, Output, Sink, SinkError, SourceError};
use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

/// One switch per camera, and one for all of them.
#[derive(Clone, Debug)]
pub struct Switches {
    active: Arc<AtomicBool>,
    cameras: Vec<Arc<AtomicBool>>,
}

impl Switches {
    /// All active; one camera for each entry of `enabled`.
    #[must_use]
    pub fn new(enabled: &[bool]) -> Self {
        let switch = |&on: &bool| Arc::new(AtomicBool::new(on));
        Self {
            active: Arc::new(AtomicBool::new(true)),
            cameras: enabled.iter().map(switch).collect(),
        }
    }

    /// Whether the node is to look at anything at all.
    pub fn set_active(&self, active: bool) {
        self.active.store(active, Ordering::Relaxed);
    }

    /// Whether the node looks at anything at all.
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.active.load(Ordering::Relaxed)
    }

    /// Whether one camera is to be looked at while the node is active.
    pub fn set_enabled(&self, camera: CameraId, enabled: bool) {
        self.cameras[camera.index()].store(enabled, Ordering::Relaxed);
    }

    /// Whether one camera is looked at while the node is active.
    #[must_use]
    pub fn is_enabled(&self, camera: CameraId) -> bool {
        self.cameras[camera.index()].load(Ordering::Relaxed)
    }

    /// Sources, in order of their cameras' ids, that give nothing while they are switched off.
    #[must_use]
    pub fn put_before(&self, sources: Vec<Box<dyn FrameSource>>) -> Vec<Box<dyn FrameSource>> {
        let pairs = sources.into_iter().zip(&self.cameras);
        pairs
            .map(|(source, enabled)| {
                let switched = Switched {
                    source,
                    active: Arc::clone(&self.active),
                    enabled: Arc::clone(enabled),
                };
                Box::new(switched) as Box<dyn FrameSource>
            })
            .collect()
    }
}

impl Switches {
    /// A sink that publishes only while the node is active: what is still on its way when that ends stays unsaid.
    #[must_use]
    pub fn put_behind(&self, sink: Box<dyn Sink>) -> Box<dyn Sink> {
        Box::new(Gated {
            sink,
            active: Arc::clone(&self.active),
        })
    }
}

struct Gated {
    sink: Box<dyn Sink>,
    active: Arc<AtomicBool>,
}

impl Sink for Gated {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        match self.active.load(Ordering::Relaxed) {
            true => self.sink.publish(output),
            false => Ok(()),
        }
    }

    fn finish(&mut self) -> Result<(), SinkError> {
        self.sink.finish()
    }
}

/// A source behind its switches. It goes on while they are off, so that what comes after is new; its frames are as if
/// they had never been.
struct Switched {
    source: Box<dyn FrameSource>,
    active: Arc<AtomicBool>,
    enabled: Arc<AtomicBool>,
}

impl FrameSource for Switched {
    fn next_frame(&mut self, deadline: Instant) -> Result<Frame, SourceError> {
        let frame = self.source.next_frame(deadline)?;
        if self.active.load(Ordering::Relaxed) && self.enabled.load(Ordering::Relaxed) {
            Ok(frame)
        } else {
            Err(SourceError::Timeout)
        }
    }
}
