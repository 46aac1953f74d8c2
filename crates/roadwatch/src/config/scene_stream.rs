//! `[scene_stream]`: the scene for programs that do not speak ROS 2.

use super::reader::Reader;
use std::net::SocketAddr;

/// Where the scene is offered as JSON lines; `None` nowhere.
pub(super) fn read(stream: &Reader<'_, '_>) -> Option<SocketAddr> {
    if !stream.is_present() {
        return None;
    }
    let address = stream.required_text("listen")?;
    match address.parse() {
        Ok(address) => Some(address),
        Err(_) => {
            stream.note(
                "listen",
                format!("`{address}` is no address with a port, such as \"127.0.0.1:7600\""),
            );
            None
        }
    }
}
