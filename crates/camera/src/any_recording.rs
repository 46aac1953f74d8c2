//! A recording of any kind, for those who only learn at start which kind it is.

use crate::{
    counted::DecodeCount, image_sequence::ImageSequence, player::Recording, span::Span,
    video_file::VideoFile,
};
use roadwatch_core::{Image, SourceError, Timestamp};

/// A recording of any kind, opened.
#[derive(Debug)]
pub enum AnyRecording {
    /// Still images.
    Images(ImageSequence),
    /// A video file.
    Video(VideoFile),
}

impl AnyRecording {
    /// The same recording; every decode of a still image adds one to `decodes`. Videos are not counted, for
    /// their frames are decoded whether anyone looks or not.
    #[must_use]
    pub fn counting(self, decodes: DecodeCount) -> Self {
        match self {
            Self::Images(images) => Self::Images(images.counting(decodes)),
            video @ Self::Video(_) => video,
        }
    }

    fn kind(&mut self) -> &mut dyn Recording {
        match self {
            Self::Images(images) => images,
            Self::Video(video) => video,
        }
    }
}

impl Recording for AnyRecording {
    fn span(&self) -> Span {
        match self {
            Self::Images(images) => images.span(),
            Self::Video(video) => video.span(),
        }
    }

    fn next_stamp(&mut self) -> Result<Option<Timestamp>, SourceError> {
        self.kind().next_stamp()
    }

    fn take_image(&mut self) -> Result<Image, SourceError> {
        self.kind().take_image()
    }

    fn rewind(&mut self) -> Result<(), SourceError> {
        self.kind().rewind()
    }
}
