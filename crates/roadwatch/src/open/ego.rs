//! Where the vehicle itself is, as far as it is known from the start.

use crate::config::{Config, EgoConfig, EgoTopic, Notes};
use roadwatch_core::{EgoMotion, error_chain};
use roadwatch_ros::{EgoSource, Surface, tell_from_bag};
use std::{path::Path, sync::Arc};

/// What tells where the vehicle is; a bag that does not is noted.
pub fn ego(config: &Config, notes: &mut Notes) -> Arc<EgoMotion> {
    let base_frame = &config.node.options.surface.base_frame;
    if matches!(&config.ego, EgoConfig::Ros { topic: EgoTopic::Tf(frame), .. } if frame == base_frame)
    {
        let what = format!(
            "`{base_frame}` is the vehicle itself: expected a frame that is fixed to the ground"
        );
        notes.note("ego.tf_frame", what);
    }
    Arc::new(match &config.ego {
        EgoConfig::Dataset => of_dataset(config),
        EgoConfig::Still => EgoMotion::still(),
        EgoConfig::Ros { bag: None, .. } => EgoMotion::default(),
        EgoConfig::Ros {
            bag: Some(bag),
            topic,
        } => {
            // Names in a bag are those it was recorded with.
            let surface = Surface {
                remapped: Vec::new(),
                ..config.node.options.surface.clone()
            };
            return of_bag(bag, &ego_source(topic, &surface), notes);
        }
    })
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
            moving: surface.topic("/tf"),
            fixed: surface.topic("/tf_static"),
            odom_frame: odom_frame.clone(),
            base_frame,
        },
    }
}

fn of_bag(bag: &Path, source: &EgoSource, notes: &mut Notes) -> Arc<EgoMotion> {
    let motion = Arc::new(EgoMotion::recorded());
    if let Err(error) = tell_from_bag(bag, source, &motion) {
        notes.note("ego.bag", error_chain(&error));
    }
    motion
}

fn of_dataset(config: &Config) -> EgoMotion {
    let dataset = config.rig.as_ref().and_then(|rig| rig.dataset.as_ref());
    dataset.map_or_else(EgoMotion::default, |dataset| dataset.ego_motion())
}
