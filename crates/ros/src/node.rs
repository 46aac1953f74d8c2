//! The node: joins the domain, makes publishers, subscriptions and services, and knows who listens.

mod audience;
mod raw;
mod service;

use crate::surface::{InvalidSurface, Surface};
use audience::Audience;
use futures::{StreamExt as _, channel::oneshot, future};
use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile,
    Subscription,
    qos::{Durability, History, WhenFull},
};
use rustdds::{DomainParticipant, DomainParticipantBuilder, StatusEvented as _};
use serde::Serialize;
use std::{
    error::Error,
    fmt, io,
    net::Ipv4Addr,
    pin::pin,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread::{self, JoinHandle},
};

pub use service::{Service, ServiceType};

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
    /// A publisher, subscription or service cannot be made.
    #[error("no endpoint can be made on {name}")]
    Endpoint {
        /// The topic's or service's name.
        name: String,
        /// What the middleware said.
        source: Cause,
    },
    /// The first message cannot be published.
    #[error("nothing can be published on {topic}")]
    Publish {
        /// The topic's name.
        topic: String,
        /// What the middleware said.
        source: Cause,
    },
    /// The system gives no thread.
    #[error("thread of the ROS 2 node cannot be started")]
    Thread(#[source] io::Error),
}

/// A node in its domain, with two threads of its own: one answers services, the other watches who listens.
///
/// It leaves the domain when it is dropped; what was made with it must be gone by then.
pub struct RosNode {
    node: Mutex<Node>,
    surface: Surface,
    audience: Arc<Audience>,
    threads: Vec<Running>,
}

impl fmt::Debug for RosNode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RosNode({})", self.surface.private_prefix())
    }
}

impl RosNode {
    /// Joins the domain and offers `services`.
    ///
    /// # Errors
    /// When the options are out of range or the middleware refuses.
    pub fn start(options: &RosOptions, services: Vec<Service>) -> Result<Arc<Self>, RosError> {
        options.surface.check()?;
        let participant = join(options)?;
        let context = Context::from_domain_participant(participant.clone())
            .map_err(|cause| RosError::Node(cause.into()))?;
        let mut node = new_node(&context, &options.surface)?;
        let servers = services
            .into_iter()
            .map(|service| service.offered_by(&mut node))
            .collect::<Result<Vec<_>, _>>()?;
        let audience = Arc::new(Audience::new(participant.clone()));
        let (watched, asked) = (Arc::clone(&audience), Arc::clone(&audience));
        let threads = vec![
            Running::start("ros discovery", move |stopped| {
                futures::executor::block_on(watch(participant, &watched, stopped));
            })?,
            Running::start("ros services", move |stopped| {
                futures::executor::block_on(serve(servers, &asked, stopped));
            })?,
        ];
        Ok(Arc::new(Self {
            node: Mutex::new(node),
            surface: options.surface.clone(),
            audience,
            threads,
        }))
    }

    /// Its names and frames.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Announces a topic, of the absolute name `topic`, that messages of `ros_type` (`package/Type`) go to.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn outlet<M: Serialize>(
        &self,
        topic: &str,
        ros_type: &str,
        qos: &QosProfile,
    ) -> Result<Outlet<M>, RosError> {
        let mut node = self.lock();
        let announced = announce(&node, topic, ros_type, qos)?;
        let publisher = node
            .create_publisher(&announced, None)
            .map_err(|cause| endpoint(topic, cause.into()))?;
        Ok(Outlet {
            readers: self.audience.of(topic, publisher.guid()),
            publisher,
        })
    }

    /// Listens to the absolute name `topic` for messages of `ros_type` (`package/Type`).
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn subscription<M: 'static>(
        &self,
        topic: &str,
        ros_type: &str,
        qos: &QosProfile,
    ) -> Result<Subscription<M>, RosError> {
        let mut node = self.lock();
        let announced = announce(&node, topic, ros_type, qos)?;
        let subscription = node
            .create_subscription(&announced, None)
            .map_err(|cause| endpoint(topic, cause.into()))?;
        self.audience.listens(topic, subscription.guid());
        Ok(subscription)
    }

    /// How many readers of a topic, by its absolute name, have been discovered on the network.
    #[must_use]
    pub fn readers_of(&self, topic: &str) -> usize {
        self.audience.readers_of(topic)
    }

    fn lock(&self) -> MutexGuard<'_, Node> {
        self.node.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for RosNode {
    fn drop(&mut self) {
        self.threads.drain(..).for_each(Running::stop);
    }
}

/// A thread that ends when it is told to.
struct Running {
    stop: oneshot::Sender<()>,
    thread: JoinHandle<()>,
}

impl Running {
    fn start(
        name: &str,
        work: impl FnOnce(oneshot::Receiver<()>) + Send + 'static,
    ) -> Result<Self, RosError> {
        let (stop, stopped) = oneshot::channel();
        let thread = thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || work(stopped))
            .map_err(RosError::Thread)?;
        Ok(Self { stop, thread })
    }

    fn stop(self) {
        // It may have ended by itself.
        self.stop.send(()).ok();
        if self.thread.join().is_err() {
            tracing::error!("a thread of the ROS 2 node panicked");
        }
    }
}

/// Where messages of one topic go out.
pub struct Outlet<M: Serialize> {
    publisher: Publisher<M>,
    readers: Arc<AtomicUsize>,
}

impl<M: Serialize> fmt::Debug for Outlet<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Outlet({} readers)",
            self.readers.load(Ordering::Relaxed)
        )
    }
}

impl<M: Serialize> Outlet<M> {
    /// Whether anybody is known to read it.
    #[must_use]
    pub fn has_readers(&self) -> bool {
        self.readers.load(Ordering::Relaxed) > 0
    }

    /// Publishes one message, without waiting for anybody.
    ///
    /// # Errors
    /// When it is not sent, because a slow reader keeps the send window full or the middleware fails.
    pub fn publish(&self, message: M) -> Result<(), Cause> {
        self.publisher
            .publish(message)
            .map_err(|error| error.forget_data().into())
    }
}

/// Follows discovery until it is told to stop.
async fn watch(
    participant: DomainParticipant,
    audience: &Audience,
    stopped: oneshot::Receiver<()>,
) {
    let listener = participant.status_listener();
    let watching = listener.as_async_status_stream().for_each(|event| {
        audience.hear(&event);
        future::ready(())
    });
    future::select(pin!(watching), stopped).await;
}

/// Answers requests until it is told to stop. On a thread of its own, because an answer may have to wait for its reader.
async fn serve(
    offered: Vec<service::Offered>,
    audience: &Audience,
    stopped: oneshot::Receiver<()>,
) {
    let answering = offered.into_iter().map(|one| one.answer_all(audience));
    future::select(future::join_all(answering), stopped).await;
}

/// Reliable, volatile, `depth` messages kept: what most of ROS's topics are. Sending never waits: a full window is an
/// error.
#[must_use]
pub fn reliable(depth: usize) -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth })
}

fn endpoint(name: &str, source: Cause) -> RosError {
    RosError::Endpoint {
        name: name.to_owned(),
        source,
    }
}

fn announce(
    node: &Node,
    topic: &str,
    ros_type: &str,
    qos: &QosProfile,
) -> Result<rustdds::Topic, RosError> {
    let name = Name::parse(topic).map_err(|cause| endpoint(topic, cause.into()))?;
    let (package, type_name) = ros_type.split_once('/').unwrap_or_default();
    node.create_topic(&name, MessageTypeName::new(package, type_name), qos)
        .map_err(|cause| endpoint(topic, cause.into()))
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
    // The library's own parameter services answer one vendor's clients only, and its rosout would log what it sends.
    let options = NodeOptions::new()
        .enable_rosout(false)
        .start_parameter_services(false);
    context
        .new_node(name, options)
        .map_err(|cause| RosError::Node(cause.into()))
}
