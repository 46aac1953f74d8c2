//! Buffers of one call, kept between calls so that no frame allocates them anew.

use crate::{head::RawBox, letterbox::Scratch, nms::Candidate};
use std::sync::{Mutex, PoisonError};

#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(crate) input: Vec<f32>,
    pub(crate) scratch: Scratch,
    /// Raw boxes per image of the batch.
    pub(crate) raw: Vec<Vec<RawBox>>,
    pub(crate) best: Vec<(f32, u16)>,
    pub(crate) candidates: Vec<Candidate>,
}

/// As many workspaces as there are calls at the same time.
#[derive(Debug, Default)]
pub(crate) struct Workspaces(Mutex<Vec<Workspace>>);

impl Workspaces {
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut Workspace) -> R) -> R {
        let free = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut workspace = free().pop().unwrap_or_default();
        let result = work(&mut workspace);
        free().push(workspace);
        result
    }
}
