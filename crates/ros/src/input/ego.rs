//! Where the vehicle is, from what others publish or recorded: odometry, or transforms.

mod recorded;
mod teller;

use super::{image_topic::watched, one_publisher::OnePublisher, transforms::Moves};
use crate::{
    msg::{nav_msgs::Odometry, tf2_msgs::TFMessage},
    node::{RosError, RosNode},
};
use roadwatch_core::EgoMotion;
use ros2_client::{
    MessageInfo, QosProfile, Subscription,
    qos::{Durability, History},
};
use rustdds::mio1::{Events, Poll};
use serde::de::DeserializeOwned;
use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use teller::Teller;

pub use recorded::tell_from_bag;

/// Poses that wait at most: a second of fast odometry.
const DEPTH: usize = 200;
/// How soon the listening thread notices that it should end.
const LOOK: Duration = Duration::from_millis(100);

/// What tells where the vehicle is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EgoSource {
    /// `nav_msgs/Odometry` of the base frame.
    Odometry {
        /// Absolute name.
        topic: String,
        /// Frame of the vehicle.
        base_frame: String,
    },
    /// `tf2_msgs/TFMessage`.
    Transforms {
        /// Absolute name of the topic of those that move: `/tf`.
        moving: String,
        /// Absolute name of the topic of those that never do: `/tf_static`.
        fixed: String,
        /// Frame that is fixed to the ground.
        odom_frame: String,
        /// Frame of the vehicle.
        base_frame: String,
    },
}

impl EgoSource {
    /// The topic that is listened to.
    #[must_use]
    pub fn topic(&self) -> &str {
        match self {
            Self::Odometry { topic, .. } => topic,
            Self::Transforms { moving, .. } => moving,
        }
    }

    fn base_frame(&self) -> &str {
        match self {
            Self::Odometry { base_frame, .. } | Self::Transforms { base_frame, .. } => base_frame,
        }
    }

    /// As bags name it.
    fn ros_type(&self) -> &'static str {
        match self {
            Self::Odometry { .. } => "nav_msgs/msg/Odometry",
            Self::Transforms { .. } => "tf2_msgs/msg/TFMessage",
        }
    }
}

enum Subscribed {
    Odometry(Box<Subscription<Odometry>>, OnePublisher),
    Transforms {
        moving: Box<Subscription<TFMessage>>,
        fixed: Box<Subscription<TFMessage>>,
    },
}

/// Listens, until it is dropped.
pub struct EgoListener {
    stop: Arc<AtomicBool>,
    source: EgoSource,
}

impl fmt::Debug for EgoListener {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EgoListener({:?})", self.source)
    }
}

impl EgoListener {
    /// Tells `motion` what comes, best effort asked, which publishers of either kind match.
    ///
    /// # Errors
    /// When the middleware refuses, or the system gives no thread.
    pub fn listen(
        node: &RosNode,
        source: EgoSource,
        motion: Arc<EgoMotion>,
    ) -> Result<Self, RosError> {
        let poll = Poll::new().map_err(RosError::Thread)?;
        let mut subscribed = Subscribed::to(node, &source, &poll)?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let mut teller = Teller::new(source.clone(), motion, Instant::now());
        let listen = move || {
            let (mut poll, mut events) = (poll, Events::with_capacity(4));
            while !stopped.load(Ordering::Relaxed) {
                subscribed.tell(&mut teller);
                teller.look(Instant::now());
                // Woken early or late, the next round takes what is there.
                poll.poll(&mut events, Some(LOOK)).ok();
            }
        };
        let named = thread::Builder::new().name("ego".to_owned());
        named.spawn(listen).map_err(RosError::Thread)?;
        Ok(Self { stop, source })
    }
}

impl Drop for EgoListener {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Subscribed {
    fn to(node: &RosNode, source: &EgoSource, poll: &Poll) -> Result<Self, RosError> {
        let qos = QosProfile::subscription_default()
            .reliability_best_effort()
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: DEPTH });
        let latched = QosProfile::subscription_default()
            .durability(Durability::TransientLocal)
            .history(History::KeepLast { depth: DEPTH });
        Ok(match source {
            EgoSource::Odometry { topic, .. } => {
                let what = (topic.as_str(), "nav_msgs/Odometry");
                let odometry = watched(node, what, &qos, poll)?;
                Self::Odometry(Box::new(odometry), OnePublisher::default())
            }
            EgoSource::Transforms { moving, fixed, .. } => {
                let ros_type = "tf2_msgs/TFMessage";
                Self::Transforms {
                    moving: Box::new(watched(node, (moving, ros_type), &qos, poll)?),
                    fixed: Box::new(watched(node, (fixed, ros_type), &latched, poll)?),
                }
            }
        })
    }

    /// Tells everything that waits.
    fn tell(&mut self, teller: &mut Teller) {
        match self {
            Self::Odometry(odometry, publisher) => {
                while let Some((message, info)) = next(odometry, teller) {
                    if !publisher.admits(info.publisher_gid(), Instant::now()) {
                        teller.second_publisher();
                    } else if let Some(pose) = teller.pose_of(&message) {
                        teller.tell(pose);
                    }
                }
            }
            Self::Transforms { moving, fixed } => {
                for (topic, moves) in [(fixed, Moves::Never), (moving, Moves::Always)] {
                    while let Some((message, _)) = next(topic, teller) {
                        for transform in &message.transforms {
                            teller.transform(transform, moves);
                        }
                    }
                }
            }
        }
    }
}

/// The next message that waits and can be read.
fn next<M: DeserializeOwned + 'static>(
    topic: &Subscription<M>,
    teller: &mut Teller,
) -> Option<(M, MessageInfo)> {
    loop {
        match topic.take() {
            Ok(taken) => return taken,
            // Each look goes beyond what could not be read.
            Err(error) => teller.unreadable(&error.to_string()),
        }
    }
}
