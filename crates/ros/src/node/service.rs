//! Services that clients of every vendor can call.
//!
//! ROS 2 has no one way to say which answer belongs to which request. `rmw_fastrtps` (and others) follow the enhanced
//! mapping of DDS-RPC 1.0 (7.2.4): a parameter beside the message. `rmw_cyclonedds` puts a header of sixteen bytes in
//! front of the message instead. Topics and types are the same, so one server hears both kinds of clients, and tells
//! them apart by the vendor in the GUID of who asks (DDSI-RTPS 2.5, 8.2.4.2).

use super::{Cause, RosError, audience::Audience, endpoint, raw::Raw, reliable};
use byteorder::LittleEndian;
use ros2_client::{Name, Node, RmwRequestId, Server, ServiceMapping, ServiceTypeName};
use serde::{Serialize, de::DeserializeOwned};
use std::fmt;

/// Eclipse Cyclone DDS in the list of vendors (DDSI-RTPS 2.5, 9.4.3.1), the first two bytes of its GUIDs.
const CYCLONE: [u8; 2] = [0x01, 0x10];
/// Half a GUID and a sequence number, which `rmw_cyclonedds` puts in front of requests and wants back.
const CYCLONE_HEADER_LENGTH: usize = 16;
/// ROS's default profile for services (`rmw_qos_profile_services_default`).
const DEPTH: usize = 10;

/// Package and name of a service's type, such as `("lifecycle_msgs", "GetState")`.
pub type ServiceType = (&'static str, &'static str);

type Answer = Box<dyn FnMut(&[u8]) -> Result<Vec<u8>, cdr_encoding::Error> + Send>;

/// Something that the node does when it is asked.
pub struct Service {
    name: String,
    ros_type: ServiceType,
    answer: Answer,
}

impl fmt::Debug for Service {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Service({})", self.name)
    }
}

impl Service {
    /// A service of the absolute name `name`; `answer` is called for one request after the other.
    pub fn new<Q: DeserializeOwned, A: Serialize>(
        name: impl Into<String>,
        ros_type: ServiceType,
        mut answer: impl FnMut(Q) -> A + Send + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            ros_type,
            answer: Box::new(move |request| {
                let (request, _) = cdr_encoding::from_bytes::<Q, LittleEndian>(request)?;
                cdr_encoding::to_vec::<A, LittleEndian>(&answer(request))
            }),
        }
    }

    /// # Errors
    /// When the middleware refuses.
    pub(super) fn offered_by(self, node: &mut Node) -> Result<Offered, RosError> {
        let refused = |source: Cause| endpoint(&self.name, source);
        let name = Name::parse(&self.name).map_err(|cause| refused(cause.into()))?;
        let (package, type_name) = self.ros_type;
        let qos = reliable(DEPTH);
        let server = node.create_server(
            ServiceMapping::Enhanced,
            &name,
            &ServiceTypeName::new(package, type_name),
            qos.clone(),
            qos,
        );
        Ok(Offered {
            server: server.map_err(|cause| refused(cause.into()))?,
            service: self,
        })
    }
}

/// A service on the network.
pub(super) struct Offered {
    server: Server<Raw, Raw>,
    service: Service,
}

impl Offered {
    /// Answers requests, for ever.
    pub(super) async fn answer_all(mut self, audience: &Audience) {
        let replies = format!("rr{}Reply", self.service.name);
        loop {
            let answered = match self.server.async_receive_request().await {
                Ok((id, request)) => {
                    audience.wait_for(&replies, id.writer_gid.into());
                    self.answer(id, &request.0)
                }
                Err(error) => Err(error.into()),
            };
            if let Err(error) = answered {
                let service = &self.service.name;
                tracing::warn!(%service, error, "a request was not answered");
            }
        }
    }

    fn answer(&mut self, id: RmwRequestId, request: &[u8]) -> Result<(), Cause> {
        let (header, request) = if id.writer_gid.to_bytes16().starts_with(&CYCLONE) {
            let whole = request.split_at_checked(CYCLONE_HEADER_LENGTH);
            whole.ok_or("shorter than Cyclone's header")?
        } else {
            request.split_at(0)
        };
        let mut answer = header.to_vec();
        answer.extend((self.service.answer)(request)?);
        self.server.send_response(id, Raw(answer))?;
        Ok(())
    }
}
