//! `report.json`.

use super::Report;
use crate::{grouping::Grouping, sample::Estimator, sample_table::Group, score::Figures};
use serde_json::{Map, Value, json};

impl Report {
    /// The report as JSON: `detection.…`, `distance.<method>.…`, `location.<method>.…` and so on, where `published`
    /// stands for what the pipeline published and `single` for what each frame said before tracks put them together; groups under `by.<grouping>.<group>.<method>`.
    #[must_use]
    pub fn to_json(&self) -> Value {
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
            "distance": self.by_method(|figures| json!(figures.distance)),
            "depth": self.by_method(|figures| json!(figures.depth)),
            "surface": self.by_method(|figures| json!(figures.surface)),
            "location": self.by_method(|figures| json!(figures.location)),
            "coverage_90": self.by_method(|figures| json!(figures.coverage_90)),
            "nees": self.by_method(|figures| json!(figures.nees)),
            "unlocated": self.by_method(|figures| json!(figures.unlocated)),
            "unavailable": self.why_unavailable(),
            "intervals_95": self.intervals_json(),
            "by": self.groups_json(figures_json),
            "recall_by": self.groups_json(|group| json!({"n": group.objects, "matched": group.found})),
            "heading": self.heading_json(),
            "identity": self.identity,
            "identity_baselines": self.identity_baselines,
            "velocity": self.motion,
            "latency_ms": self.latency.map(|latency| json!({"p50": latency.p50, "p99": latency.p99})),
        })
    }

    fn by_method(&self, value: impl Fn(&Figures) -> Value) -> Value {
        object(
            self.places()
                .map(|(who, figures)| (who.to_string(), value(figures))),
        )
    }

    fn why_unavailable(&self) -> Value {
        object(self.places().map(|(who, _)| {
            let reason = match who {
                Estimator::By(method) => self.unavailable.get(&method),
                Estimator::Published | Estimator::Single => None,
            };
            (who.to_string(), json!(reason))
        }))
    }

    fn intervals_json(&self) -> Value {
        let intervals = self.intervals.iter();
        object(intervals.map(|(who, intervals)| (who.to_string(), json!(intervals))))
    }

    fn groups_json(&self, value: impl Fn(&Group) -> Value) -> Value {
        object(Grouping::ALL.into_iter().map(|grouping| {
            let groups = self.table.groups(grouping).into_iter();
            let groups = groups.map(|group| (group.name.clone(), value(&group)));
            (grouping.as_str().to_owned(), object(groups))
        }))
    }

    /// The figures that stand for the evaluation, whose they are, and every method's that has any.
    fn heading_json(&self) -> Value {
        let (source, score) = self.heading().unzip();
        let mut heading = json!(score.copied().unwrap_or_default());
        let said = self.places().filter(|(_, figures)| figures.heading.n > 0);
        heading["decided"] = json!(self.published.decided_heading);
        heading["source"] = json!(source.map(Estimator::as_str));
        heading["by_method"] = object(said.map(|(who, f)| (who.to_string(), json!(f.heading))));
        heading
    }
}

fn figures_json(group: &Group) -> Value {
    let figures = group.figures.iter();
    object(figures.map(|(who, figures)| (who.to_string(), json!(figures))))
}

fn object(entries: impl Iterator<Item = (String, Value)>) -> Value {
    Value::Object(entries.collect::<Map<_, _>>())
}
