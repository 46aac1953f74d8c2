//! `report.md`.

use super::Report;
use crate::{
    bootstrap::Interval,
    grouping::Grouping,
    heading_score::HeadingScore,
    plots::Plot,
    sample::Estimator,
    sample_table::Group,
    score::{DistanceScore, Figures},
};
use std::fmt::Write as _;

/// A figure that is shown for each group, with its heading.
type GroupFigure = (&'static str, fn(&Figures) -> String);

/// What groups are compared by.
const GROUP_FIGURES: [GroupFigure; 3] = [
    ("mean relative error of the distance (bias)", |figures| {
        let distance = &figures.distance;
        match distance.n {
            0 => "-".to_owned(),
            _ => format!(
                "{} ({})",
                percent(distance.mean_relative_error),
                signed_percent(distance.bias_relative)
            ),
        }
    }),
    ("location error p50 / p90, m", |figures| {
        let location = &figures.location;
        format!("{} / {}", metres(location.p50_m), metres(location.p90_m))
    }),
    (
        "covered: accuracy of the distance at least 90 %",
        |figures| percent(figures.coverage_90),
    ),
];

impl Report {
    /// The report as Markdown: the main table first, groups last.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let sections = [
            self.opening(),
            self.main_table(),
            self.other_distances(),
            self.honesty(),
            self.headings(),
            self.identities(),
            self.latency_text(),
            self.groups(),
        ];
        sections.concat()
    }

    fn opening(&self) -> String {
        let (filter, detection) = (&self.filter, &self.detection);
        format!(
            "# Evaluation\n\n{} images, {} more were lost. Objects scored: {}, at least {} px high, at most {} hidden and {} outside the image.\n\n\
             | objects | found | recall | precision |\n|---|---|---|---|\n| {} | {} | {} | {} |\n\n",
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
        )
    }

    fn main_table(&self) -> String {
        let objects = self
            .intervals
            .values()
            .map(|i| i.objects)
            .max()
            .unwrap_or_default();
        let mut text = format!(
            "## Distance (`range_m`) and location\n\nIn brackets: 95 % intervals, bootstrapped over the {objects} different objects.\n\n\
             | method | n | no place | mean rel. error | bias | median rel. | MAE m | RMSE m | > 1.5 m | covered | location p50 m | p90 m |\n\
             |---|---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for (who, figures) in self.places() {
            let intervals = self.intervals.get(&who).copied().unwrap_or_default();
            let (d, l) = (&figures.distance, &figures.location);
            let mean =
                percent(d.mean_relative_error) + &between(intervals.mean_relative_error, 100.0);
            let bias = signed_percent(d.bias_relative) + &between(intervals.bias_relative, 100.0);
            let covered = percent(figures.coverage_90) + &between(intervals.coverage_90, 100.0);
            let p50 = metres(l.p50_m) + &between(intervals.location_p50_m, 1.0);
            let cells = [
                who.to_string(),
                d.n.to_string(),
                figures.unlocated.to_string(),
                mean,
                bias,
                percent(d.median_relative_error),
                metres(d.mae_m),
                metres(d.rmse_m),
                percent(d.major_error_share),
                covered,
                p50,
                metres(l.p90_m),
            ];
            text.push_str(&row(cells));
        }
        for (method, reason) in &self.unavailable {
            // Writing to a String cannot fail.
            writeln!(text, "\n`{method}` was not tried: {reason}.").ok();
        }
        text
    }

    fn other_distances(&self) -> String {
        let mut text = String::from(
            "\n## Other distances\n\n`depth_m` lies along the optical axis; the nearest surface is the assumed cuboid's.\n\n\
             | method | depth mean rel. | bias | MAE m | surface mean rel. | bias | MAE m |\n|---|---|---|---|---|---|---|\n",
        );
        let cells = |d: &DistanceScore| {
            let (mean, bias) = (
                percent(d.mean_relative_error),
                signed_percent(d.bias_relative),
            );
            [mean, bias, metres(d.mae_m)]
        };
        for (who, figures) in self.places() {
            let scores = [cells(&figures.depth), cells(&figures.surface)].concat();
            text.push_str(&row(std::iter::once(who.to_string()).chain(scores)));
        }
        text
    }

    fn honesty(&self) -> String {
        let mut text = String::from(
            "\n## Honesty of the covariance\n\nNEES is the mean of error² / variance: 1 is honest, more is too sure. Of a Gaussian 68.3 % lie \
             inside 1 sigma and 95.4 % inside 2.\n\n\
             | method | NEES radial | tangential | in 1 sigma | in 2 sigma | radial in 1 | in 2 | tangential in 1 | in 2 |\n\
             |---|---|---|---|---|---|---|---|---|\n",
        );
        for (who, figures) in self.places() {
            let nees = &figures.nees;
            let shares = [
                nees.share_1_sigma,
                nees.share_2_sigma,
                nees.share_1_sigma_radial,
                nees.share_2_sigma_radial,
                nees.share_1_sigma_tangential,
                nees.share_2_sigma_tangential,
            ];
            let cells = [
                who.to_string(),
                metres(nees.radial),
                metres(nees.tangential),
            ];
            text.push_str(&row(cells.into_iter().chain(shares.map(percent))));
        }
        text
    }

    fn headings(&self) -> String {
        let said: Vec<_> = self
            .places()
            .filter(|(_, figures)| figures.heading.n > 0)
            .collect();
        if said.is_empty() {
            return "\n## Heading\n\nNothing was said of headings.\n".to_owned();
        }
        let mut text = String::from(
            "\n## Heading\n\nFolded: the nearest of the headings that the box allows. Decided for: those published as known.\n\n\
             | method | n | mean ° | median ° | flipped | folded median ° |\n|---|---|---|---|---|---|\n",
        );
        let decided = &self.published.decided_heading;
        let decided = (decided.n > 0).then(|| ("decided for".to_owned(), decided));
        let said = said
            .into_iter()
            .map(|(who, figures)| (who.to_string(), &figures.heading));
        for (who, h) in decided.into_iter().chain(said) {
            let folded = degrees(h.folded_median_deg);
            let cells = std::iter::once(who).chain(heading_cells(h));
            text.push_str(&row(cells.chain([folded])));
        }
        text
    }

    fn latency_text(&self) -> String {
        let Some(latency) = self.latency else {
            return String::new();
        };
        format!(
            "\n## Latency\n\nReceived to published: p50 {:.1} ms, p99 {:.1} ms. At lossless pace frames wait for one another: this is no \
             measure of a vehicle's latency, which `roadwatch run` at realtime pace gives.\n",
            latency.p50, latency.p99
        )
    }

    fn groups(&self) -> String {
        let tables = Grouping::ALL.into_iter().filter_map(|grouping| {
            let groups = self.table.groups(grouping);
            // One group is the main table again.
            (groups.len() > 1).then(|| self.grouping(grouping, &groups))
        });
        tables.collect()
    }

    fn grouping(&self, grouping: Grouping, groups: &[Group]) -> String {
        let methods: Vec<Estimator> = self.table.estimators().into_iter().collect();
        let mut text = format!("\n## By {}\n", grouping.title());
        for (title, figure) in GROUP_FIGURES {
            let names: Vec<_> = methods.iter().map(|who| who.as_str()).collect();
            write!(
                text,
                "\n{title}\n\n| group | objects | found | {} |\n|---|---|---|{}\n",
                names.join(" | "),
                "---|".repeat(names.len())
            )
            .ok();
            for group in groups {
                let (objects, found) = (group.objects.to_string(), group.found.to_string());
                let cells = methods.iter().map(|who| figure(&group.figures[who]));
                text.push_str(&row([group.name.clone(), objects, found]
                    .into_iter()
                    .chain(cells)));
            }
        }
        text + &headings_of_groups(groups)
    }
}

/// Headings that were decided for, by group; nothing where there were none.
fn headings_of_groups(groups: &[Group]) -> String {
    let decided = groups.iter().filter_map(|group| {
        let heading = &group.figures.get(&Estimator::Published)?.decided_heading;
        (heading.n > 0)
            .then(|| row(std::iter::once(group.name.clone()).chain(heading_cells(heading))))
    });
    let rows: String = decided.collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        "\nheadings decided for\n\n| group | n | mean ° | median ° | flipped |\n|---|---|---|---|---|\n{rows}"
    )
}

fn heading_cells(heading: &HeadingScore) -> [String; 4] {
    [
        heading.n.to_string(),
        degrees(heading.mean_abs_deg),
        degrees(heading.median_abs_deg),
        percent(heading.flip_share),
    ]
}

/// The plots, shown.
pub(super) fn links(plots: &[Plot]) -> String {
    let shown = plots
        .iter()
        .map(|plot| format!("\n![{}]({})\n", plot.title, plot.file));
    format!("\n## Plots\n{}", shown.collect::<String>())
}

pub(crate) fn row(cells: impl IntoIterator<Item = String>) -> String {
    let cells: Vec<String> = cells.into_iter().collect();
    format!("| {} |\n", cells.join(" | "))
}

/// ` [low, high]`, multiplied; nothing without an interval.
fn between(interval: Option<Interval>, factor: f64) -> String {
    interval.map_or_else(String::new, |[low, high]| {
        format!(" [{:.1}, {:.1}]", low * factor, high * factor)
    })
}

pub(crate) fn metres(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
}

fn degrees(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.1}"))
}

pub(crate) fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{:.1} %", value * 100.0))
}

pub(crate) fn signed_percent(value: Option<f64>) -> String {
    value.map_or_else(
        || "-".to_owned(),
        |value| format!("{:+.1} %", value * 100.0),
    )
}
