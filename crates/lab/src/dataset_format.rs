//! How a labelled dataset is laid out.

use crate::{
    kitti::{self, KittiError},
    truth::{Truth, TruthError},
};
use roadwatch_camera::{DatasetError, RigDataset};
use std::path::Path;

/// How a labelled dataset is laid out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum DatasetFormat {
    /// `rig.toml`, `frames.jsonl`, `truth.jsonl` and images or clips per camera.
    #[default]
    Rig,
    /// KITTI's object layout: `image_2`, `calib`, `label_2`.
    Kitti,
}

/// A dataset that cannot be opened or has no usable labels.
#[derive(Debug, thiserror::Error)]
pub enum OpenDatasetError {
    /// A rig dataset.
    #[error(transparent)]
    Rig(#[from] DatasetError),
    /// Its labels.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// A folder in KITTI's layout.
    #[error(transparent)]
    Kitti(#[from] KittiError),
}

impl DatasetFormat {
    /// Every format, with its name in configurations.
    pub const ALL: [(&'static str, Self); 2] = [("rig", Self::Rig), ("kitti", Self::Kitti)];

    /// Reads everything but the labels.
    ///
    /// # Errors
    /// When the folder is not laid out so, or something in it is wrong.
    pub fn open(self, folder: &Path) -> Result<RigDataset, OpenDatasetError> {
        Ok(match self {
            Self::Rig => RigDataset::open(folder)?,
            Self::Kitti => kitti::open(folder)?,
        })
    }

    /// Reads the labels of a dataset of this format.
    ///
    /// # Errors
    /// When there are none, or something in them is wrong.
    pub fn read_truth(self, dataset: &RigDataset) -> Result<Truth, OpenDatasetError> {
        Ok(match self {
            Self::Rig => Truth::read(dataset.folder())?,
            Self::Kitti => kitti::read_truth(dataset)?,
        })
    }
}
