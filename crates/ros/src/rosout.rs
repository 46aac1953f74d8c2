//! The log, where ROS's tools read it: `/rosout`.

use crate::node::{Outlet, RosError, RosNode, reliable};
use roadwatch_core::Timestamp;
use ros2_client::{Log, builtin_interfaces::Time, qos::Durability};
use std::time::Duration;

/// Messages kept for who joins late, and for how long (`rmw_qos_profile_rosout_default`).
const DEPTH: usize = 1000;
const LIFESPAN: Duration = Duration::from_secs(10);

pub use ros2_client::ros2::LogLevel as Severity;

/// One message of the log.
#[derive(Clone, Debug)]
pub struct LogRecord {
    /// When it was written.
    pub stamp: Timestamp,
    /// How bad it is.
    pub severity: Severity,
    /// What it says.
    pub text: String,
    /// The source file it comes from, and the line.
    pub origin: (String, u32),
}

/// The node's log on the network.
#[derive(Debug)]
pub struct Rosout {
    outlet: Outlet<Log>,
    logger: String,
}

impl Rosout {
    /// Announces `/rosout`.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn announce(node: &RosNode) -> Result<Self, RosError> {
        let qos = reliable(DEPTH)
            .durability(Durability::TransientLocal)
            .lifespan(Some(LIFESPAN));
        Ok(Self {
            outlet: node.outlet("/rosout", "rcl_interfaces/Log", &qos)?,
            // A node's own logger: its namespace and name, parted by dots.
            logger: node.surface().private_prefix()[1..].replace('/', "."),
        })
    }

    /// Publishes one message. One that cannot be sent is lost: there is nowhere to say so but here.
    pub fn log(&self, record: LogRecord) {
        let (file, line) = record.origin;
        let message = Log {
            stamp: Time::from_nanos(record.stamp.as_nanos()),
            level: record.severity as u8,
            name: self.logger.clone(),
            msg: record.text,
            file,
            function: String::new(),
            line,
        };
        self.outlet.publish(message).ok();
    }
}
