//! Playing a recording as a frame source: numbering, laps, limits and waiting, the same for every kind.

use crate::{
    playback::{Due, Playback, Repeat},
    span::Span,
};
use roadwatch_core::{CameraId, Frame, FrameSource, Image, SourceError, Timestamp};
use std::{sync::Arc, time::Instant};

/// What one camera once saw, frame by frame. Knows stamps and images, not when to hand them out.
pub trait Recording: Send {
    /// The time it covers.
    fn span(&self) -> Span;

    /// The stamp of the frame that [`Recording::take_image`] gives next, the same until it is taken;
    /// `None` behind the last. Stamps rise.
    ///
    /// # Errors
    /// When the recording cannot be read any more.
    fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError>;

    /// The image of the frame whose stamp [`Recording::next_stamp`] gave. Moves on to the frame after it, also
    /// when this one is lost.
    ///
    /// # Errors
    /// [`SourceError::FrameLost`] when this frame is missing or damaged.
    fn take_image(&mut self) -> Result<Image, SourceError>;

    /// Goes back to the first frame.
    ///
    /// # Errors
    /// When the recording cannot be opened again.
    fn rewind(&mut self) -> Result<(), SourceError>;
}

impl Recording for Box<dyn Recording> {
    fn span(&self) -> Span {
        self.as_ref().span()
    }

    fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError> {
        self.as_mut().next_stamp()
    }

    fn take_image(&mut self) -> Result<Image, SourceError> {
        self.as_mut().take_image()
    }

    fn rewind(&mut self) -> Result<(), SourceError> {
        self.as_mut().rewind()
    }
}

/// A recording as one camera of the rig.
#[derive(Debug)]
pub struct Player<R> {
    camera: CameraId,
    recording: R,
    span: Span,
    playback: Arc<Playback>,
    seq: u64,
    lap: u32,
}

impl<R: Recording> Player<R> {
    /// A source that plays `recording` as `camera`, by a clock that it shares with the rig's other cameras.
    #[must_use]
    pub fn new(camera: CameraId, recording: R, playback: Arc<Playback>) -> Self {
        Self {
            camera,
            span: recording.span(),
            recording,
            playback,
            seq: 0,
            lap: 0,
        }
    }

    fn next_stamp(&mut self) -> Result<Timestamp, SourceError> {
        if let Some(stamp) = self.stamp_in_lap()? {
            return Ok(stamp);
        }
        if self.playback.options().repeat == Repeat::Once {
            return Err(SourceError::EndOfStream);
        }
        self.recording.rewind()?;
        self.lap += 1;
        self.stamp_in_lap()?.ok_or(SourceError::EndOfStream)
    }

    /// The next stamp of this lap, moved to the lap's time. A looped recording that outlasts the span it
    /// announced (a video whose header is wrong) is cut there, because its stamps would reach into the next lap.
    fn stamp_in_lap(&mut self) -> Result<Option<Timestamp>, SourceError> {
        let Some(stamp) = self.recording.next_stamp()? else {
            return Ok(None);
        };
        let lap = self.playback.lap();
        let repeats = self.playback.options().repeat == Repeat::Loop;
        if repeats && stamp.saturating_since(self.span.first) >= lap {
            return Ok(None);
        }
        Ok(Some(stamp.saturating_add(lap.saturating_mul(self.lap))))
    }

    fn is_at_limit(&self) -> bool {
        let limit = self.playback.options().frame_limit;
        limit.is_some_and(|limit| self.seq >= limit)
    }
}

impl<R: Recording> FrameSource for Player<R> {
    /// A lost frame uses up its number, so a gap in `seq` is a frame that was captured and is not there.
    fn next_frame(&mut self, deadline: Instant) -> Result<Frame, SourceError> {
        if self.is_at_limit() {
            return Err(SourceError::EndOfStream);
        }
        let captured_at = self.next_stamp()?;
        if self.playback.wait_until_due(captured_at, deadline) == Due::NotYet {
            return Err(SourceError::Timeout);
        }
        let seq = self.seq;
        self.seq += 1;
        let image = self.recording.take_image()?;
        Ok(Frame {
            camera: self.camera,
            seq,
            captured_at,
            received_at: Instant::now(),
            image,
        })
    }
}
