//! Where the vehicle is, from what others publish or recorded: odometry, or transforms.

use super::{
    bag_images::BagImagesError, bag_messages::messages_of, image_topic::watched,
    transforms::Transforms,
};
use crate::{
    cdr,
    msg::{nav_msgs::Odometry, tf2_msgs::TFMessage},
    node::{RosError, RosNode},
};
use nalgebra::Isometry3;
use roadwatch_core::{EgoMotion, Timestamp};
use ros2_client::{
    QosProfile, Subscription,
    qos::{Durability, History},
};
use rustdds::mio1::{Events, Poll};
use std::{
    fmt,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

/// Poses that wait at most: a second of fast odometry.
const DEPTH: usize = 200;
/// How soon the listening thread notices that it should end.
const LOOK: Duration = Duration::from_millis(100);
/// Poses between two complaints of the same kind.
const COMPLAIN_EVERY: u64 = 1000;

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
    /// `tf2_msgs/TFMessage` on `/tf`.
    Transforms {
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
            Self::Transforms { .. } => "/tf",
        }
    }

    fn ros_type(&self) -> &'static str {
        match self {
            Self::Odometry { .. } => "nav_msgs/msg/Odometry",
            Self::Transforms { .. } => "tf2_msgs/msg/TFMessage",
        }
    }
}

/// Takes messages, tells poses.
struct Teller {
    source: EgoSource,
    transforms: Transforms,
    motion: Arc<EgoMotion>,
    refused: u64,
    said_no_covariance: bool,
}

impl Teller {
    fn new(source: EgoSource, motion: Arc<EgoMotion>) -> Self {
        Self {
            source,
            transforms: Transforms::default(),
            motion,
            refused: 0,
            said_no_covariance: false,
        }
    }

    fn odometry(&mut self, message: &Odometry) {
        let EgoSource::Odometry { topic, base_frame } = &self.source else {
            return;
        };
        let child = message.child_frame_id.trim_start_matches('/');
        if !child.is_empty() && child != base_frame {
            let what = format!("{topic} tells of `{child}`, and the vehicle is `{base_frame}`");
            self.refuse(&what);
            return;
        }
        if message.pose.covariance[0][0] <= 0.0 && !self.said_no_covariance {
            self.said_no_covariance = true;
            tracing::warn!(%topic, "odometry has no covariance: it is taken as exact");
        }
        let pose = Isometry3::from(&message.pose.pose);
        self.tell(message.header.stamp.into(), pose);
    }

    fn transforms(&mut self, message: &TFMessage, is_static: bool) {
        let EgoSource::Transforms {
            odom_frame,
            base_frame,
        } = &self.source
        else {
            return;
        };
        let moved = self.transforms.take(message, is_static);
        let pose = self.transforms.pose(odom_frame, base_frame);
        if let Some((at, pose)) = moved.zip(pose) {
            self.tell(at, pose);
        }
    }

    fn tell(&mut self, at: Timestamp, pose: Isometry3<f64>) {
        if let Err(refused) = self.motion.tell(at, pose) {
            self.refuse(&refused.to_string());
        }
    }

    fn refuse(&mut self, what: &str) {
        if self.refused.is_multiple_of(COMPLAIN_EVERY) {
            let (topic, refused) = (self.source.topic(), self.refused);
            tracing::warn!(%topic, refused, "a pose of the vehicle is not taken: {what}");
        }
        self.refused += 1;
    }
}

enum Subscribed {
    Odometry(Box<Subscription<Odometry>>),
    /// Moving, and static.
    Transforms([Box<Subscription<TFMessage>>; 2]),
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
        let qos = QosProfile::subscription_default()
            .reliability_best_effort()
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: DEPTH });
        let latched = QosProfile::subscription_default()
            .durability(Durability::TransientLocal)
            .history(History::KeepLast { depth: DEPTH });
        let poll = Poll::new().map_err(RosError::Thread)?;
        let subscribed = match &source {
            EgoSource::Odometry { topic, .. } => {
                let what = (topic.as_str(), "nav_msgs/Odometry");
                Subscribed::Odometry(Box::new(watched(node, what, &qos, &poll)?))
            }
            EgoSource::Transforms { .. } => {
                let ros_type = "tf2_msgs/TFMessage";
                Subscribed::Transforms([
                    Box::new(watched(node, ("/tf", ros_type), &qos, &poll)?),
                    Box::new(watched(node, ("/tf_static", ros_type), &latched, &poll)?),
                ])
            }
        };
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let mut teller = Teller::new(source.clone(), motion);
        let listen = move || {
            let (mut poll, mut events) = (poll, Events::with_capacity(4));
            while !stopped.load(Ordering::Relaxed) {
                take(&subscribed, &mut teller);
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

fn take(subscribed: &Subscribed, teller: &mut Teller) {
    match subscribed {
        Subscribed::Odometry(odometry) => {
            while let Ok(Some((message, _))) = odometry.take() {
                teller.odometry(&message);
            }
        }
        Subscribed::Transforms([moving, fixed]) => {
            while let Ok(Some((message, _))) = fixed.take() {
                teller.transforms(&message, true);
            }
            while let Ok(Some((message, _))) = moving.take() {
                teller.transforms(&message, false);
            }
        }
    }
}

/// Tells everything that a bag has of it, in order of log times.
///
/// # Errors
/// When there is no bag, no such topic, or another type on it.
pub fn tell_from_bag(
    bag: &Path,
    source: &EgoSource,
    motion: &Arc<EgoMotion>,
) -> Result<(), BagImagesError> {
    let mut teller = Teller::new(source.clone(), Arc::clone(motion));
    if let EgoSource::Transforms { .. } = source {
        let fixed = messages_of(bag, "/tf_static", source.ros_type());
        for bytes in fixed.into_iter().flatten() {
            if let Ok(message) = cdr::decode::<TFMessage>(&bytes) {
                teller.transforms(&message, true);
            }
        }
    }
    for bytes in messages_of(bag, source.topic(), source.ros_type())? {
        let told = match source {
            EgoSource::Odometry { .. } => cdr::decode(&bytes).map(|m| teller.odometry(&m)),
            EgoSource::Transforms { .. } => {
                cdr::decode(&bytes).map(|m| teller.transforms(&m, false))
            }
        };
        if let Err(error) = told {
            teller.refuse(&error.to_string());
        }
    }
    Ok(())
}
