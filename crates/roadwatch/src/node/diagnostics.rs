//! `/diagnostics`: how every camera, stage and sink is, once a second.

mod camera_period;
mod ego_watch;

use crate::{config::DiagnosticLimits, session::Session, switches::Switches};
use camera_period::CameraPeriod;
use ego_watch::EgoWatch;
use roadwatch_core::{CameraId, Rig, Timestamp};
use roadwatch_pipeline::{CameraCounts, Edge, Metrics, Percentiles, SinkCounts};
use roadwatch_ros::{
    Outlet, RosError, RosNode,
    msg::{
        diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
        std_msgs::Header,
    },
    node::reliable,
};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// Messages kept for slow readers: what is older than some seconds is no diagnosis.
const DEPTH: usize = 5;

/// Publishes how the pipeline is.
#[derive(Debug)]
pub(super) struct Diagnostics {
    outlet: Outlet<DiagnosticArray>,
    node: String,
    rig: Arc<Rig>,
    switches: Switches,
    limits: DiagnosticLimits,
    /// What the detector is, as far as it never changes.
    detector: Vec<KeyValue>,
    ego: EgoWatch,
    before: Option<Look>,
    cameras: Vec<Watched>,
}

/// What was counted at one moment.
#[derive(Debug)]
struct Look {
    at: Instant,
    cameras: Vec<CameraCounts>,
    sinks: Vec<SinkCounts>,
}

/// When a camera was heard of last, and whether it is known to be gone.
#[derive(Clone, Copy, Debug)]
struct Watched {
    heard: Instant,
    gone: bool,
}

impl Diagnostics {
    /// # Errors
    /// When the middleware refuses.
    pub(super) fn announce(node: &RosNode, session: &Session) -> Result<Self, RosError> {
        let config = &session.config;
        let options = config.detector.as_ref().map(|detector| &detector.options);
        let model = options.map_or_else(String::new, |options| options.model.display().to_string());
        let now = Instant::now();
        Ok(Self {
            outlet: node.outlet(
                "/diagnostics",
                "diagnostic_msgs/DiagnosticArray",
                &reliable(DEPTH),
            )?,
            node: node.surface().node_name.clone(),
            rig: Arc::clone(&session.rig),
            switches: session.controls.switches.clone(),
            limits: config.diagnostics,
            detector: vec![
                pair("model", model),
                pair("provider", session.controls.detector.provider()),
            ],
            ego: EgoWatch::of(session),
            before: None,
            cameras: vec![
                Watched {
                    heard: now,
                    gone: false
                };
                session.rig.cameras().len()
            ],
        })
    }

    /// Publishes the present state, and gives the cameras that went silent since the last call.
    pub(super) fn publish(&mut self, metrics: &Metrics, stamp: Timestamp) -> Vec<CameraId> {
        let look = Look {
            at: Instant::now(),
            cameras: self.rig.ids().map(|id| metrics.camera(id)).collect(),
            sinks: (0..metrics.sink_names().count())
                .map(|at| metrics.sink(at))
                .collect(),
        };
        let gone = self.hear(&look);
        let mut status: Vec<_> = self.rig.ids().map(|id| self.camera(id, &look)).collect();
        status.push(self.stages(metrics));
        let (level, message, values) = self.ego.look(stamp);
        status.push(self.status("ego motion", level, message, values));
        let names = metrics.sink_names().enumerate();
        status.extend(names.map(|(at, name)| self.sink(name, at, &look, metrics)));
        self.send(status, stamp);
        self.before = Some(look);
        gone
    }

    /// Says that nothing is looked at yet.
    pub(super) fn publish_waiting(&self, stamp: Timestamp) {
        let message = "waiting to be configured and activated".to_owned();
        let status = self.status("node", DiagnosticStatus::OK, message, Vec::new());
        self.send(vec![status], stamp);
    }

    fn send(&self, status: Vec<DiagnosticStatus>, stamp: Timestamp) {
        let header = Header::new(stamp, "");
        if let Err(error) = self.outlet.publish(DiagnosticArray { header, status }) {
            tracing::debug!(error, "not published on /diagnostics");
        }
    }

    /// Notes which cameras spoke since the last look.
    fn hear(&mut self, look: &Look) -> Vec<CameraId> {
        let mut gone = Vec::new();
        for (id, watched) in self.rig.ids().zip(&mut self.cameras) {
            let captured = look.cameras[id.index()].captured;
            let before = self
                .before
                .as_ref()
                .map_or(0, |before| before.cameras[id.index()].captured);
            if captured > before {
                *watched = Watched {
                    heard: look.at,
                    gone: false,
                };
            } else if !watched.gone && look.at - watched.heard >= self.limits.stale_after {
                watched.gone = true;
                gone.push(id);
            }
        }
        gone
    }

    fn camera(&self, id: CameraId, look: &Look) -> DiagnosticStatus {
        let now = look.cameras[id.index()];
        let before = self.before.as_ref();
        let watched = self.cameras[id.index()];
        let period = CameraPeriod {
            now,
            before: before.map_or_else(CameraCounts::default, |look| look.cameras[id.index()]),
            secs: before.map_or(0.0, |before| (look.at - before.at).as_secs_f64()),
            silent_secs: (look.at - watched.heard).as_secs_f64(),
            gone: watched.gone,
        };
        let (level, message) = if !self.switches.is_active() {
            (DiagnosticStatus::OK, "the node is not active".to_owned())
        } else if !self.switches.is_enabled(id) {
            (DiagnosticStatus::OK, "switched off".to_owned())
        } else {
            period.verdict(&self.limits)
        };
        let name = self.rig.camera(id).name.as_str();
        DiagnosticStatus {
            hardware_id: name.to_owned(),
            ..self.status(&format!("camera {name}"), level, message, period.values())
        }
    }

    fn stages(&self, metrics: &Metrics) -> DiagnosticStatus {
        let mut values = self.detector.clone();
        for edge in Edge::ALL {
            values.extend(latencies(edge.as_str(), metrics.edge(edge)));
        }
        values.push(pair("scenes", metrics.scenes()));
        let whole = metrics.edge(Edge::ReceivedToPerceived);
        let (level, message) = if whole.count > 0 && whole.p99 > self.limits.max_latency {
            (
                DiagnosticStatus::WARN,
                format!(
                    "one in a hundred images takes {:.0} ms or longer",
                    millis(whole.p99)
                ),
            )
        } else {
            (
                DiagnosticStatus::OK,
                format!("{:.0} ms from image to objects (median)", millis(whole.p50)),
            )
        };
        self.status("pipeline", level, message, values)
    }

    fn sink(&self, name: &str, at: usize, look: &Look, metrics: &Metrics) -> DiagnosticStatus {
        let now = look.sinks[at];
        let before = self
            .before
            .as_ref()
            .map_or_else(SinkCounts::default, |before| before.sinks[at]);
        let lost = now.dropped + now.failed - before.dropped - before.failed;
        let (level, message) = match lost {
            0 => (DiagnosticStatus::OK, "everything delivered".to_owned()),
            lost => (DiagnosticStatus::WARN, format!("{lost} outputs lost")),
        };
        let mut values = vec![
            pair("delivered", now.delivered),
            pair("dropped", now.dropped),
            pair("failed", now.failed),
        ];
        values.extend(latencies(
            "received_to_published",
            metrics.received_to_published(at),
        ));
        self.status(&format!("sink {name}"), level, message, values)
    }

    fn status(
        &self,
        part: &str,
        level: u8,
        message: String,
        values: Vec<KeyValue>,
    ) -> DiagnosticStatus {
        DiagnosticStatus {
            level,
            name: format!("{}: {part}", self.node),
            message,
            hardware_id: String::new(),
            values,
        }
    }
}

fn latencies(of: &str, measured: Percentiles) -> [KeyValue; 3] {
    let one = |name: &str, time| pair(&format!("{of}_{name}_ms"), format!("{:.1}", millis(time)));
    [
        one("p50", measured.p50),
        one("p99", measured.p99),
        one("max", measured.max),
    ]
}

fn millis(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

fn pair(key: &str, value: impl ToString) -> KeyValue {
    KeyValue {
        key: key.to_owned(),
        value: value.to_string(),
    }
}
