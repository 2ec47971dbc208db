//! Payloads of a real boat, such as a camera or a sonde: all bytes between them and their clients,
//! for recordings.

use crate::{Message, Stamp};
use serde::{Deserialize, Serialize};

/// Bytes between a payload and a client.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PayloadBytes {
    /// Time of the gateway's clock, and a sequence number that counts these messages.
    pub stamp: Stamp,
    /// The client's connection, counted from 1. For a serial line or UDP port, which all clients
    /// share: 0.
    pub connection: u32,
    /// Whether the bytes go to the payload.
    pub outward: bool,
    /// The bytes; empty if their sender has closed the connection.
    pub data: Vec<u8>,
}

impl Message for PayloadBytes {
    const SCHEMA: &'static str = "squall_msgs/msg/PayloadBytes";
    const VERSION: u8 = 1;
}
