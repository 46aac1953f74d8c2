//! `[node]`: how the daemon appears in ROS 2.

use super::reader::Reader;
use roadwatch_ros::{
    Network, PublishOptions, RosOptions, Surface, node::MAX_DOMAIN_ID, surface::DEFAULT_QUEUE_DEPTH,
};

/// The node as configured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeConfig {
    /// Names, domain, network.
    pub options: RosOptions,
    /// Whether anything is published over DDS.
    pub publish: bool,
    /// What is published, and when.
    pub publishing: PublishOptions,
    /// Whether annotated images are offered.
    pub annotated_images: bool,
    /// Whether it begins to work by itself, or waits for somebody who manages its lifecycle.
    pub autostart: bool,
    /// Whether "now" is what `/clock` says.
    pub use_sim_time: bool,
}

pub(super) fn read(node: &Reader<'_, '_>) -> NodeConfig {
    let defaults = Surface::default();
    let text = |key, default: String| node.text(key).map_or(default, str::to_owned);
    let surface = Surface {
        node_name: text("name", defaults.node_name),
        namespace: text("namespace", defaults.namespace),
        base_frame: text("base_frame", defaults.base_frame),
        scene_in_odom: node.text("scene_in_odom").map(str::to_owned),
        queue_depth: node
            .integer("queue_depth", 1..=1000)
            .map_or(DEFAULT_QUEUE_DEPTH, |depth| depth as usize),
        autoware: node.flag("autoware").unwrap_or(false),
        ..defaults
    };
    note_refused_names(node, &surface);
    let domain_id = node
        .integer("domain_id", 0..=u32::from(MAX_DOMAIN_ID))
        .map(|id| id as u16);
    let localhost_only = node
        .flag("localhost_only")
        .unwrap_or_else(|| localhost_only(node));
    NodeConfig {
        options: RosOptions {
            surface,
            domain_id: domain_id
                .or_else(|| domain_of_environment(node))
                .unwrap_or(0),
            network: if localhost_only {
                Network::LocalhostOnly
            } else {
                Network::AllInterfaces
            },
        },
        publish: node.flag("publish").unwrap_or(true),
        publishing: PublishOptions {
            tf: node.flag("publish_tf").unwrap_or(true),
            unread: node.flag("publish_unread").unwrap_or(false),
        },
        annotated_images: node.flag("annotated_images").unwrap_or(true),
        autostart: node.flag("autostart").unwrap_or(true),
        use_sim_time: node.flag("use_sim_time").unwrap_or(false),
    }
}

/// Notes each name that ROS 2 would refuse, at its own key.
fn note_refused_names(node: &Reader<'_, '_>, surface: &Surface) {
    let alone = |name: Surface| name.check().err();
    let defaults = Surface::default;
    let of_name = alone(Surface {
        node_name: surface.node_name.clone(),
        ..defaults()
    });
    let of_namespace = alone(Surface {
        namespace: surface.namespace.clone(),
        ..defaults()
    });
    let of_frame = alone(Surface {
        base_frame: surface.base_frame.clone(),
        ..defaults()
    });
    let of_odom = alone(Surface {
        scene_in_odom: surface.scene_in_odom.clone(),
        ..defaults()
    });
    for (key, error) in [
        ("name", of_name),
        ("namespace", of_namespace),
        ("base_frame", of_frame),
        ("scene_in_odom", of_odom),
    ] {
        if let Some(error) = error {
            node.note(key, error.to_string());
        }
    }
}

/// `ROS_DOMAIN_ID`, when the configuration does not say.
fn domain_of_environment(node: &Reader<'_, '_>) -> Option<u16> {
    if node.has("domain_id") {
        return None;
    }
    let text = node.document().environment().get("ROS_DOMAIN_ID")?;
    let domain_id = text.trim().parse().ok().filter(|id| *id <= MAX_DOMAIN_ID);
    if domain_id.is_none() {
        let what =
            format!("ROS_DOMAIN_ID is `{text}`; expected a number from 0 to {MAX_DOMAIN_ID}");
        node.note("domain_id", what);
    }
    domain_id
}

/// `ROS_LOCALHOST_ONLY`, and `ROS_AUTOMATIC_DISCOVERY_RANGE` of Iron and later.
fn localhost_only(node: &Reader<'_, '_>) -> bool {
    let environment = node.document().environment();
    if environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") == Some("OFF") {
        let what = "ROS_AUTOMATIC_DISCOVERY_RANGE is OFF, and a node that nobody finds publishes for nobody: say \
                    `publish = false`, or another range";
        node.note("publish", what);
    }
    if environment.get("ROS_STATIC_PEERS").is_some() {
        tracing::warn!(
            "ROS_STATIC_PEERS is not looked at: others are found by multicast, and on this machine"
        );
    }
    environment.get("ROS_LOCALHOST_ONLY") == Some("1")
        || environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") == Some("LOCALHOST")
}
