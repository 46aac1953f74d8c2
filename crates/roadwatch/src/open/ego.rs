//! Where the vehicle itself is, as far as it is known from the start.

use crate::config::{Config, EgoConfig, EgoTopic, Notes};
use roadwatch_core::{EgoMotion, error_chain};
use roadwatch_ros::{EgoSource, Surface, tell_from_bag};
use std::sync::Arc;

/// What tells where the vehicle is; a bag that does not is noted.
pub fn ego(config: &Config, notes: &mut Notes) -> Arc<EgoMotion> {
    let motion = match &config.ego {
        EgoConfig::Dataset => of_dataset(config),
        EgoConfig::Still => EgoMotion::still(),
        EgoConfig::Ros { .. } => EgoMotion::default(),
    };
    let motion = Arc::new(motion);
    if let EgoConfig::Ros {
        bag: Some(bag),
        topic,
    } = &config.ego
    {
        let source = ego_source(topic, &config.node.options.surface);
        if let Err(error) = tell_from_bag(bag, &source, &motion) {
            notes.note("ego.bag", error_chain(&error));
        }
    }
    motion
}

/// The topic that tells, by its absolute name.
pub fn ego_source(topic: &EgoTopic, surface: &Surface) -> EgoSource {
    let base_frame = surface.base_frame.clone();
    match topic {
        EgoTopic::Odometry(name) => EgoSource::Odometry {
            topic: surface.topic(name),
            base_frame,
        },
        EgoTopic::Tf(odom_frame) => EgoSource::Transforms {
            odom_frame: odom_frame.clone(),
            base_frame,
        },
    }
}

fn of_dataset(config: &Config) -> EgoMotion {
    let motion = EgoMotion::default();
    let dataset = config.rig.as_ref().and_then(|rig| rig.dataset.as_ref());
    for (at, world_from_base) in dataset.iter().flat_map(|dataset| dataset.ego_poses()) {
        // What cannot be is counted by the motion itself.
        motion.tell(at, world_from_base).ok();
    }
    motion
}
