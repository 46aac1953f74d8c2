//! Counting decodes, so that "a dropped frame is never decoded" can be measured.

use roadwatch_core::{DecodeError, DecodeImage, Pixels};
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

/// How often images were decoded. Clones share the count.
#[derive(Clone, Debug, Default)]
pub struct DecodeCount(Arc<AtomicU64>);

impl DecodeCount {
    /// Decodes begun so far, failed ones included.
    #[must_use]
    pub fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    fn add_one(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// An image whose decoding is counted.
#[derive(Debug)]
pub struct Counted<D> {
    image: D,
    count: DecodeCount,
}

impl<D: DecodeImage> Counted<D> {
    /// The same image; each decode adds one to `count`.
    #[must_use]
    pub fn new(image: D, count: DecodeCount) -> Self {
        Self { image, count }
    }
}

impl<D: DecodeImage> DecodeImage for Counted<D> {
    fn decode(&self) -> Result<Pixels, DecodeError> {
        self.count.add_one();
        self.image.decode()
    }

    fn as_file(&self) -> Option<&[u8]> {
        self.image.as_file()
    }
}
