//! What a bag says of where the vehicle was.

use super::{
    EgoSource,
    teller::{Pose, Teller},
};
use crate::{
    cdr,
    input::{bag_error::BagImagesError, bag_messages::messages_of, transforms::Moves},
    msg::{geometry_msgs::TransformStamped, nav_msgs::Odometry, tf2_msgs::TFMessage},
};
use roadwatch_core::{EgoMotion, Timestamp};
use std::{path::Path, sync::Arc, time::Instant};

/// Tells everything that a bag has of it, in order of stamps, so that runs do not depend on how it was recorded.
///
/// # Errors
/// When there is no bag, no such topic, another type on it, or nothing of the vehicle in it.
pub fn tell_from_bag(
    bag: &Path,
    source: &EgoSource,
    motion: &Arc<EgoMotion>,
) -> Result<(), BagImagesError> {
    let mut teller = Teller::new(source.clone(), Arc::clone(motion), Instant::now());
    match source {
        EgoSource::Odometry { topic, .. } => {
            let messages = messages_of(bag, topic, source.ros_type())?;
            for pose in in_order(odometry(&messages, &mut teller), |(at, _)| *at) {
                teller.tell(pose);
            }
        }
        EgoSource::Transforms { moving, fixed, .. } => {
            let fixed = match messages_of(bag, fixed, source.ros_type()) {
                // Where every frame moves, none is needed.
                Err(BagImagesError::NoSuch { .. }) => Vec::new(),
                messages => messages?,
            };
            let moving = messages_of(bag, moving, source.ros_type())?;
            for (messages, moves) in [(fixed, Moves::Never), (moving, Moves::Always)] {
                let transforms = transforms(&messages, &mut teller);
                for transform in in_order(transforms, |transform| transform.header.stamp.into()) {
                    teller.transform(&transform, moves);
                }
            }
        }
    }
    match motion.counts().taken {
        0 => Err(BagImagesError::TellsNothing {
            path: bag.to_owned(),
            topic: source.topic().to_owned(),
            why: teller.why_nothing(),
        }),
        _ => Ok(()),
    }
}

fn odometry(messages: &[Vec<u8>], teller: &mut Teller) -> Vec<Pose> {
    let decoded = messages.iter().map(|bytes| cdr::decode::<Odometry>(bytes));
    let poses = decoded.filter_map(|decoded| match decoded {
        Ok(message) => teller.pose_of(&message),
        Err(error) => {
            teller.unreadable(&error.to_string());
            None
        }
    });
    poses.collect()
}

fn transforms(messages: &[Vec<u8>], teller: &mut Teller) -> Vec<TransformStamped> {
    let decoded = messages.iter().map(|bytes| cdr::decode::<TFMessage>(bytes));
    let transforms = decoded.flat_map(|decoded| match decoded {
        Ok(message) => message.transforms,
        Err(error) => {
            teller.unreadable(&error.to_string());
            Vec::new()
        }
    });
    transforms.collect()
}

/// What has the same stamp stays in the order of the recording.
fn in_order<T>(mut all: Vec<T>, at: impl Fn(&T) -> Timestamp) -> Vec<T> {
    all.sort_by_key(at);
    all
}
