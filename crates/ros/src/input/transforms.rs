//! The newest transforms between frames, and what they say together.

use crate::msg::{geometry_msgs::TransformStamped, tf2_msgs::TFMessage};
use nalgebra::Isometry3;
use roadwatch_core::Timestamp;
use std::collections::BTreeMap;

/// Longer chains of frames are circles.
const LONGEST_CHAIN: usize = 32;
/// Transforms of one child by two parents, or of one stamp and two values, are said at most so often.
const COMPLAINTS: u32 = 3;

/// Frames with their parents.
#[derive(Debug, Default)]
pub(super) struct Transforms {
    parents: BTreeMap<String, Edge>,
    complaints: u32,
}

#[derive(Debug)]
struct Edge {
    parent: String,
    at: Timestamp,
    from_child: Isometry3<f64>,
}

impl Transforms {
    /// Takes a message in. Gives the newest stamp of what it moved; `None` of a static one.
    pub(super) fn take(&mut self, message: &TFMessage, is_static: bool) -> Option<Timestamp> {
        let mut newest = None;
        for transform in &message.transforms {
            self.take_one(transform);
            newest = newest.max(Some(transform.header.stamp.into()));
        }
        newest.filter(|_| !is_static)
    }

    fn take_one(&mut self, transform: &TransformStamped) {
        let name = |text: &str| text.trim_start_matches('/').to_owned();
        let child = name(&transform.child_frame_id);
        let edge = Edge {
            parent: name(&transform.header.frame_id),
            at: transform.header.stamp.into(),
            from_child: (&transform.transform).into(),
        };
        if let Some(before) = self.parents.get(&child) {
            let twice = before.parent != edge.parent
                || before.at == edge.at && before.from_child != edge.from_child;
            if twice && self.complaints < COMPLAINTS {
                self.complaints += 1;
                tracing::warn!(
                    frame = %child, parent = %edge.parent, other_parent = %before.parent,
                    "two publishers say where a frame is: the last one counts"
                );
            }
        }
        self.parents.insert(child, edge);
    }

    /// Where a frame is in another; `None` while no chain of transforms leads there.
    pub(super) fn pose(&self, of: &str, in_it: &str) -> Option<Isometry3<f64>> {
        let (mut frame, mut pose) = (in_it, Isometry3::identity());
        for _ in 0..LONGEST_CHAIN {
            if frame == of {
                return Some(pose);
            }
            let edge = self.parents.get(frame)?;
            pose = edge.from_child * pose;
            frame = &edge.parent;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::{geometry_msgs::Transform, std_msgs::Header};
    use nalgebra::Vector3;

    fn message(parent: &str, child: &str, nanos: i64, x: f64, yaw_rad: f64) -> TFMessage {
        let pose = Isometry3::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * yaw_rad);
        TFMessage {
            transforms: vec![TransformStamped {
                header: Header::new(Timestamp::from_nanos(nanos), parent),
                child_frame_id: child.to_owned(),
                transform: Transform::from(&pose),
            }],
        }
    }

    #[test]
    fn a_pose_follows_from_a_chain_of_moving_and_static_transforms() {
        let mut transforms = Transforms::default();
        let fixed = message("base_footprint", "base_link", 0, 1.0, 0.0);
        assert_eq!(transforms.take(&fixed, true), None);
        assert_eq!(transforms.pose("odom", "base_link"), None);
        let quarter = std::f64::consts::FRAC_PI_2;
        let moved = transforms.take(&message("/odom", "base_footprint", 7, 5.0, quarter), false);
        assert_eq!(moved, Some(Timestamp::from_nanos(7)));
        let pose = transforms.pose("odom", "base_link").expect("a chain");
        let off = pose.translation.vector - Vector3::new(5.0, 1.0, 0.0);
        assert!(off.norm() < 1e-9, "{pose}");
    }

    #[test]
    fn frames_in_a_circle_lead_nowhere() {
        let mut transforms = Transforms::default();
        transforms.take(&message("a", "b", 0, 1.0, 0.0), false);
        transforms.take(&message("b", "a", 0, 1.0, 0.0), false);
        assert_eq!(transforms.pose("odom", "a"), None);
    }
}
