//! A run compared with the labels of its dataset.

use crate::{config::Config, failure::Failure, session::Session};
use anyhow::{Context as _, anyhow};
use roadwatch_camera::RigDataset;
use roadwatch_core::Rig;
use roadwatch_lab::{Evaluation, LostImages, Recorder, Report, Truth, TruthFilter, evaluate};
use roadwatch_pipeline::NamedSink;
use std::sync::Arc;

/// The dataset that a configuration plays and its labels; `None` when it plays none.
///
/// # Errors
/// When the dataset has no usable labels.
pub(super) fn labelled(config: &Config) -> Result<Option<(Arc<RigDataset>, Truth)>, Failure> {
    const CONTEXT: &str = "nothing can be scored";
    let Some(rig) = &config.rig else {
        return Ok(None);
    };
    let Some(dataset) = rig.dataset.clone() else {
        return Ok(None);
    };
    let truth = rig.format.read_truth(&dataset).context(CONTEXT)?;
    truth.check_cameras(&rig.rig).context(CONTEXT)?;
    Ok(Some((dataset, truth)))
}

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
        let (dataset, truth) = labelled(&session.config)?.ok_or_else(|| {
            anyhow!("--score needs a labelled dataset: set rig.dataset, or give --dataset DIR")
        })?;
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
        evaluate(&evaluation, &self.recorder.take(), &[], Vec::new())
    }
}
