//! KITTI's object layout as a rig dataset: `image_2`, `calib`, `label_2` (Geiger, Lenz and Urtasun, CVPR 2012, and the
//! object development kit's readme).
//!
//! **Spaces.** KITTI gives labels in the rectified frame of its camera 0. base_link is that frame with its axes turned
//! to x forward, y left, z up: its origin is the camera, so the ground lies 1.65 m *below* it, which the configuration
//! says (`rig.ground_z_m = -1.65`). Camera 2 sits where P2's fourth column puts it.
//!
//! **Calibrations.** KITTI's images come from several drives, each with a calibration and an image size of its own. Every
//! different one becomes a camera of the rig: `image_2`, then `image_2_1`, `image_2_2` and so on.
//!
//! **Time.** The images are no sequence. Each camera's are played ten seconds apart, so that nothing is remembered from
//! one to the next.

mod calibration;
mod error;
mod label;

pub use error::{CalibrationProblem, KittiError, LabelProblem};

use crate::truth::Truth;
use calibration::Calibration;
use roadwatch_camera::{DatasetImage, RigDataset, StampedFile};
use roadwatch_core::{CameraModel, CameraName, Distortion, ImageSize, Mount, RigCamera, Timestamp};
use std::{
    fs,
    path::{Path, PathBuf},
};

const IMAGES: &str = "image_2";
const CALIBRATIONS: &str = "calib";
const LABELS: &str = "label_2";
const IMAGE_EXTENSIONS: [&str; 3] = ["png", "jpg", "jpeg"];
/// Longer than anything that remembers objects, nanoseconds.
const INTERVAL_NANOS: i64 = 10_000_000_000;

/// An image with its number.
struct NumberedImage {
    number: u64,
    stem: String,
    file: PathBuf,
}

/// Reads which images there are and how each was taken. Labels are not looked at.
///
/// # Errors
/// When images or their calibrations are missing, or one of them is wrong.
pub fn open(folder: &Path) -> Result<RigDataset, KittiError> {
    let mut kinds: Vec<(Calibration, ImageSize, usize)> = Vec::new();
    let mut images = Vec::new();
    for NumberedImage { number, stem, file } in numbered_images(&folder.join(IMAGES))? {
        let calibration =
            Calibration::read(&folder.join(CALIBRATIONS).join(format!("{stem}.txt")))?;
        let size = image_size(&file)?;
        let known = kinds
            .iter()
            .position(|(known, known_size, _)| (known, known_size) == (&calibration, &size));
        let camera = known.unwrap_or_else(|| {
            kinds.push((calibration, size, 0));
            kinds.len() - 1
        });
        kinds[camera].2 += 1;
        let stamp = Timestamp::from_nanos(kinds[camera].2 as i64 * INTERVAL_NANOS);
        images.push(DatasetImage {
            camera,
            number,
            image: StampedFile { file, stamp },
        });
    }
    let cameras = kinds.iter().enumerate();
    let cameras = cameras.map(|(at, (calibration, size, _))| camera(at, calibration, *size));
    let cameras = cameras.collect::<Result<Vec<_>, _>>()?;
    if cameras.len() > usize::from(u8::MAX) {
        return Err(KittiError::TooManyCalibrations {
            folder: folder.to_owned(),
            count: cameras.len(),
        });
    }
    Ok(RigDataset::from_images(folder, cameras, images)?)
}

/// Reads the labels of a dataset that [`open`] gave.
///
/// # Errors
/// When an image has no labels, or a line of them is wrong, with file and line.
pub fn read_truth(dataset: &RigDataset) -> Result<Truth, KittiError> {
    let frames = dataset.frames();
    let mut images = Vec::new();
    for NumberedImage { number, stem, .. } in numbered_images(&dataset.folder().join(IMAGES))? {
        let labels = label::read(
            &dataset.folder().join(LABELS).join(format!("{stem}.txt")),
            &stem,
        )?;
        let found = frames.binary_search_by_key(&number, |frame| frame.number);
        let camera = found
            .ok()
            .and_then(|at| frames[at].stamps.iter().position(Option::is_some));
        // An image that came after the dataset was opened is none of it.
        if let Some(camera) = camera {
            let name = dataset.cameras()[camera].name.to_string();
            images.push(((number, name), labels));
        }
    }
    Ok(images.into_iter().collect())
}

fn camera(at: usize, calibration: &Calibration, size: ImageSize) -> Result<RigCamera, KittiError> {
    let name = match at {
        0 => IMAGES.to_owned(),
        at => format!("{IMAGES}_{at}"),
    };
    let name = CameraName::new(&name).map_err(KittiError::Name)?;
    let [x, y, z] = calibration.optical_center_m;
    Ok(RigCamera {
        name,
        model: CameraModel {
            size,
            intrinsics: calibration.intrinsics,
            distortion: Distortion::None,
        },
        // From camera axes (x right, y down, z ahead) to base_link's.
        base_from_optical: Mount::ahead([z, -x, -y]).base_from_optical(),
        measured_focal: None,
    })
}

/// The images of a folder, in order of their numbers.
fn numbered_images(folder: &Path) -> Result<Vec<NumberedImage>, KittiError> {
    let unreadable = |cause| KittiError::Unreadable {
        file: folder.to_owned(),
        cause,
    };
    let mut images = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        let extension = file.extension().and_then(|extension| extension.to_str());
        if !extension.is_some_and(|found| IMAGE_EXTENSIONS.contains(&found)) {
            continue;
        }
        let stem = file
            .file_stem()
            .and_then(|stem| stem.to_str())
            .unwrap_or_default();
        let Ok(number) = stem.parse() else {
            return Err(KittiError::ImageName { file });
        };
        images.push(NumberedImage {
            number,
            stem: stem.to_owned(),
            file,
        });
    }
    images.sort_by_key(|image| image.number);
    if images.is_empty() {
        return Err(KittiError::NoImages {
            folder: folder.to_owned(),
        });
    }
    Ok(images)
}

fn image_size(file: &Path) -> Result<ImageSize, KittiError> {
    let size = imagesize::size(file).map_err(|cause| KittiError::Image {
        file: file.to_owned(),
        cause,
    })?;
    Ok(ImageSize {
        width_px: u32::try_from(size.width).unwrap_or(u32::MAX),
        height_px: u32::try_from(size.height).unwrap_or(u32::MAX),
    })
}

#[cfg(test)]
mod tests;
