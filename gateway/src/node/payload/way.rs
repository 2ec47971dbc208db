//! The connection to a payload.

use super::forward;
use super::passed_payload::Payload;
use super::shared_line::SharedLine;
use crate::link::{HostPort, LinkAddress, LinkError};
use bus::Slot;
use std::net::TcpStream;
use std::sync::Arc;

/// How a payload is reached.
pub(super) enum Way {
    /// One connection for each client.
    Tcp(HostPort),
    /// One connection shared by all clients.
    Shared(SharedLine),
}

impl Way {
    pub(super) fn open(payload: &Arc<Payload>) -> Result<Way, LinkError> {
        Ok(match &payload.port.address {
            LinkAddress::Tcp(_, at) => Way::Tcp(at.clone()),
            address => Way::Shared(SharedLine::open(payload, address)?),
        })
    }

    /// Serves a client until it or the payload is lost.
    pub(super) fn serve(&self, payload: &Payload, slot: &Slot, client: &TcpStream) {
        match self {
            Way::Tcp(at) => forward::serve(payload, at, slot, client),
            Way::Shared(line) => line.serve(slot, client),
        }
    }
}
