//! Payloads of a real boat, such as a camera or a sonde: every byte between them and their clients, for recordings.

use crate::{Message, Stamp};
use serde::{Deserialize, Serialize};

/// Bytes between a payload and a client.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PayloadBytes {
    /// Time: that of the gateway's clock. Number: counts these messages.
    pub stamp: Stamp,
    /// The client's connection, counted from 1. From a serial line or UDP port, which all clients share, to all of them: 0.
    pub connection: u32,
    /// Whether they go to the payload.
    pub outward: bool,
    /// The bytes; none where the side that they come from has closed the connection.
    pub data: Vec<u8>,
}

impl Message for PayloadBytes {
    const SCHEMA: &'static str = "squall_msgs/msg/PayloadBytes";
    const VERSION: u8 = 1;
}
