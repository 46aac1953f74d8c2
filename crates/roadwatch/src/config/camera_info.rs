//! `camera_info`: a lens from ROS's YAML, named by URL or path.

use super::{environment::Environment, reader::Reader};
use roadwatch_camera::CameraInfo;
use roadwatch_core::{CameraModel, ImageSize, error_chain};
use std::path::PathBuf;

/// The key in a `[[camera]]` table.
pub(super) const KEY: &str = "camera_info";
/// Where ROS 2 packages are installed: prefixes, with a colon between.
const PREFIXES: &str = "AMENT_PREFIX_PATH";

/// The lens that the table's `camera_info` names; `None` when there is no such key, or a mistake, which is
/// noted. Images must be `expected` in size where that is known.
pub(super) fn read(table: &Reader<'_, '_>, expected: Option<ImageSize>) -> Option<CameraModel> {
    let file = file(table)?;
    let info = CameraInfo::read(&file).map_err(|error| table.note(KEY, error_chain(&error)));
    let model = info.ok()?.model;
    match expected.filter(|&expected| expected != model.size) {
        None => Some(model),
        Some(expected) => {
            let what = format!(
                "`{}` is for images of {}, the camera's are {expected}",
                file.display(),
                model.size
            );
            table.note(KEY, what);
            None
        }
    }
}

fn file(table: &Reader<'_, '_>) -> Option<PathBuf> {
    let text = table.text(KEY)?;
    let file = match text.split_once("://") {
        None => return table.path(KEY),
        Some(("file", path)) if path.starts_with('/') => Ok(PathBuf::from(path)),
        Some(("file", _)) => Err(format!(
            "`{text}` names no absolute path: write file:///… with three slashes"
        )),
        Some(("package", path)) => in_package(path, table.document().environment()),
        Some((scheme, _)) => Err(format!(
            "`{scheme}://` is unknown: use file:///…, package://PACKAGE/… or a path"
        )),
    };
    file.map_err(|what| table.note(KEY, what)).ok()
}

/// A file of a ROS 2 package's share folder: the first prefix that has the package.
fn in_package(path: &str, environment: &Environment) -> Result<PathBuf, String> {
    let (package, inside) = path
        .split_once('/')
        .filter(|(package, inside)| !package.is_empty() && !inside.is_empty())
        .ok_or_else(|| format!("`package://{path}` names no file: package://PACKAGE/PATH"))?;
    let prefixes = environment.get(PREFIXES).ok_or_else(|| {
        format!("`package://{path}` needs {PREFIXES}, which is not set: source the ROS 2 workspace")
    })?;
    let shares = prefixes
        .split(':')
        .map(|prefix| PathBuf::from(prefix).join("share").join(package));
    let share = { shares }
        .find(|share| share.is_dir())
        .ok_or_else(|| format!("no package `{package}` in {PREFIXES} ({prefixes})"))?;
    Ok(share.join(inside))
}
