//! A mount with its deviations, and which of its six numbers a fit may move.

use nalgebra::{DMatrix, DVector};
use roadwatch_core::Mount;

/// One of the six numbers of a mount.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// Position along base_link's x, metres.
    X,
    /// Position along y, metres.
    Y,
    /// Height in base_link, metres.
    Z,
    /// About z, radians.
    Yaw,
    /// About y, radians.
    Pitch,
    /// About x, radians.
    Roll,
}

/// Standard deviations of a mount; `None` for what was held where it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MountStd {
    /// Of the position, metres.
    pub position_m: [Option<f64>; 3],
    /// Of the yaw, radians.
    pub yaw_rad: Option<f64>,
    /// Of the pitch, radians.
    pub pitch_rad: Option<f64>,
    /// Of the roll, radians.
    pub roll_rad: Option<f64>,
}

/// A mount as it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountEstimate {
    /// The mount.
    pub mount: Mount,
    /// How far off it may be.
    pub std: MountStd,
}

impl Free {
    /// Step of slopes by differences: far below what is looked for, far above rounding.
    pub(crate) const STEP: f64 = 1e-5;

    fn of(self, mount: &mut Mount) -> &mut f64 {
        let [x, y, z] = &mut mount.position_m;
        match self {
            Self::X => x,
            Self::Y => y,
            Self::Z => z,
            Self::Yaw => &mut mount.yaw_rad,
            Self::Pitch => &mut mount.pitch_rad,
            Self::Roll => &mut mount.roll_rad,
        }
    }

    fn std_of(self, std: &mut MountStd) -> &mut Option<f64> {
        let [x, y, z] = &mut std.position_m;
        match self {
            Self::X => x,
            Self::Y => y,
            Self::Z => z,
            Self::Yaw => &mut std.yaw_rad,
            Self::Pitch => &mut std.pitch_rad,
            Self::Roll => &mut std.roll_rad,
        }
    }

    /// The mount with its free numbers moved by `by`.
    pub(crate) fn moved(free: &[Self], mount: &Mount, by: &DVector<f64>) -> Mount {
        let mut moved = *mount;
        for (number, by) in free.iter().zip(by.iter()) {
            *number.of(&mut moved) += by;
        }
        moved
    }

    /// The deviations that a covariance of the free numbers means.
    pub(crate) fn deviations(free: &[Self], covariance: &DMatrix<f64>) -> MountStd {
        let mut std = MountStd::default();
        for (at, number) in free.iter().enumerate() {
            *number.std_of(&mut std) = Some(covariance[(at, at)].sqrt());
        }
        std
    }
}
