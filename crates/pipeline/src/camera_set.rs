//! A set of cameras, small enough to travel with every frame.

use roadwatch_core::CameraId;

const BITS: usize = u64::BITS as usize;
const WORDS: usize = (u8::MAX as usize + 1) / BITS;

/// A set of [`CameraId`]s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CameraSet([u64; WORDS]);

impl CameraSet {
    /// Adds a camera.
    pub fn insert(&mut self, camera: CameraId) {
        self.0[camera.index() / BITS] |= 1 << (camera.index() % BITS);
    }

    /// Whether every camera of this set is in `other`.
    #[must_use]
    pub fn is_subset(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).all(|(a, b)| a & !b == 0)
    }
}

impl FromIterator<CameraId> for CameraSet {
    fn from_iter<I: IntoIterator<Item = CameraId>>(cameras: I) -> Self {
        let mut set = Self::default();
        for camera in cameras {
            set.insert(camera);
        }
        set
    }
}
