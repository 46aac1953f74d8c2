//! A run compared with the labels of its dataset.

use crate::{failure::Failure, session::Session};
use anyhow::{Context as _, anyhow};
use roadwatch_camera::RigDataset;
use roadwatch_core::Rig;
use roadwatch_lab::{Evaluation, LostImages, Recorder, Report, Truth, TruthFilter, evaluate};
use roadwatch_pipeline::NamedSink;
use std::sync::Arc;

/// Everything that the comparison needs, checked before the run.
pub(super) struct Scoring {
    rig: Arc<Rig>,
    dataset: Arc<RigDataset>,
    truth: Truth,
    recorder: Recorder,
}

impl Scoring {
    /// Reads the labels.
    ///
    /// # Errors
    /// When the session plays no dataset, or one without labels.
    pub(super) fn prepare(session: &Session) -> Result<Self, Failure> {
        let dataset = session
            .config
            .rig
            .as_ref()
            .and_then(|rig| rig.dataset.clone());
        let dataset = dataset.ok_or_else(|| {
            anyhow!("--score needs a labelled dataset: set rig.dataset, or give --dataset DIR")
        })?;
        let truth = Truth::read(dataset.folder()).context("nothing can be scored")?;
        Ok(Self {
            rig: Arc::clone(&session.rig),
            dataset,
            truth,
            recorder: Recorder::default(),
        })
    }

    /// The sink that keeps what is published.
    pub(super) fn sink(&self) -> NamedSink {
        NamedSink {
            name: "score".to_owned(),
            sink: Box::new(self.recorder.clone()),
        }
    }

    /// Scores what was published: every labelled class, well visible objects.
    pub(super) fn report(&self, frame_limit: Option<u64>) -> Report {
        let filter = TruthFilter {
            classes: self
                .truth
                .classes()
                .into_iter()
                .map(str::to_owned)
                .collect(),
            ..TruthFilter::default()
        };
        let evaluation = Evaluation {
            rig: &self.rig,
            dataset: &self.dataset,
            truth: &self.truth,
            filter: &filter,
            lost_images: LostImages::Ignore,
            frame_limit,
        };
        evaluate(&evaluation, &self.recorder.take(), &[])
    }
}
