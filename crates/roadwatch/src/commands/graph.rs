//! `roadwatch graph`.

use super::check::NOT_PLAYED;
use crate::{cli::ConfigArgs, failure::Failure, session::Session};
use roadwatch_ros::Messages;
use std::sync::Arc;

/// Prints the flow of a configuration: sources, stages, queues, topics.
///
/// # Errors
/// Mistakes in the configuration.
pub fn run(args: &ConfigArgs) -> Result<(), Failure> {
    let session = Session::open(&args.config, None, NOT_PLAYED)?;
    let config = &session.config;
    let surface = &config.node.options.surface;
    for (camera, camera_config) in session
        .rig
        .cameras()
        .iter()
        .zip(config.rig.iter().flat_map(|rig| &rig.cameras))
    {
        let method = camera_config.method.unwrap_or(config.locate.method);
        println!(
            "camera {:<14} {}  located by {method}",
            camera.name.as_str(),
            camera.model.size
        );
    }
    println!("  -> [one slot per camera; realtime: newest wins, lossless: sources wait]");
    if let Some(detector) = &config.detector {
        let options = &detector.options;
        let threads = options.network.threads;
        println!(
            "detect   {} on {threads} threads, two lanes",
            options.model.display()
        );
    }
    println!("  -> [FIFO, 2 frames]");
    println!("perceive recall, locate, identify (left to right), one step for the whole rig");
    println!("  -> [FIFO per sink, full: realtime drops and counts, lossless waits]");
    let messages = Messages::new(Arc::clone(&session.rig), surface).map_err(anyhow::Error::from)?;
    println!(
        "publish  node {}, domain {}",
        surface.private_prefix(),
        config.node.options.domain_id
    );
    for topic in messages.topics() {
        println!("         {:<48} {}", topic.name, topic.kind.ros_type());
    }
    Ok(())
}
