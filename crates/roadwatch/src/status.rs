//! What a run says about itself: one line per second, and a summary at the end.

use roadwatch_core::Rig;
use roadwatch_pipeline::{CameraCounts, DropReason, Edge, Metrics, Percentiles};
use serde_json::{Value, json};
use std::{
    fmt::Write as _,
    time::{Duration, Instant},
};

/// Makes the line of each second from the counts of the last.
pub struct StatusLine {
    last: Vec<CameraCounts>,
    last_at: Instant,
}

impl StatusLine {
    /// Counts from nothing.
    #[must_use]
    pub fn new(cameras: usize, now: Instant) -> Self {
        Self {
            last: vec![CameraCounts::default(); cameras],
            last_at: now,
        }
    }

    /// Cameras that deliver, frames per second, drops and objects since the last line, latencies so far.
    pub fn next(&mut self, rig: &Rig, metrics: &Metrics, now: Instant) -> String {
        let secs = now
            .saturating_duration_since(self.last_at)
            .as_secs_f64()
            .max(1e-3);
        let counts: Vec<_> = rig.ids().map(|camera| metrics.camera(camera)).collect();
        let since = |field: fn(&CameraCounts) -> u64| {
            let sum = |counts: &[CameraCounts]| counts.iter().map(field).sum::<u64>();
            sum(&counts) - sum(&self.last)
        };
        let delivering = counts
            .iter()
            .zip(&self.last)
            .filter(|(now, last)| now.captured > last.captured)
            .count();
        let published = since(|c| c.published);
        let (name, latency) = slowest_sink(metrics);
        let mut line = format!(
            "cameras {delivering}/{} · {:.1} fps · dropped {} · latency p50 {} p99 {} ms ({name}) · objects {:.1} per frame",
            counts.len(),
            published as f64 / secs,
            since(CameraCounts::dropped_total),
            millis(latency.p50),
            millis(latency.p99),
            since(|c| c.objects) as f64 / published.max(1) as f64,
        );
        let down: Vec<_> = rig
            .ids()
            .filter(|camera| counts[camera.index()].captured == self.last[camera.index()].captured)
            .map(|camera| rig.camera(camera).name.as_str())
            .collect();
        if !down.is_empty() {
            // Writing to a String cannot fail.
            write!(line, " · silent: {}", down.join(", ")).ok();
        }
        self.last = counts;
        self.last_at = now;
        line
    }
}

/// The sink that takes longest, from received to published; perceiving when there is no sink.
fn slowest_sink(metrics: &Metrics) -> (&str, Percentiles) {
    let sinks = metrics.sink_names().enumerate();
    let latencies = sinks.map(|(at, name)| (name, metrics.received_to_published(at)));
    latencies
        .max_by_key(|(_, latency)| latency.p99)
        .unwrap_or(("perceived", metrics.edge(Edge::ReceivedToPerceived)))
}

/// The whole run for people.
#[must_use]
pub fn summary(rig: &Rig, metrics: &Metrics, took: Duration) -> String {
    let mut text = String::from("camera          captured  published    dropped  lost  objects\n");
    for camera in rig.ids() {
        let counts = metrics.camera(camera);
        writeln!(
            text,
            "{:<14}{:>10}{:>11}{:>11}{:>6}{:>9}",
            rig.camera(camera).name.as_str(),
            counts.captured,
            counts.published,
            counts.dropped_total(),
            counts.lost,
            counts.objects
        )
        .ok();
    }
    for reason in DropReason::ALL {
        let dropped: u64 = rig
            .ids()
            .map(|camera| metrics.camera(camera).dropped[reason as usize])
            .sum();
        if dropped > 0 {
            writeln!(text, "dropped, {reason}: {dropped}").ok();
        }
    }
    for edge in Edge::ALL {
        let latency = metrics.edge(edge);
        writeln!(text, "{:<24}{}", edge.as_str(), latency_text(latency)).ok();
    }
    for (at, name) in metrics.sink_names().enumerate() {
        let counts = metrics.sink(at);
        let latency = latency_text(metrics.received_to_published(at));
        writeln!(
            text,
            "received to {name:<12}{latency}, delivered {}, dropped {}, failed {}",
            counts.delivered, counts.dropped, counts.failed
        )
        .ok();
    }
    write!(
        text,
        "{} scenes in {:.1} s",
        metrics.scenes(),
        took.as_secs_f64()
    )
    .ok();
    text
}

/// The whole run for programs.
#[must_use]
pub fn to_json(rig: &Rig, metrics: &Metrics, took: Duration, decoded: u64) -> Value {
    let camera = |camera| {
        let counts = metrics.camera(camera);
        let reasons = DropReason::ALL
            .iter()
            .map(|&reason| (reason.to_string(), json!(counts.dropped[reason as usize])));
        json!({
            "name": rig.camera(camera).name.as_str(),
            "captured": counts.captured,
            "published": counts.published,
            "dropped": counts.dropped_total(),
            "dropped_by_reason": reasons.collect::<serde_json::Map<_, _>>(),
            "lost": counts.lost,
            "disconnected": counts.disconnected,
            "objects": counts.objects,
            "unrotated": counts.unrotated,
        })
    };
    let edges = Edge::ALL
        .iter()
        .map(|&edge| (edge.as_str().to_owned(), latency_json(metrics.edge(edge))));
    let sinks = metrics.sink_names().enumerate().map(|(at, name)| {
        let counts = metrics.sink(at);
        let sink = json!({
            "delivered": counts.delivered,
            "dropped": counts.dropped,
            "failed": counts.failed,
            "received_to_published": latency_json(metrics.received_to_published(at)),
        });
        (name.to_owned(), sink)
    });
    json!({
        "secs": took.as_secs_f64(),
        "scenes": metrics.scenes(),
        "images_decoded": decoded,
        "cameras": rig.ids().map(camera).collect::<Vec<_>>(),
        "edges": edges.collect::<serde_json::Map<_, _>>(),
        "sinks": sinks.collect::<serde_json::Map<_, _>>(),
    })
}

fn latency_json(latency: Percentiles) -> Value {
    let millis = |time: Duration| time.as_secs_f64() * 1e3;
    json!({
        "count": latency.count,
        "p50_ms": millis(latency.p50),
        "p99_ms": millis(latency.p99),
        "max_ms": millis(latency.max),
    })
}

fn latency_text(latency: Percentiles) -> String {
    let Percentiles { p50, p99, max, .. } = latency;
    format!(
        "p50 {:>8} ms  p99 {:>8} ms  max {:>8} ms",
        millis(p50),
        millis(p99),
        millis(max)
    )
}

fn millis(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1e3)
}
