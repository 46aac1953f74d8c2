//! The daemon as a ROS 2 node: what it offers beside its topics, and what "now" is to it.

mod annotated;
mod diagnostics;
mod log;
mod parameters;

use crate::{clock::wall_time, session::Session};
use diagnostics::Diagnostics;
use roadwatch_core::Timestamp;
use roadwatch_pipeline::Metrics;
use roadwatch_ros::{
    Lifecycle, Outlets, RosError, RosNode, RosSink, Rosout, SimClock,
    lifecycle::{self, Phase},
    parameters as ros_parameters,
};
use ros_parameters::ParameterEvents;
use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

pub use annotated::AnnotatedImages;
pub use log::RosoutTap;

/// The node while it runs. It leaves the domain when it is dropped.
pub struct DaemonNode {
    /// First, so that nothing is logged to a node that is gone.
    tap: RosoutTap,
    lifecycle: Arc<Lifecycle>,
    clock: Option<Arc<SimClock>>,
    diagnostics: Option<Diagnostics>,
    outlets: Option<Arc<Outlets>>,
    node: Arc<RosNode>,
}

impl fmt::Debug for DaemonNode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DaemonNode({:?})", self.node)
    }
}

impl DaemonNode {
    /// Joins the domain and offers what a ROS 2 node offers; `stop` becomes true when a manager shuts the node down.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn start(
        session: &Session,
        tap: &RosoutTap,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, RosError> {
        let config = &session.config.node;
        let node_name = config.options.surface.private_prefix();
        let events = ParameterEvents::default();
        let parameters = parameters::of(session, events.clone());
        let lifecycle = managed(session, stop);
        let mut services = ros_parameters::services(&parameters, &node_name);
        services.extend(lifecycle::services(&lifecycle, &node_name));
        let node = RosNode::start(&config.options, services)?;
        tap.open(Rosout::announce(&node)?);
        let clock = match config.use_sim_time {
            true => Some(Arc::new(SimClock::listen(&node)?)),
            false => None,
        };
        let of_events = clock.clone();
        events.announce(&node, move || now(of_events.as_deref()))?;
        lifecycle.announce_on(&node)?;
        let outlets = match config.publish {
            true => {
                let stamp = now(clock.as_deref());
                let rig = Arc::clone(&session.rig);
                Some(Outlets::announce(&node, rig, config.publishing, stamp)?)
            }
            false => None,
        };
        let diagnostics = match config.publish {
            true => Some(Diagnostics::announce(&node, session)?),
            false => None,
        };
        Ok(Self {
            tap: tap.clone(),
            lifecycle,
            clock,
            diagnostics,
            outlets,
            node,
        })
    }

    /// The node itself, for further endpoints.
    #[must_use]
    pub fn node(&self) -> &Arc<RosNode> {
        &self.node
    }

    /// Where outputs are published; `None` when nothing is.
    #[must_use]
    pub fn sink(&self) -> Option<RosSink> {
        self.outlets.clone().map(RosSink)
    }

    /// Where annotated images are published; `None` when none are.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn annotated_images(&self, session: &Session) -> Result<Option<AnnotatedImages>, RosError> {
        let config = &session.config.node;
        if !config.publish || !config.annotated_images {
            return Ok(None);
        }
        AnnotatedImages::announce(&self.node, Arc::clone(&session.rig)).map(Some)
    }

    /// Configured and active at once, where nobody is to manage it.
    pub fn autostart(&self) {
        self.lifecycle.autostart();
    }

    /// Whether it works.
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.lifecycle.phase() == Phase::Active
    }

    /// Says that the pipeline does not run yet. To be called once a second.
    pub fn report_waiting(&self) {
        if let Some(diagnostics) = &self.diagnostics {
            diagnostics.publish_waiting(now(self.clock.as_deref()));
        }
    }

    /// Says how the pipeline is, and takes the markers of cameras away that are gone. To be called once a second.
    pub fn report(&mut self, metrics: &Metrics) {
        let stamp = now(self.clock.as_deref());
        let Some(diagnostics) = &mut self.diagnostics else {
            return;
        };
        let lost = diagnostics.publish(metrics, stamp);
        for camera in lost {
            let cleared = self
                .outlets
                .as_ref()
                .map(|outlets| outlets.clear_markers(camera, stamp));
            if let Some(Err(error)) = cleared {
                tracing::warn!(
                    error,
                    camera = camera.0,
                    "markers of a lost camera not cleared"
                );
            }
        }
    }
}

impl Drop for DaemonNode {
    fn drop(&mut self) {
        self.tap.close();
    }
}

/// The wall's time, or what `/clock` says; before it says anything, the wall's.
fn now(clock: Option<&SimClock>) -> Timestamp {
    clock.and_then(SimClock::now).unwrap_or_else(wall_time)
}

/// What the phases mean: cameras are looked at while it is active, and its end is the daemon's.
fn managed(session: &Session, stop: &Arc<AtomicBool>) -> Arc<Lifecycle> {
    let (switches, stop) = (session.controls.switches.clone(), Arc::clone(stop));
    switches.set_active(false);
    Lifecycle::new(move |phase| {
        switches.set_active(phase == Phase::Active);
        if phase == Phase::Finalized {
            stop.store(true, Ordering::Relaxed);
        }
    })
}
