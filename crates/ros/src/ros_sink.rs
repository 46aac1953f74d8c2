//! The node: publishes every output over DDS.

use crate::{
    convert::{Message, Messages, Outgoing},
    surface::{InvalidSurface, Surface},
    topics::{Retention, Topic},
};
use roadwatch_core::{Output, Rig, Sink, SinkError, Timestamp};
use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile, Spinner,
    qos::{Durability, History, WhenFull},
};
use rustdds::{DomainParticipant, DomainParticipantBuilder};
use std::{
    error::Error,
    fmt, io,
    net::Ipv4Addr,
    sync::Arc,
    thread::{self, JoinHandle},
};

/// Beyond this a domain's UDP ports would not fit sixteen bits (DDSI-RTPS 2.3, section 9.6.1.1).
pub const MAX_DOMAIN_ID: u16 = 232;

type Cause = Box<dyn Error + Send + Sync>;

/// Which network interfaces the node talks on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Network {
    /// Loopback: nobody outside this machine sees the node.
    LocalhostOnly,
    /// Every interface.
    #[default]
    AllInterfaces,
}

/// How the node joins ROS 2.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RosOptions {
    /// Its names and frames.
    pub surface: Surface,
    /// Its DDS domain, 0 to 232.
    pub domain_id: u16,
    /// The interfaces it talks on.
    pub network: Network,
}

/// Why the node could not be started.
#[derive(Debug, thiserror::Error)]
pub enum RosError {
    /// No such domain.
    #[error("domain id {0} is out of range: DDS has the domains 0 to {MAX_DOMAIN_ID}")]
    DomainId(u16),
    /// A name that ROS 2 would refuse.
    #[error(transparent)]
    Surface(#[from] InvalidSurface),
    /// The domain cannot be joined.
    #[error("DDS domain {domain_id} cannot be joined")]
    Participant {
        /// The domain.
        domain_id: u16,
        /// What the middleware said.
        source: Cause,
    },
    /// The node cannot be made.
    #[error("ROS 2 node cannot be made")]
    Node(#[source] Cause),
    /// A publisher cannot be made.
    #[error("nothing can be published on {topic}")]
    Publisher {
        /// The topic's name.
        topic: String,
        /// What the middleware said.
        source: Cause,
    },
    /// The system gives no thread.
    #[error("thread of the ROS 2 node cannot be started")]
    Thread(#[source] io::Error),
}

/// Publishes outputs; never waits for a reader.
///
/// Reliable, but a full send window drops the message and says so, instead of waiting for the slow.
pub struct RosSink {
    messages: Messages,
    /// By place of the topic.
    publishers: Vec<Publisher<Message>>,
    spinning: Spinning,
}

impl fmt::Debug for RosSink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RosSink({})", self.spinning.node_name())
    }
}

impl RosSink {
    /// Joins the domain, announces every topic, and publishes `/tf_static` with the stamp `started_at`.
    ///
    /// # Errors
    /// When the options are out of range or the middleware refuses.
    pub fn start(
        rig: Arc<Rig>,
        options: &RosOptions,
        started_at: Timestamp,
    ) -> Result<Self, RosError> {
        let messages = Messages::new(rig, &options.surface)?;
        let context = Context::from_domain_participant(join(options)?)
            .map_err(|cause| RosError::Node(cause.into()))?;
        let mut node = new_node(&context, &options.surface)?;
        let publishers = messages
            .topics()
            .iter()
            .map(|topic| new_publisher(&mut node, topic))
            .collect::<Result<_, _>>()?;
        let sink = Self {
            spinning: Spinning::start(node)?,
            messages,
            publishers,
        };
        let tf_static = sink.messages.tf_static(started_at);
        let topic = sink.messages.topics()[tf_static.topic].name.clone();
        sink.send(tf_static)
            .map_err(|source| RosError::Publisher { topic, source })?;
        Ok(sink)
    }

    /// The topics announced, with their names.
    #[must_use]
    pub fn topics(&self) -> &[Topic] {
        self.messages.topics()
    }

    /// How many readers of a topic have been discovered on the network.
    #[must_use]
    pub fn readers_of(&self, topic: &Topic) -> usize {
        self.spinning.readers_of(&topic.name)
    }

    fn send(&self, outgoing: Outgoing) -> Result<(), Cause> {
        self.publishers[outgoing.topic]
            .publish(outgoing.message)
            .map_err(|error| error.forget_data().into())
    }
}

impl Sink for RosSink {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let mut dropped = Vec::new();
        let mut first_cause = None;
        for outgoing in self.messages.of(output) {
            let topic = outgoing.topic;
            if let Err(cause) = self.send(outgoing) {
                dropped.push(self.messages.topics()[topic].name.as_str());
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

/// The node, and the thread that runs its discovery.
struct Spinning {
    /// `None` only while being dropped: dropping the node is what ends the thread.
    node: Option<Node>,
    thread: Option<JoinHandle<()>>,
}

impl Spinning {
    fn start(mut node: Node) -> Result<Self, RosError> {
        let spinner = node
            .spinner()
            .map_err(|cause| RosError::Node(cause.into()))?;
        let thread = thread::Builder::new()
            .name("ros-spinner".to_owned())
            .spawn(move || spin(spinner))
            .map_err(RosError::Thread)?;
        Ok(Self {
            node: Some(node),
            thread: Some(thread),
        })
    }

    fn node_name(&self) -> String {
        self.node
            .as_ref()
            .map(Node::fully_qualified_name)
            .unwrap_or_default()
    }

    fn readers_of(&self, topic: &str) -> usize {
        self.node
            .as_ref()
            .map_or(0, |node| node.subscription_count(topic))
    }
}

impl Drop for Spinning {
    fn drop(&mut self) {
        self.node = None;
        if self
            .thread
            .take()
            .is_some_and(|thread| thread.join().is_err())
        {
            tracing::error!("thread of the ROS 2 node panicked");
        }
    }
}

fn spin(spinner: Spinner) {
    if let Err(error) = futures::executor::block_on(spinner.spin()) {
        tracing::error!(error = &error as &dyn Error, "ROS 2 discovery ended");
    }
}

fn join(options: &RosOptions) -> Result<DomainParticipant, RosError> {
    let domain_id = options.domain_id;
    if domain_id > MAX_DOMAIN_ID {
        return Err(RosError::DomainId(domain_id));
    }
    let builder = DomainParticipantBuilder::new(domain_id).same_host_loopback(true);
    let builder = match options.network {
        Network::LocalhostOnly => builder.with_only_networks([Ipv4Addr::LOCALHOST]),
        Network::AllInterfaces => builder,
    };
    builder.build().map_err(|cause| RosError::Participant {
        domain_id,
        source: cause.into(),
    })
}

fn new_node(context: &Context, surface: &Surface) -> Result<Node, RosError> {
    let name = NodeName::new(&surface.namespace, &surface.node_name)
        .map_err(|cause| RosError::Node(cause.into()))?;
    // Parameter services do not answer readers of every vendor, and a caller would hang on them.
    let options = NodeOptions::new()
        .enable_rosout(false)
        .start_parameter_services(false);
    context
        .new_node(name, options)
        .map_err(|cause| RosError::Node(cause.into()))
}

fn new_publisher(node: &mut Node, topic: &Topic) -> Result<Publisher<Message>, RosError> {
    let refused = |source: Cause| RosError::Publisher {
        topic: topic.name.clone(),
        source,
    };
    let name = Name::parse(&topic.name).map_err(|cause| refused(cause.into()))?;
    let (package, type_name) = topic.kind.ros_type().split_once('/').unwrap_or_default();
    let announced = node
        .create_topic(&name, MessageTypeName::new(package, type_name), &qos(topic))
        .map_err(|cause| refused(cause.into()))?;
    node.create_publisher(&announced, None)
        .map_err(|cause| refused(cause.into()))
}

fn qos(topic: &Topic) -> QosProfile {
    let durability = match topic.kind.retention() {
        Retention::Volatile => Durability::Volatile,
        Retention::Latched => Durability::TransientLocal,
    };
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .durability(durability)
        .history(History::KeepLast { depth: topic.depth })
}
