//! What a node reports to the program that runs it.

use crate::bridge::Event;
use bus::Token;
use messages::external::GatewayStatus;
use std::net::SocketAddr;
use std::path::Path;

/// What a node reports to the program that runs it.
pub enum NodeEvent<'a> {
    /// The node cannot begin yet.
    Looking {
        /// The cause.
        reason: &'a str,
    },
    /// Something happened.
    Event {
        /// Time since it began, s.
        at_s: f64,
        /// What.
        event: &'a Event,
    },
    /// The status, twice a second.
    Status(&'a GatewayStatus),
    /// It has ended, with this status.
    Ended(&'a GatewayStatus),
    /// It records into this file.
    Recording(&'a Path),
    /// The control port is open, or requires another token from now on.
    ControlPort {
        /// Where it listens.
        address: SocketAddr,
        /// The token that it requires, if known.
        token: Option<Token>,
    },
    /// Others can connect here.
    Listening {
        /// Which port this is.
        what: &'a str,
        /// Its address.
        reach: &'a str,
    },
}
