//! `roadwatch graph`.

use super::check::NOT_PLAYED;
use super::output::say;
use crate::{cli::ConfigArgs, failure::Failure, session::Session};
use roadwatch_pipeline::{DETECTED_QUEUE_LEN, LANES};
use roadwatch_ros::{Messages, surface::annotated_topic};
use std::sync::Arc;

/// Prints the flow of a configuration: sources, stages, queues, topics.
///
/// # Errors
/// Mistakes in the configuration.
pub fn run(args: &ConfigArgs) -> Result<(), Failure> {
    let session = Session::open(&args.config, &args.ros.read().into(), NOT_PLAYED)?;
    let config = &session.config;
    let surface = &config.node.options.surface;
    for (camera, camera_config) in session
        .rig
        .cameras()
        .iter()
        .zip(config.rig.iter().flat_map(|rig| &rig.cameras))
    {
        let method = camera_config.method_or(config.locate.method);
        say!(
            "camera {:<14} {}  located by {method}",
            camera.name.as_str(),
            camera.model.size
        );
    }
    say!("  -> [one slot per camera; realtime: newest wins, lossless: sources wait]");
    if let Some(detector) = &config.detector {
        let options = &detector.options;
        let threads = options.network.threads;
        say!(
            "detect   {} on {threads} threads, {LANES} lanes",
            options.model.display()
        );
    }
    say!("  -> [FIFO, {DETECTED_QUEUE_LEN} frames]");
    let rule = config.reid.identities.as_str();
    say!("perceive recall, locate, identify ({rule}), one step for the whole rig");
    say!("  -> [FIFO per sink, full: realtime drops and counts, lossless waits]");
    let messages = Messages::new(Arc::clone(&session.rig), surface).map_err(anyhow::Error::from)?;
    say!(
        "publish  node {}, domain {}",
        surface.private_prefix(),
        config.node.options.domain_id
    );
    for topic in messages.topics() {
        say!("         {:<48} {}", topic.name, topic.kind.ros_type());
    }
    if let Some(address) = config.scene_stream {
        say!("stream   the scene as JSON lines on {address}");
    }
    if config.node.annotated_images {
        for camera in session.rig.cameras() {
            let topic = annotated_topic(surface, camera.name.as_str());
            say!("         {topic:<48} sensor_msgs/CompressedImage");
        }
    }
    Ok(())
}
