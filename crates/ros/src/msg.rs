//! The ROS 2 messages this crate publishes, as plain serde types.
//!
//! Fields stand in the order of the `.msg` files, because CDR has no field names: order and type are
//! the wire format. A test compares every type with its `.msg` file.

pub mod autoware_perception_msgs;
pub mod builtin_interfaces;
pub mod diagnostic_msgs;
pub mod geometry_msgs;
pub mod lifecycle_msgs;
pub mod nav_msgs;
pub mod roadwatch_msgs;
pub mod rosgraph_msgs;
pub mod sensor_msgs;
pub mod std_msgs;
pub mod tf2_msgs;
pub mod unique_identifier_msgs;
pub mod vision_msgs;
pub mod visualization_msgs;

#[cfg(test)]
mod matches_definitions;
