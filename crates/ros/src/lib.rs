//! ROS 2 messages, publishers and bags: what was seen, in the words of other people's tools.
//!
//! [`convert::Messages`] turns outputs into messages of the closed list in [`topics`]; [`RosSink`]
//! publishes them over DDS and [`BagSink`] records the same messages as MCAP. Needs no ROS installation.

pub mod bag;
pub mod cdr;
pub mod convert;
pub mod definitions;
pub mod input;
pub mod lifecycle;
pub mod msg;
pub mod node;
pub mod parameters;
pub mod ros_args;
pub mod ros_sink;
pub mod rosout;
pub mod scene_lines;
pub mod scene_stream;
pub mod sim_clock;
pub mod surface;
pub mod topics;
pub mod type_hash;

#[cfg(test)]
#[path = "../tests/common/mod.rs"]
mod testing;

pub use bag::{BagError, BagOptions, BagSink, LogTime};
pub use convert::{Message, Messages, Outgoing};
pub use input::{
    BagImages, EgoListener, EgoSource, ImageMessage, ImageTopic, Recorded, RecordedError,
    TopicCamera, tell_from_bag,
};
pub use lifecycle::Lifecycle;
pub use node::{Network, Outlet, RosError, RosNode, RosOptions, Service};
pub use parameters::{Parameter, ParameterValue, Parameters};
pub use ros_args::{LogLevel, ParameterRule, RosArgs, RosArgsError};
pub use ros_sink::{Outlets, PublishOptions, RosSink};
pub use rosout::Rosout;
pub use scene_stream::SceneStream;
pub use sim_clock::SimClock;
pub use surface::{InvalidSurface, Surface};
pub use topics::{Topic, TopicKind, Topics};
pub use type_hash::type_hash;
