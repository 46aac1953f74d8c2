//! The daemon's log on `/rosout`.

use crate::clock::wall_time;
use roadwatch_ros::{
    Rosout,
    rosout::{LogRecord, Severity},
};
use std::{
    fmt::{self, Write as _},
    sync::{Arc, PoisonError, RwLock},
};
use tracing::{
    Event, Level, Subscriber,
    field::{Field, Visit},
};
use tracing_subscriber::{Layer, layer::Context};

/// What is said by others, the middleware above all, would say itself again by being sent.
const OURS: &str = "roadwatch";

/// Hears what is logged, and passes it on to `/rosout` while there is a node.
#[derive(Clone, Debug, Default)]
pub struct RosoutTap(Arc<RwLock<Option<Rosout>>>);

impl RosoutTap {
    /// From now on, what is logged goes to `rosout`.
    pub fn open(&self, rosout: Rosout) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = Some(rosout);
    }

    /// From now on, it goes nowhere.
    pub fn close(&self) {
        *self.0.write().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

impl<S: Subscriber> Layer<S> for RosoutTap {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let metadata = event.metadata();
        if !metadata.target().starts_with(OURS) {
            return;
        }
        let rosout = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let Some(rosout) = rosout.as_ref() else {
            return;
        };
        let mut text = Text::default();
        event.record(&mut text);
        let file = metadata.file().unwrap_or_default().to_owned();
        rosout.log(LogRecord {
            stamp: wall_time(),
            severity: severity(*metadata.level()),
            text: format!("{}{}", text.message, text.fields),
            origin: (file, metadata.line().unwrap_or(0)),
        });
    }
}

fn severity(level: Level) -> Severity {
    match level {
        Level::ERROR => Severity::Error,
        Level::WARN => Severity::Warn,
        Level::INFO => Severity::Info,
        _ => Severity::Debug,
    }
}

/// An event as one line: what it says, then its fields.
#[derive(Default)]
struct Text {
    message: String,
    fields: String,
}

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        // Writing to a text never fails.
        match field.name() {
            "message" => write!(self.message, "{value:?}").ok(),
            name => write!(self.fields, " {name}={value:?}").ok(),
        };
    }
}
