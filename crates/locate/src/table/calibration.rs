//! Which camera a table belongs to.

use roadwatch_core::RigCamera;
use sha2::{Digest, Sha256};
use std::fmt;

/// Bytes shown to people; enough to tell any two rigs apart.
const SHOWN_BYTES: usize = 4;

/// SHA-256 over image size, intrinsics, distortion, mount and ground height of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CalibrationHash(pub [u8; 32]);

impl CalibrationHash {
    /// The hash of a camera as it is mounted over the ground plane at `ground_z_m`.
    ///
    /// Hashed are, little-endian: width and height (u32), then as f64 fx, fy, cx, cy, the number of
    /// distortion coefficients, they, the mount's position, its rotation matrix by columns, ground z;
    /// before the coefficients stands the name that ROS gives the distortion model.
    #[must_use]
    pub fn of(camera: &RigCamera, ground_z_m: f64) -> Self {
        let model = &camera.model;
        let mut hasher = Sha256::new();
        hasher.update(model.size.width_px.to_le_bytes());
        hasher.update(model.size.height_px.to_le_bytes());
        let k = &model.intrinsics;
        let (lens, coefficients) = model.distortion.to_ros();
        let mount = &camera.base_from_optical.isometry;
        let rotation = mount.rotation.to_rotation_matrix();
        hash_numbers(&mut hasher, [k.fx, k.fy, k.cx, k.cy]);
        hasher.update(lens.as_bytes());
        hash_numbers(&mut hasher, [coefficients.len() as f64]);
        hash_numbers(&mut hasher, coefficients);
        hash_numbers(&mut hasher, mount.translation.vector.iter().copied());
        hash_numbers(&mut hasher, rotation.matrix().iter().copied());
        hash_numbers(&mut hasher, [ground_z_m]);
        Self(hasher.finalize().into())
    }
}

fn hash_numbers(hasher: &mut Sha256, numbers: impl IntoIterator<Item = f64>) {
    for number in numbers {
        // Minus zero is zero: both come from the same calibration.
        hasher.update((number + 0.0).to_le_bytes());
    }
}

impl fmt::Display for CalibrationHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for byte in &self.0[..SHOWN_BYTES] {
            write!(f, "{byte:02x}")?;
        }
        Ok(())
    }
}
