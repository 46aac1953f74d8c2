//! ROS 2 messages, publishers and bags: what was seen, in the words of other people's tools.
//!
//! [`convert::Messages`] turns outputs into messages of the closed list in [`topics`]; [`RosSink`]
//! publishes them over DDS and [`BagSink`] records the same messages as MCAP. Needs no ROS installation.

pub mod bag;
pub mod cdr;
pub mod convert;
pub mod definitions;
pub mod msg;
pub mod ros_args;
pub mod ros_sink;
pub mod surface;
pub mod topics;

#[cfg(test)]
#[path = "../tests/common/mod.rs"]
mod testing;

pub use bag::{BagError, BagSink, LogTime};
pub use convert::{Message, Messages, Outgoing};
pub use ros_args::{LogLevel, RosArgs, RosArgsError};
pub use ros_sink::{Network, RosError, RosOptions, RosSink};
pub use surface::{InvalidSurface, Surface};
pub use topics::{Topic, TopicKind, Topics};
