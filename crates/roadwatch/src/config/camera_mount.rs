//! Where a camera sits: `position_m` and `orientation_wxyz`.

use super::reader::Reader;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use roadwatch_core::space::{BaseLink, Optical, Transform};

/// How far a quaternion's length may be from 1: what printing it with four digits costs.
const UNIT_TOLERANCE: f64 = 1e-3;

/// `None` when either is missing or wrong; every mistake is noted.
pub(super) fn read(table: &Reader<'_, '_>) -> Option<Transform<BaseLink, Optical>> {
    let position = table.numbers::<3>("position_m");
    let orientation = read_orientation(table);
    if !table.has("position_m") {
        table.note(
            "position_m",
            "missing: the camera's place in base_link, [x, y, z] in metres",
        );
    }
    let [x, y, z] = position?;
    let mount = Isometry3::from_parts(Translation3::new(x, y, z), orientation?);
    Some(Transform::new(mount))
}

fn read_orientation(table: &Reader<'_, '_>) -> Option<UnitQuaternion<f64>> {
    const KEY: &str = "orientation_wxyz";
    if !table.has(KEY) {
        table.note(
            KEY,
            "missing: the quaternion [w, x, y, z] that turns optical axes into base_link's",
        );
    }
    let [w, x, y, z] = table.numbers::<4>(KEY)?;
    let quaternion = Quaternion::new(w, x, y, z);
    if (quaternion.norm() - 1.0).abs() > UNIT_TOLERANCE {
        table.note(
            KEY,
            format!("a rotation has length 1; this has {:.4}", quaternion.norm()),
        );
        return None;
    }
    Some(UnitQuaternion::from_quaternion(quaternion))
}
