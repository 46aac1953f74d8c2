//! The report: `report.json` for programs, `report.md` for people.

use crate::{
    matching::TruthFilter,
    score::{DistanceScore, LocationScore},
};
use roadwatch_core::Method;
use serde_json::{Map, Value, json};
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
};

/// Name of the pipeline's own answers among the methods.
const PUBLISHED: &str = "published";

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

/// Figures of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodReport {
    /// Of `range_m`.
    pub distance: DistanceScore,
    /// Of the place.
    pub location: LocationScore,
    /// Matched objects that the method gave no place.
    pub unlocated: usize,
    /// Why the method was not tried; `None` when it was.
    pub unavailable: Option<String>,
}

impl MethodReport {
    /// The report of a method that this rig cannot use.
    #[must_use]
    pub fn unavailable(reason: String) -> Self {
        Self {
            distance: DistanceScore::default(),
            location: LocationScore::default(),
            unlocated: 0,
            unavailable: Some(reason),
        }
    }
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
    pub published: MethodReport,
    /// How well they were placed, by method.
    pub methods: BTreeMap<Method, MethodReport>,
}

/// A report that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the report `{}`", file.display())]
pub struct ReportError {
    file: PathBuf,
    #[source]
    cause: io::Error,
}

impl Report {
    /// What was published, then every method, by name.
    fn places(&self) -> impl Iterator<Item = (&'static str, &MethodReport)> {
        let methods = self
            .methods
            .iter()
            .map(|(method, report)| (method.as_str(), report));
        std::iter::once((PUBLISHED, &self.published)).chain(methods)
    }

    /// The report as JSON: `detection.…`, `distance.<method>.…`, `location.<method>.…`, where `published`
    /// stands for what the pipeline published.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let by_method = |value: &dyn Fn(&MethodReport) -> Value| -> Value {
            let entries = self.places();
            let entries = entries.map(|(name, report)| (name.to_owned(), value(report)));
            Value::Object(entries.collect::<Map<_, _>>())
        };
        let unavailable = |report: &MethodReport| json!(report.unavailable);
        json!({
            "frames": self.frames,
            "frames_missing": self.frames_missing,
            "filter": {
                "min_height_px": self.filter.min_height_px,
                "max_occluded": self.filter.max_occluded,
                "max_truncated": self.filter.max_truncated,
                "classes": self.filter.classes,
            },
            "detection": {
                "n": self.detection.n,
                "matched": self.detection.matched,
                "recall": self.detection.recall,
                "precision": self.detection.precision,
            },
            "distance": by_method(&|report| json!(report.distance)),
            "location": by_method(&|report| json!(report.location)),
            "unlocated": by_method(&|report| json!(report.unlocated)),
            "unavailable": by_method(&unavailable),
        })
    }

    /// The report as Markdown.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let filter = &self.filter;
        let detection = &self.detection;
        let mut text = format!(
            "# Evaluation\n\n{} images, {} more were lost. Objects scored: {}, at least {} px high, at most {} hidden and {} outside the image.\n\n\
             ## Detection\n\n| objects | found | recall | precision |\n|---|---|---|---|\n| {} | {} | {} | {} |\n\n\
             ## Distance (`range_m`)\n\n\
             | method | n | MAE m | mean rel. | median rel. | bias | > 1.5 m |\n|---|---|---|---|---|---|---|\n",
            self.frames,
            self.frames_missing,
            filter.classes.join(", "),
            filter.min_height_px,
            percent(Some(filter.max_occluded)),
            percent(Some(filter.max_truncated)),
            detection.n,
            detection.matched,
            percent(detection.recall),
            percent(detection.precision),
        );
        // Writing to a String cannot fail.
        for (method, report) in self.places() {
            let d = &report.distance;
            writeln!(
                text,
                "| {method} | {} | {} | {} | {} | {} | {} |",
                d.n,
                metres(d.mae_m),
                percent(d.mean_relative_error),
                percent(d.median_relative_error),
                percent(d.bias_relative),
                percent(d.major_error_share),
            )
            .ok();
        }
        text.push_str("\n## Location (horizontal)\n\n| method | n | without a place | mean m | p50 m | p90 m | <= 1.5 m |\n|---|---|---|---|---|---|---|\n");
        for (method, report) in self.places() {
            let l = &report.location;
            let (mean, p50, p90) = (metres(l.mae_m), metres(l.p50_m), metres(l.p90_m));
            writeln!(
                text,
                "| {method} | {} | {} | {mean} | {p50} | {p90} | {} |",
                l.n,
                report.unlocated,
                percent(l.minor_error_share),
            )
            .ok();
        }
        for (method, report) in &self.methods {
            if let Some(reason) = &report.unavailable {
                writeln!(text, "\n`{method}` was not tried: {reason}.").ok();
            }
        }
        text
    }

    /// What a run's summary says of its accuracy, for people.
    #[must_use]
    pub fn summary(&self) -> String {
        let (filter, detection) = (&self.filter, &self.detection);
        let (distance, location) = (&self.published.distance, &self.published.location);
        format!(
            "against the labels of {} images ({}; at least {} px high, at most {} hidden and {} outside the image):\n  \
             found {} of {} (recall {}), precision {}\n  \
             location error mean {} m, median {} m, 90 % below {} m; {} of the found are within 1.5 m\n  \
             distance error mean {} of the distance, bias {}",
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

    /// Writes `report.json` and `report.md` into a folder, which is made if need be.
    ///
    /// # Errors
    /// When the folder or a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        let failed = |file: &Path| {
            let file = file.to_owned();
            move |cause| ReportError { file, cause }
        };
        fs::create_dir_all(folder).map_err(failed(folder))?;
        let json = folder.join("report.json");
        fs::write(&json, format!("{:#}\n", self.to_json())).map_err(failed(&json))?;
        let markdown = folder.join("report.md");
        fs::write(&markdown, self.to_markdown()).map_err(failed(&markdown))
    }
}

fn metres(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{:.1} %", value * 100.0))
}
