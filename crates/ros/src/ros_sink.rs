//! Publishes every output over DDS.

use crate::{
    convert::{Message, Messages, Outgoing},
    node::{Outlet, RosError, RosNode, reliable},
    topics::{Retention, Topic},
};
use roadwatch_core::{CameraId, Output, Rig, Sink, SinkError, Timestamp};
use ros2_client::{QosProfile, qos::Durability};
use std::{error::Error, sync::Arc};

type Cause = Box<dyn Error + Send + Sync>;

/// What is computed and sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PublishOptions {
    /// Whether the cameras' places are published on `/tf_static`; off where a URDF owns them.
    pub tf: bool,
    /// Whether messages are made for topics that nobody reads.
    pub unread: bool,
}

impl Default for PublishOptions {
    /// Transforms, and only what is read.
    fn default() -> Self {
        Self {
            tf: true,
            unread: false,
        }
    }
}

/// The topics of a rig, announced.
#[derive(Debug)]
pub struct Outlets {
    messages: Messages,
    options: PublishOptions,
    /// By place of the topic; `None` for `/tf_static` where a URDF owns it.
    outlets: Vec<Option<Outlet<Message>>>,
}

impl Outlets {
    /// Announces every topic, and publishes `/tf_static` with the stamp `started_at`.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn announce(
        node: &RosNode,
        rig: Arc<Rig>,
        options: PublishOptions,
        started_at: Timestamp,
    ) -> Result<Arc<Self>, RosError> {
        let messages = Messages::new(rig, node.surface())?;
        let outlet = |topic: &Topic| {
            if topic.kind.retention() == Retention::Latched && !options.tf {
                return Ok(None);
            }
            node.outlet(&topic.name, topic.kind.ros_type(), &qos(topic))
                .map(Some)
        };
        let outlets = messages.topics().iter().map(outlet);
        let outlets = Self {
            outlets: outlets.collect::<Result<_, _>>()?,
            messages,
            options,
        };
        if options.tf {
            let tf_static = outlets.messages.tf_static(started_at);
            let topic = outlets.topics()[tf_static.topic].name.clone();
            let sent = outlets.send(tf_static);
            sent.map_err(|source| RosError::Publish { topic, source })?;
        }
        Ok(Arc::new(outlets))
    }

    /// The topics announced, with their names.
    #[must_use]
    pub fn topics(&self) -> &[Topic] {
        self.messages.topics()
    }

    /// Takes what viewers still show of a camera away: it is gone.
    ///
    /// # Errors
    /// When the message is not sent.
    pub fn clear_markers(&self, camera: CameraId, now: Timestamp) -> Result<(), Cause> {
        self.send(self.messages.no_markers(camera, now))
    }

    fn is_wanted(&self, topic: usize) -> bool {
        let outlet = self.outlets[topic].as_ref();
        outlet.is_some_and(|outlet| self.options.unread || outlet.has_readers())
    }

    fn send(&self, outgoing: Outgoing) -> Result<(), Cause> {
        match &self.outlets[outgoing.topic] {
            Some(outlet) => outlet.publish(outgoing.message),
            None => Ok(()),
        }
    }
}

/// Publishes outputs; never waits for a reader.
///
/// Reliable, but a full send window drops the message and says so, instead of waiting for the slow.
#[derive(Debug)]
pub struct RosSink(pub Arc<Outlets>);

impl Sink for RosSink {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let outlets = &self.0;
        let mut dropped = Vec::new();
        let mut first_cause = None;
        let wanted = |topic| outlets.is_wanted(topic);
        for outgoing in outlets.messages.of_wanted(output, wanted) {
            let topic = outgoing.topic;
            if let Err(cause) = outlets.send(outgoing) {
                dropped.push(outlets.topics()[topic].name.as_str());
                first_cause.get_or_insert(cause);
            }
        }
        match first_cause {
            None => Ok(()),
            Some(cause) => Err(SinkError::new(
                format!("not published on {}", dropped.join(", ")),
                cause,
            )),
        }
    }
}

fn qos(topic: &Topic) -> QosProfile {
    let durability = match topic.kind.retention() {
        Retention::Volatile => Durability::Volatile,
        Retention::Latched => Durability::TransientLocal,
    };
    reliable(topic.depth).durability(durability)
}
