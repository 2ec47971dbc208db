//! Payloads of a real boat, such as a camera or a sonde: the bytes exchanged with clients,
//! for recordings.

use crate::{Message, Stamp};
use serde::{Deserialize, Serialize};

/// Bytes between a payload and a client.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PayloadBytes {
    /// Time of the gateway's clock, and the message's sequence number.
    pub stamp: Stamp,
    /// The client's connection, from 1; 0 for a serial line or UDP port, which all clients share.
    pub connection: u32,
    /// Whether the bytes go to the payload.
    pub outward: bool,
    /// The bytes; empty after the sender closed the connection.
    pub data: Vec<u8>,
}

impl Message for PayloadBytes {
    const SCHEMA: &'static str = "squall_msgs/msg/PayloadBytes";
    const VERSION: u8 = 1;
}
