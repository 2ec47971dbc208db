//! The events that a node reports to the program that runs it.

use crate::bridge::Event;
use bus::Token;
use messages::external::GatewayStatus;
use std::net::SocketAddr;
use std::path::Path;

/// An event that a node reports to the program that runs it.
pub enum NodeEvent<'a> {
    /// The node cannot start yet.
    Looking {
        /// The cause.
        reason: &'a str,
    },
    /// An event occurred.
    Event {
        /// Time since the node started, s.
        at_s: f64,
        /// The event.
        event: &'a Event,
    },
    /// The status, once a second.
    Status(&'a GatewayStatus),
    /// The node has ended with this status.
    Ended(&'a GatewayStatus),
    /// The node records into this file.
    Recording(&'a Path),
    /// The control port is open, or requires a different token from now on.
    ControlPort {
        /// The address of the port.
        address: SocketAddr,
        /// The required token, if known.
        token: Option<Token>,
    },
    /// A port is open for connections.
    Listening {
        /// The purpose of the port.
        what: &'a str,
        /// The port's address.
        reach: &'a str,
    },
}
