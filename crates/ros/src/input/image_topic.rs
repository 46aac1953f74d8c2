//! An image topic as a camera.

use super::{
    COMPRESSED, ImageMessage, camera_info_check::contradiction, one_publisher::OnePublisher,
    stands_still,
};
use crate::{
    msg::sensor_msgs::{CameraInfo, CompressedImage, Image},
    node::{RosError, RosNode},
};
use roadwatch_core::{
    CameraId, DecodeError, Frame, FrameSource, Image as FrameImage, RigCamera, SourceError,
    Timestamp,
};
use ros2_client::{
    MessageInfo, QosProfile, Subscription,
    qos::{Durability, History},
};
use rustdds::mio1::{Events, Interest, Poll, Token};
use serde::de::DeserializeOwned;
use std::{
    fmt, io,
    time::{Duration, Instant},
};

/// Images kept while the camera's thread is busy: it takes all there are, and the newest counts.
const DEPTH: usize = 2;
/// A stamp that jumps back by more is a recording that begins anew, or a clock that was set; less is disorder.
const NEW_BEGINNING: Duration = Duration::from_secs(1);

/// Turns what came into an image that is decoded when somebody looks.
pub type ToImage = Box<dyn Fn(ImageMessage) -> Result<FrameImage, DecodeError> + Send>;

/// What a topic stands for.
pub struct TopicCamera {
    /// The camera's place in the rig.
    pub id: CameraId,
    /// The camera, which `camera_info` must not contradict.
    pub camera: RigCamera,
    /// Absolute name of its images: `sensor_msgs/CompressedImage` where it ends in `/compressed`, else
    /// `sensor_msgs/Image`.
    pub images: String,
    /// Absolute name of its `sensor_msgs/CameraInfo`; `None` where nobody publishes one.
    pub info: Option<String>,
}

enum Images {
    Raw(Subscription<Image>),
    Compressed(Subscription<CompressedImage>),
}

/// An image topic as a camera: the newest image, with the stamp it came with.
pub struct ImageTopic {
    what: TopicCamera,
    images: Images,
    info: Option<Subscription<CameraInfo>>,
    /// Why what the topic's `camera_info` says cannot be; `None` while it says nothing, or what the rig says.
    contradiction: Option<String>,
    to_image: ToImage,
    poll: Poll,
    events: Events,
    last_stamp: Option<Timestamp>,
    publisher: OnePublisher,
    seq: u64,
}

impl fmt::Debug for ImageTopic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ImageTopic({})", self.what.images)
    }
}

impl ImageTopic {
    /// Listens. Readers ask for best effort, which publishers of either kind match (REP-2003).
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn listen(node: &RosNode, what: TopicCamera, to_image: ToImage) -> Result<Self, RosError> {
        let qos = QosProfile::subscription_default()
            .reliability_best_effort()
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: DEPTH });
        let poll = Poll::new().map_err(RosError::Thread)?;
        let images = if what.images.ends_with(COMPRESSED) {
            let ros_type = "sensor_msgs/CompressedImage";
            Images::Compressed(watched(node, (&what.images, ros_type), &qos, &poll)?)
        } else {
            let ros_type = "sensor_msgs/Image";
            Images::Raw(watched(node, (&what.images, ros_type), &qos, &poll)?)
        };
        let info = what.info.as_ref();
        let info = info.map(|name| node.subscription(name, "sensor_msgs/CameraInfo", &qos));
        Ok(Self {
            images,
            info: info.transpose()?,
            contradiction: None,
            to_image,
            poll,
            events: Events::with_capacity(4),
            last_stamp: None,
            publisher: OnePublisher::default(),
            seq: 0,
            what,
        })
    }

    /// The next message that waits; an error when what waits is no image.
    fn take(&self) -> Result<Option<(ImageMessage, MessageInfo)>, SourceError> {
        let lost = |error: ros2_client::ReadError| SourceError::FrameLost(error.into());
        match &self.images {
            Images::Raw(images) => {
                let taken = images.take().map_err(lost)?;
                Ok(taken.map(|(image, info)| (ImageMessage::Raw(image), info)))
            }
            Images::Compressed(images) => {
                let taken = images.take().map_err(lost)?;
                Ok(taken.map(|(image, info)| (ImageMessage::Compressed(image), info)))
            }
        }
    }

    fn frame(&mut self, message: ImageMessage, info: &MessageInfo) -> Result<Frame, String> {
        let received_at = Instant::now();
        // One publisher is the camera. Another one's images would be places where nobody is.
        if !self.publisher.admits(info.publisher_gid(), received_at) {
            let topic = &self.what.images;
            return Err(format!(
                "two publishers on {topic}: the images of the second are not looked at"
            ));
        }
        self.look_at_info();
        if let Some(contradiction) = &self.contradiction {
            return Err(contradiction.clone());
        }
        let captured_at = message.stamp();
        self.check_stamp(captured_at)?;
        let image = (self.to_image)(message).map_err(|error| error.to_string())?;
        let seq = self.seq;
        self.seq += 1;
        Ok(Frame {
            camera: self.what.id,
            seq,
            captured_at,
            received_at,
            image,
        })
    }

    fn check_stamp(&mut self, stamp: Timestamp) -> Result<(), String> {
        if let Some(last) = self.last_stamp {
            let back = last.saturating_since(stamp);
            if stamp <= last && back < NEW_BEGINNING {
                return Err(stands_still(stamp, last));
            }
            if stamp < last {
                let topic = &self.what.images;
                tracing::warn!(%topic, "time begins anew: {}", stands_still(stamp, last));
            }
        }
        if stamp == Timestamp::from_nanos(0) {
            return Err(stands_still(stamp, stamp));
        }
        self.last_stamp = Some(stamp);
        Ok(())
    }

    fn look_at_info(&mut self) {
        let Some(infos) = &self.info else {
            return;
        };
        while let Ok(Some((info, _))) = infos.take() {
            let found = contradiction(&info, &self.what.camera);
            let topic = self.what.info.as_deref().unwrap_or_default();
            self.contradiction = found.map(|what| format!("{topic} contradicts the rig: {what}"));
        }
    }

    fn wait(&mut self, left: Duration) -> io::Result<()> {
        match self.poll.poll(&mut self.events, Some(left)) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(()),
            waited => waited,
        }
    }
}

/// A subscription that wakes `poll`.
pub(super) fn watched<M: DeserializeOwned + 'static>(
    node: &RosNode,
    (topic, ros_type): (&str, &str),
    qos: &QosProfile,
    poll: &Poll,
) -> Result<Subscription<M>, RosError> {
    let mut subscription = node.subscription(topic, ros_type, qos)?;
    poll.registry()
        .register(&mut subscription, Token(0), Interest::READABLE)
        .map_err(RosError::Thread)?;
    Ok(subscription)
}

impl FrameSource for ImageTopic {
    fn next_frame(&mut self, deadline: Instant) -> Result<Frame, SourceError> {
        loop {
            if let Some((message, info)) = self.take()? {
                let frame = self.frame(message, &info);
                return frame.map_err(|what| SourceError::FrameLost(what.into()));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(SourceError::Timeout);
            }
            self.wait(left)
                .map_err(|error| SourceError::Disconnected(error.into()))?;
        }
    }
}
