//! Rows from labelled images.

use super::pictures::{self, LABELS_FILE, PictureSetError};
use crate::truth::{Truth, TruthError, TruthObject};
use roadwatch_camera::{DatasetError, Recording as _, RigDataset};
use roadwatch_core::{
    BoxPx, Image, SourceError, error_chain,
    rig::LooksVertical,
    space::{BaseLink, CameraGround, Transform},
};
use roadwatch_rotate::{LabelledRow, RayAngle, RowTable, Yaw, estimator::RowReader};
use std::{collections::HashMap, path::Path};

/// Places are told on the plane, so any height of it will do.
pub(super) const LEVEL_M: f64 = 0.0;

/// Which labelled objects become rows, and how far off their boxes are.
#[derive(Clone, Debug, PartialEq)]
pub struct RowFilter {
    /// Their classes.
    pub classes: Vec<String>,
    /// Least height of the box, pixels.
    pub min_height_px: f64,
    /// Greatest hidden share, 0 to 1.
    pub max_occluded: f64,
    /// Greatest share outside the image, 0 to 1.
    pub max_truncated: f64,
    /// Standard deviation of each edge, as a share of the box's height: a detector's boxes are not exact.
    pub edge_noise: f64,
    /// Draws that noise.
    pub seed: u64,
}

impl Default for RowFilter {
    /// What the daemon meets: not hidden for the most part, edges off by three per cent.
    fn default() -> Self {
        Self {
            classes: ["car", "truck", "bus"].map(str::to_owned).to_vec(),
            min_height_px: 20.0,
            max_occluded: 0.5,
            max_truncated: 0.2,
            edge_noise: 0.03,
            seed: 1,
        }
    }
}

/// Labelled images that give no rows.
#[derive(Debug, thiserror::Error)]
pub enum RowSourceError {
    /// A folder of pictures.
    #[error(transparent)]
    Pictures(#[from] PictureSetError),
    /// A rig dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// Its labels.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// Its images.
    #[error("an image cannot be read: {}", error_chain(.0))]
    Source(#[from] SourceError),
    /// A camera's pose.
    #[error(transparent)]
    Pose(#[from] LooksVertical),
    /// An image that cannot be decoded, or a network that failed.
    #[error("{0}")]
    Failed(String),
}

/// Takes rows out of labelled folders.
pub struct RowsFrom<'a> {
    reader: &'a mut RowReader,
    filter: &'a RowFilter,
    random: fastrand::Rng,
    table: RowTable,
}

impl<'a> RowsFrom<'a> {
    /// Nothing read yet.
    pub fn new(reader: &'a mut RowReader, filter: &'a RowFilter) -> Self {
        let network = reader.network();
        Self {
            random: fastrand::Rng::with_seed(filter.seed),
            table: RowTable {
                components: network.components().to_vec(),
                facing_bins: network.facing_bins(),
                rows: Vec::new(),
            },
            reader,
            filter,
        }
    }

    /// Adds the rows of a folder: a rig dataset, or labelled pictures. `progress` hears of each image, and of how
    /// many there are.
    ///
    /// # Errors
    /// See [`RowSourceError`].
    pub fn add(
        &mut self,
        folder: &Path,
        mut progress: impl FnMut(u64, u64),
    ) -> Result<(), RowSourceError> {
        if folder.join(LABELS_FILE).is_file() {
            let pictures = pictures::read(folder)?;
            let total = pictures.len() as u64;
            for (picture, done) in pictures.zip(1..) {
                let picture = picture?;
                self.image(&picture.image, picture.ground, &picture.objects)?;
                progress(done, total);
            }
            return Ok(());
        }
        let dataset = RigDataset::open(folder)?;
        let truth = Truth::read(folder)?;
        let total = (dataset.frames().len() * dataset.cameras().len()) as u64;
        let mut done = 0;
        for (at, camera) in dataset.cameras().iter().enumerate() {
            let frames = dataset.frames().iter();
            let numbers: HashMap<_, _> = frames
                .filter_map(|frame| Some(((*frame.stamps.get(at)?)?, frame.number)))
                .collect();
            let Some(recording) = dataset.recording(at) else {
                continue;
            };
            let mut recording = recording?;
            let ground = camera.base_from_ground(LEVEL_M)?;
            while let Some(stamp) = recording.next_stamp()? {
                let image = recording.take_image()?;
                if let Some(&number) = numbers.get(&stamp) {
                    let objects = truth.objects(number, camera.name.as_str());
                    self.image(&image, ground, objects)?;
                }
                done += 1;
                progress(done, total);
            }
        }
        Ok(())
    }

    /// All rows.
    #[must_use]
    pub fn finish(self) -> RowTable {
        self.table
    }

    fn image(
        &mut self,
        image: &Image,
        ground: Transform<BaseLink, CameraGround>,
        objects: &[TruthObject],
    ) -> Result<(), RowSourceError> {
        let usable: Vec<(&TruthObject, Yaw, BoxPx)> = objects
            .iter()
            .filter_map(|object| {
                let yaw = Yaw::new(object.yaw_rad?);
                Some((object, yaw, self.filter.usable(object)?))
            })
            .collect();
        if usable.is_empty() {
            return Ok(());
        }
        let boxes: Vec<BoxPx> = usable
            .iter()
            .map(|(_, _, exact)| self.seen(exact))
            .collect();
        let failed = |what: String| RowSourceError::Failed(what);
        let pixels = image.pixels().map_err(|error| failed(error.to_string()))?;
        let found = self.reader.read(pixels, &boxes).map_err(failed)?;
        for ((object, yaw, exact), seen) in usable.into_iter().zip(found) {
            let Some(seen) = seen else { continue };
            let away = object.center.coords - ground.origin().coords;
            self.table.rows.push(LabelledRow {
                row: seen.row,
                angle: yaw.seen_along(RayAngle::towards(away.x, away.y)),
                place: ground.inverse() * object.center,
                box_height_px: exact.height_px().into(),
            });
        }
        Ok(())
    }

    /// A box as a detector gives it.
    fn seen(&mut self, exact: &BoxPx) -> BoxPx {
        let std_px = self.filter.edge_noise as f32 * exact.height_px();
        let mut off = || std_px * normal(&mut self.random);
        let (x_min, y_min, x_max, y_max) = (off(), off(), off(), off());
        let moved = BoxPx::new(
            exact.x_min + x_min,
            exact.y_min + y_min,
            exact.x_max + x_max,
            exact.y_max + y_max,
        );
        moved.unwrap_or(*exact)
    }
}

impl RowFilter {
    /// The box of an object that becomes a row.
    fn usable(&self, object: &TruthObject) -> Option<BoxPx> {
        let box_px = object.seen_px()?;
        let wanted = self.classes.contains(&object.class)
            && f64::from(box_px.height_px()) >= self.min_height_px
            && object.occluded <= self.max_occluded
            && object.truncated <= self.max_truncated;
        wanted.then_some(box_px)
    }
}

/// A draw from the standard normal distribution (Box and Muller).
fn normal(random: &mut fastrand::Rng) -> f32 {
    let radius = (-2.0 * (1.0 - random.f32()).ln()).sqrt();
    radius * (std::f32::consts::TAU * random.f32()).cos()
}
