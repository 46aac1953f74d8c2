//! The report: `report.json` for programs, `report.md` for people, plots beside them.

mod identities;
mod json;
pub(crate) mod markdown;

use crate::{
    bootstrap::Intervals,
    heading_score::HeadingScore,
    identity::IdentityReport,
    matching::TruthFilter,
    motion::MotionReport,
    plots::{self, PlotError},
    sample::Estimator,
    sample_table::SampleTable,
    score::Figures,
};
use markdown::{metres, percent};
use roadwatch_core::Method;
use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

/// Figures of detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectionScore {
    /// Labelled objects that pass the filter.
    pub n: usize,
    /// Those of them that were found.
    pub matched: usize,
    /// `matched / n`; `None` without objects.
    pub recall: Option<f64>,
    /// Found objects among found objects and false alarms; `None` without any.
    pub precision: Option<f64>,
}

/// How long frames took from received to published, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatencyMs {
    /// Half of the frames took less.
    pub p50: f64,
    /// All but one in a hundred took less.
    pub p99: f64,
}

/// Everything an evaluation found.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Images perceived.
    pub frames: usize,
    /// Images of the dataset that were lost on the way.
    pub frames_missing: usize,
    /// Which objects were scored.
    pub filter: TruthFilter,
    /// How well they were found.
    pub detection: DetectionScore,
    /// How well the pipeline placed them: what it published, by the methods it was configured with.
    pub published: Figures,
    /// What each frame by itself said of them, before tracks put frames together.
    pub single: Figures,
    /// How well they were placed, by method.
    pub methods: BTreeMap<Method, Figures>,
    /// Why methods were not tried, where they were not.
    pub unavailable: BTreeMap<Method, String>,
    /// How well identities hold.
    pub identity: IdentityReport,
    /// How well the baselines' do on the same objects, by name.
    pub identity_baselines: BTreeMap<String, IdentityReport>,
    /// How well speeds are known.
    pub motion: MotionReport,
    /// How far the main figures would move with other objects.
    pub intervals: BTreeMap<Estimator, Intervals>,
    /// `None` when nobody measured.
    pub latency: Option<LatencyMs>,
    /// What everything else was made of.
    pub table: SampleTable,
}

/// A report that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The folder or a file.
    #[error("cannot write the report `{}`", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// A plot.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl Report {
    /// What was published, what single frames said, then every method.
    fn places(&self) -> impl Iterator<Item = (Estimator, &Figures)> {
        let methods = self.methods.iter();
        let methods = methods.map(|(method, figures)| (Estimator::By(*method), figures));
        let said = [
            (Estimator::Published, &self.published),
            (Estimator::Single, &self.single),
        ];
        said.into_iter().chain(methods)
    }

    /// Whose headings stand for the evaluation: what was published, or the fused method's where that says nothing
    /// of headings; `None` when nobody does.
    fn heading(&self) -> Option<(Estimator, &HeadingScore)> {
        let candidates = [Estimator::Published, Estimator::By(Method::Fused)];
        let mut said = candidates.into_iter().filter_map(|estimator| {
            let (_, figures) = self.places().find(|(who, _)| *who == estimator)?;
            (figures.heading.n > 0).then_some((estimator, &figures.heading))
        });
        said.next()
    }

    /// What a run's summary says of its accuracy, for people.
    #[must_use]
    pub fn summary(&self) -> String {
        let (filter, detection) = (&self.filter, &self.detection);
        let (distance, location) = (&self.published.distance, &self.published.location);
        let heading = &self.published.decided_heading;
        let degrees = |value: Option<f64>| value.map_or("-".to_owned(), |deg| format!("{deg:.1}"));
        let headings = if heading.n == 0 {
            "no heading was decided for".to_owned()
        } else {
            format!(
                "heading of {}: error mean {} degrees, median {} degrees, {} turned round",
                heading.n,
                degrees(heading.mean_abs_deg),
                degrees(heading.median_abs_deg),
                percent(heading.flip_share),
            )
        };
        format!(
            "against the labels of {} images ({}; at least {} px high, at most {} hidden and {} outside the image):\n  \
             found {} of {} (recall {}), precision {}\n  \
             location error mean {} m, median {} m, 90 % below {} m; {} of the found are within 1.5 m\n  \
             distance error mean {} of the distance, bias {}\n  {headings}",
            self.frames,
            filter.classes.join(", "),
            filter.min_height_px,
            percent(Some(filter.max_occluded)),
            percent(Some(filter.max_truncated)),
            detection.matched,
            detection.n,
            percent(detection.recall),
            percent(detection.precision),
            metres(location.mae_m),
            metres(location.p50_m),
            metres(location.p90_m),
            percent(location.minor_error_share),
            percent(distance.mean_relative_error),
            percent(distance.bias_relative),
        )
    }

    /// Writes `report.json`, `report.md` and the plots into a folder, which is made if need be. Gives the names of
    /// the files.
    ///
    /// # Errors
    /// When the folder or a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<&'static str>, ReportError> {
        const JSON: &str = "report.json";
        const MARKDOWN: &str = "report.md";
        let write = |name: &str, text: String| {
            let file = folder.join(name);
            fs::write(&file, text).map_err(|cause| ReportError::Unwritable { file, cause })
        };
        fs::create_dir_all(folder).map_err(|cause| ReportError::Unwritable {
            file: folder.to_owned(),
            cause,
        })?;
        write(JSON, format!("{:#}\n", self.to_json()))?;
        let drawn = plots::draw(&self.table, folder)?;
        let text = format!("{}{}", self.to_markdown(), markdown::links(&drawn));
        write(MARKDOWN, text)?;
        let plots = drawn.into_iter().map(|plot| plot.file);
        Ok([JSON, MARKDOWN].into_iter().chain(plots).collect())
    }
}
